// SPDX-License-Identifier: Apache-2.0
// `capstan commission` on instruments of several joints, whose tendons pull at each other.
#include <gtest/gtest.h>

#include <iterator>

#include "capstan/tests/tools/run/drawn_joint.hpp"
#include "capstan/tools/commission/commission.hpp"

namespace capstan::tools {
namespace {

/// An instrument whose joints are commissioned one after the other, and then together.
class Together {
 public:
  explicit Together(const std::string& instrument)
      : scenario_(sim::parse_scenario("instrument = \"" + instrument + "\"\n", "test")), line_(scenario_) {
    const auto axes = sim::axes_of(scenario_);
    for (std::size_t i = 0; i < axes.size(); ++i) {
      for (const std::string& one : data_sheet(axes[i].plant, i)) {
        line_.ask(one);
      }
      joints_.push_back({.axis = static_cast<int>(i),
                         .corridor_rad = 0.6,
                         .inertia_kgm2 = axes[i].plant.motor_inertia_kgm2,
                         .key = {},
                         .saves = false});
    }
    before_ = line_.ask("dump");
    for (const CommissionOptions& joint : joints_) {
      progress_.push_back(commission(line_, person_, joint, {}).progress);
    }
  }
  void finish() { commission_together(line_, person_, joints_, progress_, before_); }
  [[nodiscard]] auto line() -> SimShell& { return line_; }
  [[nodiscard]] auto before() const -> const std::vector<std::string>& { return before_; }
  [[nodiscard]] auto progress() const -> const std::vector<Progress>& { return progress_; }

 private:
  Operator person_{.tell = [](const std::string&) {},
                   .agrees = [](const std::string&) { return true; },
                   .keep = [](int, const Progress&) {}};
  sim::Scenario scenario_;
  SimShell line_;
  std::vector<CommissionOptions> joints_;
  std::vector<Progress> progress_;
  std::vector<std::string> before_;
};

auto gains_in(const std::vector<std::string>& dump) -> std::vector<std::string> {
  std::vector<std::string> gains;
  std::copy_if(dump.begin(), dump.end(), std::back_inserter(gains),
               [](const std::string& line) { return line.find(".control.") != std::string::npos; });
  return gains;
}

TEST(CommissionTogether, CoupledJointsKeepTheirMarginsAndAreSavedAtOnceOrGetTheGainsOfBeforeBack) {
  const char* variable = std::getenv("CAPSTAN_TOGETHER");
  Together all(variable == nullptr ? "robot_finger" : variable);
  all.finish();
  for (const Progress& progress : all.progress()) {
    const auto told = std::find_if(progress.found.begin(), progress.found.end(), [](const std::string& sentence) {
      return sentence.starts_with("with the other joints under control");
    });
    ASSERT_NE(told, progress.found.end());
    EXPECT_TRUE(std::any_of(progress.found.begin(), progress.found.end(), [](const std::string& sentence) {
      return sentence.starts_with("its response to test pulses at rest is ");
    })) << "while the others are shaken it is judged by them";
    std::printf("  %s\n", told->c_str());
  }
  EXPECT_EQ(all.progress().back().found.back(), "saved");
  EXPECT_FALSE(energised(all.line().board().machine().telemetry().state));
  const std::vector<std::string> tuned = all.line().ask("dump");
  EXPECT_NE(gains_in(tuned), gains_in(all.before()));
  all.line().ask("load");
  EXPECT_EQ(gains_in(all.line().ask("dump")), gains_in(tuned)) << "the save has all joints";
  // As if the last joint had been tuned far too stiff.
  const std::string last = "joint" + std::to_string(all.progress().size() - 1);
  const auto& control = all.line().board().machine().config()[all.progress().size() - 1].control;
  all.line().ask("set " + last + ".control.stiffness " + rounded(2.5 * control.stiffness_nm_per_rad.to_double()));
  all.line().ask("set " + last + ".control.damping " + rounded(0.5 * control.damping_nms_per_rad.to_double()));
  try {
    all.finish();
    ADD_FAILURE() << "was taken";
  } catch (const Refusal& refusal) {
    EXPECT_NE(std::string(refusal.what()).find(last + " has only"), std::string::npos) << refusal.what();
  }
  EXPECT_FALSE(energised(all.line().board().machine().telemetry().state));
  EXPECT_EQ(gains_in(all.line().ask("dump")), gains_in(all.before()));
}

}  // namespace
}  // namespace capstan::tools
