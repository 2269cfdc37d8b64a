// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "capstan/firmware/safety/cautious_limits.hpp"
#include "capstan/tests/firmware/loop/cycle_rig.hpp"

namespace capstan::test {
namespace {

/// A board whose joints are real.
struct RealBench : Bench<2> {
  RealBench() { board.is_simulated = false; }
};

TEST(ShellCommission, AJointThatIsNotCommissionedGetsNoTorqueAndIsToldTheCure) {
  RealBench bench;
  const std::string answer = verdict(bench.say("arm"));
  EXPECT_EQ(answer.rfind("error not_commissioned: ", 0), 0U) << answer;
  EXPECT_NE(answer.find("joint0"), std::string::npos);
  EXPECT_NE(answer.find("; 'maintenance open'"), std::string::npos);
  EXPECT_EQ(bench.state(), State::kDisarmed);
}

TEST(ShellCommission, InMaintenanceItGetsTorqueWithinCautiousLimits) {
  RealBench bench;
  bench.say("maintenance open");
  const std::string answer = bench.say("arm");
  EXPECT_EQ(verdict(answer), "ok");
  EXPECT_TRUE(has_line(answer, "# joint0 is not commissioned: ")) << answer;
  bench.ticks(50);
  bench.say("move joint0 1.5 rad");
  bench.ticks(1000);
  EXPECT_LT(bench.joint().q2_reference_rad, Q24::from_double(0.6)) << "a quarter of 2 rad/s";
  EXPECT_GT(bench.joint().q2_reference_rad, Q24::from_double(0.3));
}

TEST(ShellCommission, AJointThatIsNotThereNeedsNoCommissioning) {
  RealBench bench;
  bench.say("maintenance open");
  for (const char* line : {"begin", "set joint0.observer.inertia 0.02", "set joint0.observer.coulomb 0.003",
                           "set joint0.observer.against 0.01", "set joint0.observer.noise 0.003",
                           "set joint1.motor.fitted 0", "commit", "maintenance close"}) {
    EXPECT_EQ(verdict(bench.say(line)), "ok") << line;
  }
  const std::string answer = bench.say("arm");
  EXPECT_EQ(verdict(answer), "ok");
  EXPECT_FALSE(has_line(answer, "# joint"));
}

TEST(ShellCommission, IsRefusedWithTheCureWhereItCanNotBegin) {
  RealBench bench;
  EXPECT_EQ(verdict(bench.say("commission joint9")).rfind("error unknown_joint: ", 0), 0U);
  EXPECT_EQ(verdict(bench.say("commission joint0")).rfind("error maintenance: ", 0), 0U);
  bench.say("maintenance open");
  EXPECT_EQ(verdict(bench.say("commission joint0 amplitude=fast")).rfind("error option: ", 0), 0U);
  EXPECT_NE(bench.say("commission joint0 dither=5mNm dither=6mNm").find("'dither' is given twice"), std::string::npos);
  EXPECT_EQ(verdict(bench.say("commission joint0 dither=0Nm")).rfind("error option: ", 0), 0U);
  EXPECT_EQ(verdict(bench.say("commission joint0 amplitude=9rad")).rfind("error range: ", 0), 0U);
  EXPECT_EQ(verdict(bench.say("commission joint0")).rfind("error not_holding: ", 0), 0U);
  for (const char* line : {"begin", "set joint0.observer.inertia 0.02", "set joint0.observer.coulomb 0.003",
                           "set joint0.observer.against 0.01", "set joint0.observer.noise 0.003", "commit"}) {
    bench.say(line);
  }
  EXPECT_EQ(verdict(bench.say("commission joint0")).rfind("error commissioned: ", 0), 0U);
  EXPECT_EQ(verdict(bench.say("commission joint0 looks")).rfind("error not_holding: ", 0), 0U);
  EXPECT_EQ(verdict(bench.say("commission joint1 looks")).rfind("error not_commissioned: ", 0), 0U);
  bench.say("maintenance close");
  EXPECT_EQ(verdict(bench.say("commission joint0 looks")).rfind("error maintenance: ", 0), 0U);
  EXPECT_EQ(bench.state(), State::kDisarmed);
}

TEST(ShellCommission, AFaultEndsItAndNothingIsChanged) {
  RealBench bench;
  bench.say("maintenance open");
  bench.say("arm");
  bench.ticks(50);
  for (const char c : std::string("commission joint0\n")) {
    bench.shell.receive(c);
  }
  for (int i = 0; i < 1000; ++i) {
    bench.application.rt_tick();
    bench.shell.poll();
  }
  EXPECT_EQ(bench.state(), State::kExperiment);
  bench.io.estop = true;
  for (int i = 0; i < 10 && bench.shell.busy(); ++i) {
    bench.application.rt_tick();
    bench.shell.poll();
  }
  const std::string answer = bench.sink.take();
  EXPECT_EQ(verdict(answer).rfind("error aborted: ", 0), 0U) << answer;
  EXPECT_TRUE(has_line(answer, "ended by emergency_stop: ")) << answer;
  EXPECT_EQ(bench.application.config()[0].observer.inertia_gm2, Q24{});
}

TEST(CautiousLimits, HoldUnderTorqueWhenParametersChangeAndEndWithTheNextArming) {
  CycleRig<1> rig;
  rig.tick({.arm = true, .cautious = true});
  rig.tick();
  AxisConfig tuned;
  tuned.control.kp = Q24::from_double(0.3);
  rig.state.axis[0].rt_configure(tuned);
  EXPECT_EQ(rig.state.axis[0].config().limits.joint_speed_rad_s, cautious_limits({}).joint_speed_rad_s);
  rig.tick({.disarm = true});
  rig.arm();
  EXPECT_EQ(rig.state.axis[0].config().limits.joint_speed_rad_s, LimitConfig{}.joint_speed_rad_s);
}

TEST(CautiousLimits, DoNotBindAJointThatIsCommissioned) {
  AxisConfig config;
  config.observer = {.inertia_gm2 = Q24::from_double(0.02),
                     .coulomb_nm = Q24::from_double(0.003),
                     .against_nm = Q24::from_double(0.01),
                     .noise_a = Q24::from_double(0.003)};
  CycleRig<1> rig({config});
  rig.tick({.arm = true, .cautious = true});
  EXPECT_EQ(rig.state.axis[0].config().limits.joint_speed_rad_s, config.limits.joint_speed_rad_s);
}

}  // namespace
}  // namespace capstan::test
