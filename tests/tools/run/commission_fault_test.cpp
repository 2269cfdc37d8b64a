// SPDX-License-Identifier: Apache-2.0
// `capstan commission` of joints that fail meanwhile, of other joints than the one whose progress was kept, and off the
// middle of their limits.
#include <gtest/gtest.h>

#include "capstan/tests/tools/run/happening.hpp"
#include "capstan/tools/commission/commission.hpp"
#include "capstan/tools/support/errors.hpp"

namespace capstan::tools {
namespace {

constexpr double kCorridor = 0.8;

struct Said {
  std::string refusal;
  Progress progress;
};

/// @param last_step  the person lets no joint move once that is done
auto commissioned(Happening& line, const CommissionOptions& options, Progress progress = {},
                  const std::string& last_step = "", bool assured = false) -> Said {
  Said said{.refusal = {}, .progress = progress};
  const Operator person{
      .tell = [](const std::string&) {},
      .agrees = [&](const std::string&) { return last_step.empty() || !said.progress.is_done(last_step); },
      .assures = [&](const std::string&) { return assured; },
      .keep = [&](int, const Progress& now) { said.progress = Progress::parse(now.text(), "state"); }};
  try {
    commission(line, person, options, std::move(progress));
  } catch (const Refusal& refusal) {
    said.refusal = refusal.what();
  }
  return said;
}

auto options_of(const sim::Scenario& scenario, double corridor = kCorridor) -> CommissionOptions {
  return {.axis = 0, .corridor_rad = corridor, .inertia_kgm2 = scenario.plant.motor_inertia_kgm2, .key = {}};
}

// They ran 37 rad in `travel`, 65 to 128 in `motor` and 70 in `tune`, where the observer is off.
TEST(CommissionOfAFailingJoint, AnEncoderThatSticksInAnyStepEndsItBeforeTheMotorHasRunFar) {
  const sim::Scenario scenario = draw(741);
  struct Stuck {
    const char* when;
    const char* ahead_of;
    double most_rad;
  };
  for (const Stuck& stuck :
       {Stuck{"at 3.1", "experiment joint0 triangle", 2.0}, Stuck{"at 6.2", "commission joint0", 8.0},
        Stuck{"at 15", "commission joint0", 8.0}, Stuck{"at 12", "travel=", 2.0}}) {
    Happening line(scenario, std::string("fail encoder stuck for 3 ") + stuck.when, stuck.ahead_of);
    const Said said = commissioned(line, options_of(scenario), {}, "tune");
    const double motor_rad = line.board().take_way().motor_rad;
    std::printf("%s %s | motor %.2f rad | %s\n", stuck.ahead_of, stuck.when, motor_rad, said.refusal.c_str());
    EXPECT_NE(said.refusal.find("encoder"), std::string::npos) << stuck.ahead_of << ": " << said.refusal;
    EXPECT_LT(motor_rad, stuck.most_rad) << stuck.ahead_of;
    EXPECT_EQ(line.armed_since(), 0) << stuck.ahead_of << ": torque came back";
    EXPECT_FALSE(energised(line.board().board().machine().telemetry().state)) << stuck.ahead_of;
    const LimitConfig& limits = line.board().board().machine().config()[0].limits;
    EXPECT_NEAR(limits.following_error_rad.to_double(), 0.35, 1e-4) << stuck.ahead_of;
    EXPECT_NEAR(limits.following_time_s.to_double(), 0.25, 1e-4) << stuck.ahead_of;
  }
}

// It was saved and called done, with a fault latched in `check` that was only printed.
TEST(CommissionOfAFailingJoint, ATendonThatTearsWhileItTunesIsNotCommissioned) {
  const sim::Scenario scenario = draw(741);
  for (const char* when : {"at 10", "at 60"}) {
    Happening line(scenario, std::string("fail tendon_top snap ") + when, "travel=");
    const Said said = commissioned(line, options_of(scenario));
    std::printf("tendon torn %s | %s\n", when, said.refusal.c_str());
    EXPECT_FALSE(said.refusal.empty()) << when;
    EXPECT_FALSE(said.progress.is_done("save")) << when;
    EXPECT_DOUBLE_EQ(line.board().board().machine().config()[0].control.stiffness_nm_per_rad.to_double(), 1.0) << when;
  }
}

TEST(CommissionOfAFailingJoint, ATendonThatTearsInTheCheckIsNotCommissioned) {
  const sim::Scenario scenario = draw(741);
  Happening line(scenario, "fail tendon_bottom snap", "frequencies=0.1Hz");
  const Said said = commissioned(line, options_of(scenario));
  EXPECT_NE(said.refusal.find("check: "), std::string::npos) << said.refusal;
  EXPECT_FALSE(said.progress.is_done("check"));
}

TEST(CommissionOfAnotherJoint, TheProgressOfOneIsNotTakenForAnothers) {
  const sim::Scenario scenario = sim::parse_scenario("instrument = \"robot_finger\"\n", "test");
  Happening line(scenario);
  const std::vector<std::string> before = line.ask("dump");
  Progress first;
  first.axis = 0;
  first.done = {"look", "shake", "press", "travel", "motor", "tune", "check", "save"};
  first.set = {{"control.kp", "0.5"}};
  first.before = {{"limits.motor_min", "-1 rad"}};
  CommissionOptions options = options_of(scenario);
  options.axis = 1;
  const Said said = commissioned(line, options, first);
  EXPECT_NE(said.refusal.find("of joint0, and this is joint1"), std::string::npos) << said.refusal;
  EXPECT_EQ(line.ask("dump"), before);
}

TEST(CommissionOfAnotherJoint, ABoardWithoutWhatWasFoundIsNotGivenItUnlessItWasRestarted) {
  const sim::Scenario scenario;
  Happening line(scenario);
  const std::vector<std::string> before = line.ask("dump");
  Progress kept;
  kept.axis = 0;
  kept.done = {"look", "shake", "press", "travel", "motor", "tune", "check"};
  kept.set = {{"limits.motor_max", "5.5 rad"}, {"control.kp", "0.31"}};
  const Said other = commissioned(line, options_of(scenario), kept);
  EXPECT_NE(other.refusal.find("joint0.limits.motor_max is 6 rad, which is not what was found"), std::string::npos)
      << other.refusal;
  EXPECT_EQ(line.ask("dump"), before);
  EXPECT_EQ(commissioned(line, options_of(scenario), kept, "", true).refusal, "");
  EXPECT_NEAR(line.board().board().machine().config()[0].control.kp.to_double(), 0.31, 1e-4);
  // What was saved outlives a restart.
  Happening fresh(scenario);
  kept.done.emplace_back("save");
  const Said saved = commissioned(fresh, options_of(scenario), kept, "", true);
  EXPECT_NE(saved.refusal.find("it is another board, or was changed since"), std::string::npos) << saved.refusal;
  EXPECT_EQ(fresh.ask("dump"), before);
}

TEST(CommissionOfAnotherJoint, AnotherScaleOfTheMotorIsAnotherJoint) {
  const sim::Scenario scenario;
  Happening line(scenario);
  const Said first = commissioned(line, options_of(scenario), {}, "shake");
  EXPECT_TRUE(first.progress.is_done("shake")) << first.refusal;
  line.ask("maintenance open");
  line.ask("set joint0.motor.encoder_counts 20480");
  const Said other = commissioned(line, options_of(scenario), first.progress);
  EXPECT_NE(other.refusal.find("another joint or another scale"), std::string::npos) << other.refusal;
}

TEST(CommissionOffTheMiddle, TheCorridorStaysWhereItWasWhenTheJointStandsElsewhereLater) {
  const sim::Scenario scenario;
  Happening line(scenario);
  Progress kept;
  kept.done = {"look", "shake"};
  kept.inertia_kgm2 = scenario.plant.motor_inertia_kgm2;
  kept.home_rad = 0.3;  // it stands at 0
  const Said said = commissioned(line, options_of(scenario, 0.5), kept, "travel");
  EXPECT_TRUE(said.progress.is_done("travel")) << said.refusal;
  EXPECT_NE(line.last("experiment joint0 triangle").find("offset=0.3rad"), std::string::npos);
  kept.home_rad = 0.9;
  const Said outside = commissioned(line, options_of(scenario, 0.5), kept, "travel");
  EXPECT_NE(outside.refusal.find("outside the corridor from 0.4 to 1.4 rad"), std::string::npos) << outside.refusal;
}

// They stopped in `tune` for an angle that the board refused.
TEST(CommissionOffTheMiddle, ACorridorBeyondTheJointsLimitsEndsAtThem) {
  const sim::Scenario scenario = draw(741);
  Happening line(scenario);
  for (const char* set : {"maintenance open", "set joint0.limits.joint_min -0.2 rad"}) {
    line.ask(set);
  }
  static_cast<void>(line.board().take_way());
  const Said said = commissioned(line, options_of(scenario), {}, "tune");
  EXPECT_TRUE(said.progress.is_done("tune")) << said.refusal;
  const double middle = 0.5 * (kCorridor - 0.2);
  EXPECT_NE(line.last("experiment joint0 multisine").find("offset=" + rounded(middle) + "rad"), std::string::npos)
      << line.last("experiment joint0 multisine");
}

}  // namespace
}  // namespace capstan::tools
