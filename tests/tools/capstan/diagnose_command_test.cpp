// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "capstan/tests/tools/capstan/command_fixture.hpp"
#include "capstan/tests/tools/capstan/made_up_joint.hpp"

namespace capstan::tools {
namespace {

class DiagnoseCommand : public Command {
 protected:
  auto write(const std::string& name, const std::string& text) const -> std::string {
    write_text_file(path(name), text);
    return "\"" + path(name) + "\" ";
  }
};

TEST_F(DiagnoseCommand, ARestBeforeATestMakesNoLawBetter) {
  const std::string fitted = write("fitted.csv", test::joint_log({.seed = 1, .play_rad = 0.02}));
  const std::string test = write("test.csv", test::joint_log({.seed = 2, .play_rad = 0.04}));
  const std::string rested = write("rested.csv", test::joint_log({.seed = 2, .play_rad = 0.04, .rest_s = 120.0}));
  const Outcome outcome =
      run("diagnose " + fitted + "--test " + test + "--test " + rested + "--json \"" + path("answer.json") + "\"");
  const auto tested = nlohmann::json::parse(read_text_file(path("answer.json")))["test"];
  for (const char* law : {"before", "after"}) {
    const double moving = tested[0][law]["rmse"];
    EXPECT_NEAR(tested[1][law]["rmse"], moving, 0.1 * moving) << law << outcome.output;
  }
}

TEST_F(DiagnoseCommand, AReportOfAnAngleThatIsWorkedOutFromTheMotorsComesToAnEnd) {
  std::string text = "time_s,axis0/q1_rad,axis0/q2_rad\n";
  const test::MadeUpMotion motor(1, {0.1, 0.27, 0.61}, 0.6);
  for (int i = 0; i < 4000; ++i) {
    const double counts = std::round(motor.derivative(0.01 * i, 0) * 8192.0 / 6.283);
    const double q1 = counts * 6.283 / 8192.0;
    text += exact(0.01 * i) + "," + exact(q1) + "," + exact(q1 / 37.0 + 0.7) + "\n";
  }
  // Memory that ends before the test does.
  const Outcome outcome =
      run("diagnose " + write("exact.csv", text) + "--report \"" + path("report") + "\"", "ulimit -v 4000000; ");
  EXPECT_TRUE(outcome.status == 0 || outcome.status == 1) << outcome.output;
  EXPECT_TRUE(exists("report/index.html")) << outcome.output;
}

TEST_F(DiagnoseCommand, WhatIsNotWrittenIsSaidAndAnOlderFileIsNotTakenForIt) {
  const std::string law = write("law.toml", "# an older law\n");
  const std::string next = write("next.toml", "# an older motion\n");
  const std::string whole = test::joint_log({});
  std::size_t end = 0;
  for (int line = 0; line < 120; ++line) {
    end = whole.find('\n', end) + 1;
  }
  const Outcome unfit = run("diagnose " + write("short.csv", whole.substr(0, end)) + "-o " + law);
  EXPECT_EQ(unfit.status, 1) << unfit.output;
  EXPECT_NE(unfit.output.find("law.toml was not written: these logs give no law; the older file is left as it was"),
            std::string::npos)
      << unfit.output;
  test::SyntheticRequest sound;
  sound.rate_hz = 100.0;
  sound.cycle_s = 25.0;
  const Outcome asked_nothing = run("diagnose " + write_log(sound) + " --next " + next);
  EXPECT_NE(
      asked_nothing.output.find("next.toml was not written: this diagnosis needs no further motion; the older file"),
      std::string::npos)
      << asked_nothing.output;
  EXPECT_EQ(read_text_file(path("law.toml")), "# an older law\n");
  EXPECT_EQ(read_text_file(path("next.toml")), "# an older motion\n");
}

// Such a law runs on a board, which sees its own motor only.
TEST_F(DiagnoseCommand, ALawAloneHoldsNoOtherAxis) {
  const std::string log = write("coupled.csv", test::effort_log({.seed = 1}));
  const auto law_of = [&](const std::string& options) {
    const Outcome outcome =
        run("diagnose " + log + "--target axis0/tau_Nm " + options + "-o \"" + path("law.toml") + "\"");
    EXPECT_TRUE(outcome.status == 0 || outcome.status == 1) << outcome.output;
    return read_text_file(path("law.toml"));
  };
  EXPECT_NE(law_of("").find("coupling"), std::string::npos);
  const std::string alone = law_of("--alone ");
  EXPECT_NE(alone.find("[terms.inertia]"), std::string::npos);
  EXPECT_EQ(alone.find("coupling"), std::string::npos) << alone;
}

TEST_F(DiagnoseCommand, AReportsFolderKeepsNothingOfAnOlderPage) {
  std::filesystem::create_directory(path("report"));
  write("report/map_angle.svg", "<svg/>");
  write("report/notes.txt", "mine");
  const std::string log = write("short.csv", "time_s,axis0/q1_rad,axis0/q2_rad\n0,0,0\n0.01,1,1\n0.02,0,0\n0.03,1,1\n");
  const Outcome outcome = run("diagnose " + log + "--report \"" + path("report") + "\"");
  EXPECT_TRUE(exists("report/index.html")) << outcome.output;
  EXPECT_FALSE(exists("report/map_angle.svg")) << "the page of an unfit log has no picture";
  EXPECT_TRUE(exists("report/notes.txt")) << "nor is it this program's";
}

}  // namespace
}  // namespace capstan::tools
