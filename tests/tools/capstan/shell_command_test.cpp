// SPDX-License-Identifier: Apache-2.0
// `capstan shell` as a script uses it, whose standard input is no terminal.
#include "capstan/tests/tools/capstan/command_fixture.hpp"

namespace capstan::tools {
namespace {

class ShellCommand : public Command {
 protected:
  /// What the shell makes of these lines, as printf has them.
  auto script(const std::string& lines, const std::string& options = "") const -> Outcome {
    return run("shell $port", beside_a_board(path("board"), options) + "printf '" + lines + "' | ");
  }
};

TEST_F(ShellCommand, AScriptIsOverWhenItsLastLineIsAnswered) {
  const Outcome outcome =
      script("maintenance open\\narm\\ncommission joint0\\nget joint0.observer.inertia\\n", "--fast");
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  const auto inertia = outcome.output.rfind("joint0.observer.inertia ");
  ASSERT_NE(inertia, std::string::npos) << outcome.output;
  EXPECT_NE(outcome.output.compare(inertia, 26, "joint0.observer.inertia 0 "), 0) << outcome.output;
}

TEST_F(ShellCommand, ALastLineWithoutItsEndIsExecuted) {
  const Outcome outcome = script("version\\nstatus");
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  EXPECT_NE(outcome.output.find("state disarmed"), std::string::npos) << outcome.output;
}

TEST_F(ShellCommand, AScriptThatTheBoardRefusedIsARefusal) {
  const Outcome outcome = script("nosuch\\nstatus\\n");
  EXPECT_EQ(outcome.status, 1) << outcome.output;
  EXPECT_NE(outcome.output.find("error unknown_command"), std::string::npos) << outcome.output;
  EXPECT_NE(outcome.output.find("state disarmed"), std::string::npos) << "the lines behind it are executed";
}

TEST_F(ShellCommand, ABoardThatIsLostIsSaidWithWhatItDidNotAnswer) {
  const std::string board = beside_a_board(path("board"));
  const Outcome idle = run("shell $port", board + "(sleep 1; kill -9 $board) & (printf 'status\n'; sleep 2) | ");
  EXPECT_EQ(idle.status, 1) << idle.output;
  EXPECT_NE(idle.output.find("the board closed the line"), std::string::npos) << idle.output;
  EXPECT_EQ(idle.output.find("not answered"), std::string::npos) << idle.output;
  const Outcome asked = run("shell $port", board +
                                               "(sleep 1; kill -9 $board) & printf 'maintenance open\narm\n"
                                               "commission joint0\nsave\n' | ");
  EXPECT_EQ(asked.status, 1) << asked.output;
  EXPECT_NE(asked.output.find("; 2 lines were not answered"), std::string::npos) << asked.output;
}

TEST_F(ShellCommand, TorqueThatStaysOverASerialLineIsSaid) {
  const std::string board = beside_a_board(path("board"), "", "pty");
  const Outcome left = run("shell $port", board + "printf 'maintenance open\narm\n' | ");
  EXPECT_EQ(left.status, 0) << left.output;
  EXPECT_NE(left.output.find("the joints may have torque (state holding)"), std::string::npos) << left.output;
  const Outcome disarmed = run("shell $port", board + "printf 'maintenance open\narm\ndisarm\n' | ");
  EXPECT_EQ(disarmed.output.find("may have torque"), std::string::npos) << disarmed.output;
  const Outcome stopped =
      run("version", board + "(printf 'maintenance open\narm\n'; sleep 3) | \"" CAPSTAN_PROGRAM "\" shell $port > \"" +
                         path("said") + "\" 2>&1 & sleep 1; kill -INT $!; wait $!; ");
  EXPECT_NE(read_text_file(path("said")).find("may have torque (state holding)"), std::string::npos) << stopped.output;
}

}  // namespace
}  // namespace capstan::tools
