// SPDX-License-Identifier: Apache-2.0
// `capstan response` and `capstan tune` as a user calls them, on what a terminal showed.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>

#include "capstan/tests/tools/own_folder.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

struct Outcome {
  int status = -1;
  std::string output, said;  ///< stdout, stderr
};

class TuneCommand : public test::OwnFolder {
 protected:
  auto run(const std::string& arguments) const -> Outcome {
    const std::string command = std::string("\"") + CAPSTAN_PROGRAM + "\" " + arguments + " > \"" + path("output") +
                                "\" 2> \"" + path("said") + "\"";
    Outcome outcome;
    const int result = std::system(command.c_str());
    outcome.status = WIFEXITED(result) ? WEXITSTATUS(result) : -1;
    outcome.output = read_text_file(path("output"));
    outcome.said = read_text_file(path("said"));
    return outcome;
  }
  /// What the simulated forceps' terminal shows.
  auto type(const std::string& lines) const -> std::string {
    write_text_file(path("typed"), lines);
    const Outcome shown = run("run --shell stdio --fast --seed 41 < \"" + path("typed") + "\"");
    EXPECT_EQ(shown.status, 0) << shown.said;
    return shown.output;
  }
};

const std::string kShake = "experiment joint0 multisine on=torque amplitude=8mNm travel=1.8 speed=1 duration=60\n";

TEST_F(TuneCommand, GainsForThePromptComeFromATerminalsLogAndTheBoardTakesThem) {
  write_text_file(path("log.txt"), type("maintenance open\narm\n" + kShake + "disarm\n"));
  write_text_file(path("dump.txt"), type("dump\n"));
  const Outcome tuned =
      run("tune \"" + path("log.txt") + "\" --dump \"" + path("dump.txt") + "\" --report \"" + path("report") + "\"");
  EXPECT_EQ(tuned.status, 0) << tuned.said;
  EXPECT_EQ(tuned.output.rfind("begin\nset joint0.control.stiffness ", 0), 0U) << tuned.output;
  EXPECT_NE(tuned.said.find("limited by"), std::string::npos) << tuned.said;
  EXPECT_TRUE(std::filesystem::exists(path("report/index.html")));
  const std::string taken = type(tuned.output + "get joint0.control.stiffness\n");
  EXPECT_EQ(taken.find("error "), std::string::npos) << taken;
  const Outcome shown = run("response \"" + path("log.txt") + "\"");
  EXPECT_EQ(shown.status, 0) << shown.said;
  EXPECT_NE(shown.output.find("distortion of the motor's motion"), std::string::npos);
  EXPECT_EQ(run("tune \"" + path("log.txt") + "\" --bandwidth 200").status, 1);
}

TEST_F(TuneCommand, AJointThatStoodIsRefusedAndAForeignLogIsBadInput) {
  write_text_file(path("stuck.txt"),
                  type("maintenance open\narm\nexperiment joint0 multisine on=torque duration=30\ndisarm\n"));
  const Outcome stuck = run("tune \"" + path("stuck.txt") + "\"");
  EXPECT_EQ(stuck.status, 1);
  EXPECT_EQ(stuck.output, "") << "no gains that somebody might paste";
  EXPECT_NE(stuck.said.find("travel"), std::string::npos) << stuck.said;
  write_text_file(path("other.csv"), "time_s,axis0/q1_rad\n0,0\n0.001,0\n");
  const Outcome foreign = run("tune \"" + path("other.csv") + "\"");
  EXPECT_EQ(foreign.status, 2);
  EXPECT_NE(foreign.said.find("tau_exc_Nm"), std::string::npos) << foreign.said;
  EXPECT_EQ(run("tune \"" + path("nothing.csv") + "\"").status, 2);
}

}  // namespace
}  // namespace capstan::tools
