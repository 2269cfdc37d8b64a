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

/// A commissioning under way, with the operator beside it.
struct Commissioning : RealBench {
  explicit Commissioning(const char* line = "commission joint0\n") {
    say("maintenance open");
    for (const char* one : {"begin", "set joint0.observer.coulomb 0.003", "set joint0.observer.against 0.01",
                            "set joint0.observer.noise 0.003", "commit"}) {
      EXPECT_EQ(verdict(say(one)), "ok") << one;
    }
    if (std::string_view(line).find("looks") != std::string_view::npos) {
      say("set joint0.observer.inertia 0.02");
    }
    say("arm");
    ticks(50);
    type(line);
  }
  void type(std::string_view text) {
    for (const char c : text) {
      shell.receive(c);
    }
  }
  void step() {
    application.rt_tick();
    shell.poll();
  }
  /// Until the machine is in the state; a minute at most.
  auto reaches(State wanted) -> bool {
    for (int i = 0; i < 60'000 && state() != wanted; ++i) {
      step();
    }
    return state() == wanted;
  }
  auto rests_between() -> bool { return reaches(State::kExperiment) && reaches(State::kDisarmed); }
  auto answer() -> std::string {
    for (int i = 0; i < 5000 && shell.busy(); ++i) {
      step();
    }
    return sink.take();
  }
  /// rad/s, of another joint that is asked to be as fast as it may.
  auto speed_of_joint1() -> double {
    EXPECT_TRUE(application.post({.kind = Request::Kind::kMove,
                                  .axis = 1,
                                  .position_rad = Q24::from_double(1.5),
                                  .speed_rad_s = Q24::from_int(2)}));
    for (int i = 0; i < 400; ++i) {
      step();
    }
    const double before = joint(1).q2_reference_rad.to_double();
    step();
    return 1000.0 * (joint(1).q2_reference_rad.to_double() - before);
  }
};

TEST(ShellCommission, EndedInItsFastMovesItLeavesNoTorque) {
  Commissioning bench;
  ASSERT_TRUE(bench.rests_between());
  ASSERT_TRUE(bench.reaches(State::kExperiment));
  bench.type("\x03");
  EXPECT_EQ(error_of(bench.answer()), "aborted");
  EXPECT_EQ(bench.state(), State::kDisarmed);
  EXPECT_FALSE(bench.io.has_torque());
}

TEST(ShellCommission, EndedWhileTorqueComesBackItLeavesNone) {
  Commissioning bench;
  ASSERT_TRUE(bench.rests_between());
  bench.io.cycles_to_follow = 1000;
  ASSERT_TRUE(bench.reaches(State::kArmed));
  bench.type("\x03");
  EXPECT_EQ(error_of(bench.answer()), "aborted");
  EXPECT_EQ(bench.state(), State::kDisarmed);
}

TEST(ShellCommission, WithoutARecorderForItsFastMovesItLeavesNoTorque) {
  Commissioning bench;
  ASSERT_TRUE(bench.rests_between());
  ASSERT_TRUE(bench.application.recorder().start(&bench, {}));
  EXPECT_EQ(error_of(bench.answer()), "busy");
  bench.ticks(2);
  EXPECT_EQ(bench.state(), State::kDisarmed);
}

TEST(ShellCommission, AFaultBetweenItsPartsWaitsForTheOperator) {
  Commissioning bench;
  ASSERT_TRUE(bench.reaches(State::kExperiment));
  ASSERT_TRUE(bench.reaches(State::kHolding));  // the moves are over
  ASSERT_TRUE(bench.reaches(State::kExperiment));
  while (bench.application.telemetry().experiment != ExperimentPhase::kDone) {
    bench.application.rt_tick();
    if (bench.application.telemetry().experiment != ExperimentPhase::kDone) {
      bench.shell.poll();
    }
  }
  bench.io.estop = true;
  bench.ticks(1);
  bench.io.estop = false;
  const std::string answer = bench.answer();
  EXPECT_TRUE(has_line(answer, "ended by emergency_stop: ")) << answer;
  EXPECT_EQ(error_of(answer), "aborted");
  EXPECT_EQ(bench.state(), State::kFaulted);
  EXPECT_TRUE(has_line(bench.say("faults"), "latched emergency_stop: "));
}

TEST(ShellCommission, TheOtherJointsStayCautious) {
  Commissioning bench;
  ASSERT_TRUE(bench.rests_between());
  ASSERT_TRUE(bench.reaches(State::kExperiment));
  EXPECT_NEAR(bench.speed_of_joint1(), 0.5, 0.01) << "a quarter of limits.joint_speed";
}

TEST(ShellCommission, LooksLeaveAFaultForTheOperator) {
  Commissioning bench("commission joint0 looks\n");
  ASSERT_TRUE(bench.reaches(State::kDisarmed));
  ASSERT_TRUE(bench.reaches(State::kHolding));
  bench.io.estop = true;
  bench.step();
  bench.io.estop = false;
  const std::string answer = bench.answer();
  EXPECT_TRUE(has_line(answer, "ended by emergency_stop: ")) << answer;
  EXPECT_EQ(error_of(answer), "aborted");
  EXPECT_EQ(bench.state(), State::kFaulted);
}

TEST(ShellCommission, LooksLeaveTheOtherJointsCautious) {
  Commissioning bench("commission joint0 looks\n");
  ASSERT_TRUE(bench.reaches(State::kDisarmed));
  ASSERT_TRUE(bench.reaches(State::kHolding));
  EXPECT_NEAR(bench.speed_of_joint1(), 0.5, 0.01);
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
