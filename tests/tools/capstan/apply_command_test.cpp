// SPDX-License-Identifier: Apache-2.0
// `capstan apply` over a serial line, which does not tell the board that its peer has left.
#include "capstan/tests/tools/capstan/command_fixture.hpp"

namespace capstan::tools {
namespace {

class ApplyCommand : public Command {
 protected:
  /// What a shell says to these lines after the file was applied; the board's line is held open meanwhile.
  auto after(const std::string& apply, const std::string& lines) const -> Outcome {
    return run("shell $port", beside_a_board(path("board"), "--fast", "pty") + "exec 7<> $port; " + apply + "printf '" +
                                  lines + "' | ");
  }
  auto apply(const std::string& file) const -> std::string {
    return "\"" CAPSTAN_PROGRAM "\" apply \"" + path(file) + "\" --port $port > \"" + path("applied") + "\" 2>&1";
  }
  auto applied() const -> std::string { return read_text_file(path("applied")); }
};

TEST_F(ApplyCommand, AFileThatIsRefusedLeavesNothingStagedAndNoMaintenance) {
  write_text_file(path("machine.toml"),
                  "schema = \"capstan.machine/1\"\n[joint0]\n\"limits.current\" = \"9 A\"\n\"limits.zzz\" = \"1\"\n");
  const Outcome shell = after(apply("machine.toml") + "; ",
                              "maintenance\\nset joint0.control.stiffness 0.5\\nget joint0.control.stiffness\\n"
                              "get joint0.limits.current\\n");
  EXPECT_NE(applied().find("the board refused 'set joint0.limits.zzz 1'"), std::string::npos) << applied();
  EXPECT_NE(shell.output.find("joint0.control.stiffness 0.5 "), std::string::npos) << shell.output;
  EXPECT_EQ(shell.output.find("joint0.limits.current 9 "), std::string::npos) << shell.output;
  EXPECT_NE(shell.output.find("maintenance closed"), std::string::npos) << shell.output;
}

TEST_F(ApplyCommand, StoppedHalfWayItLeavesNothingStaged) {
  write_text_file(path("machine.toml"), "schema = \"capstan.machine/1\"\n[joint0]\n\"limits.current\" = \"9 A\"\n");
  const Outcome shell =
      after("kill -STOP $board; " + apply("machine.toml") +
                " & sleep 0.3; kill -TERM $!; sleep 0.1; kill -CONT $board; wait $!; echo status $? >> \"" +
                path("applied") + "\"; ",
            "maintenance\\ncommit\\nget joint0.limits.current\\n");
  EXPECT_NE(applied().find("stopped before all was written"), std::string::npos) << applied();
  EXPECT_NE(applied().find("status 1"), std::string::npos) << applied();
  EXPECT_NE(shell.output.find("maintenance closed"), std::string::npos) << shell.output;
  EXPECT_EQ(shell.output.find("joint0.limits.current 9 "), std::string::npos) << shell.output;
}

}  // namespace
}  // namespace capstan::tools
