// SPDX-License-Identifier: Apache-2.0
// How `capstan commission` ends when it is ended from outside.
#include "capstan/tests/tools/capstan/command_fixture.hpp"

namespace capstan::tools {
namespace {

class CommissionCommand : public Command {
 protected:
  /// The program by itself, and what ends it as soon as it is in that step.
  auto ended(const std::string& step, const std::string& signal, const std::string& more = "",
             const std::string& whom = "$program") const -> std::string {
    return ": > \"" + path("said") + "\"; \"" CAPSTAN_PROGRAM "\" commission $port --corridor 0.8 --yes --state \"" +
           path("state") + "\" --machine \"" + path("machine") + "\" " + more + " >> \"" + path("said") +
           "\" 2>&1 & program=$!; for i in $(seq 400); do grep -q '^" + step + ":' \"" + path("said") +
           "\" && break; sleep 0.02; done; sleep 0.2; kill -" + signal + " " + whom +
           "; wait $program; echo status $? >> \"" + path("said") + "\"; ";
  }
  /// Keeps the board's parameters in a file.
  auto dump(const std::string& name) const -> std::string {
    return "echo dump | \"" CAPSTAN_PROGRAM "\" shell $port | grep '^set ' > \"" + path(name) + "\"; ";
  }
  auto board() const -> std::string { return beside_a_board(path("board"), "--fast"); }
};

TEST_F(CommissionCommand, ItIsStoppedByAClosedTerminalAsByCtrlC) {
  for (const char* signal : {"INT", "HUP", "TERM"}) {
    const Outcome status =
        run("shell $port", board() + dump("before") + ended("shake", signal) + dump("after") + "echo status | ");
    const std::string said = read_text_file(path("said"));
    EXPECT_NE(said.find("shake: stopped on request, torque is off; the same command continues from here\nstatus 1\n"),
              std::string::npos)
        << signal << ": " << said;
    EXPECT_NE(status.output.find("state disarmed"), std::string::npos) << signal << ": " << status.output;
    EXPECT_EQ(read_text_file(path("after")), read_text_file(path("before"))) << signal;
    std::filesystem::remove(path("state"));
  }
}

TEST_F(CommissionCommand, AfterItWasKilledTheNextRunGivesBackWhatItHadSetForAWhile) {
  for (const char* again : {"", "--again"}) {
    const Outcome status = run("shell $port", board() + dump("before") + ended("shake", "KILL") + dump("killed") +
                                                  ended("shake", "INT", again) + dump("after") + "echo status | ");
    EXPECT_TRUE(read_text_file(path("killed")) != read_text_file(path("before"))) << again;
    EXPECT_NE(read_text_file(path("said")).find(": stopped as you wished, torque is off"), std::string::npos) << again;
    EXPECT_EQ(read_text_file(path("after")), read_text_file(path("before"))) << again;
    EXPECT_NE(status.output.find("state disarmed"), std::string::npos) << again << status.output;
    std::filesystem::remove(path("state"));
  }
}

TEST_F(CommissionCommand, ABoardThatIsGoneIsSaid) {
  static_cast<void>(run("--version", board() + ended("shake", "KILL", "", "$board")));
  const std::string said = read_text_file(path("said"));
  EXPECT_NE(said.find("status 1\n"), std::string::npos) << said;
  EXPECT_TRUE(said.find("the board closed the line") != std::string::npos ||
              said.find("the line broke while sending") != std::string::npos)
      << said;
}

}  // namespace
}  // namespace capstan::tools
