// SPDX-License-Identifier: Apache-2.0
// The effort law in the firmware: disturbance, feedforward, shell.
#include "capstan/firmware/estimate/effort_stage.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "capstan/firmware/parameters/effort_rows.hpp"
#include "capstan/firmware/telemetry/signals.hpp"
#include "capstan/tests/firmware/loop/cycle_rig.hpp"

namespace capstan {
namespace {

using test::CycleRig;
using test::has_line;
using test::verdict;

void set(AxisConfig& config, const char* name, double value) {
  set_raw_value(config, *find_parameter(name), Q24::from_double(value).raw());
}

/// What the motor of CycleRig is: 20 g mm2 and its drag. (Its torque acts a cycle after it was measured, which is
/// 1 ms times what the torque changes by.)
auto motor_config() -> AxisConfig {
  AxisConfig config;
  set(config, "effort_inertia.inertia", 0.02);
  set(config, "effort_viscous_friction.drag", 2.0e-3);
  return config;
}

auto rms_disturbance(CycleRig<>& rig, int cycles) -> double {
  double squares = 0.0;
  for (int i = 0; i < cycles; ++i) {
    rig.tick();
    squares += std::pow(rig.joint().disturbance_nm.to_double(), 2);
  }
  return std::sqrt(squares / cycles);
}

TEST(EffortStage, FreeMotionIsNoDisturbanceAndAPushIsOneWithItsSign) {
  AxisConfig config = motor_config();
  config.effort.feedforward = 0;
  CycleRig<> rig({config});
  rig.ticks(100);
  EXPECT_TRUE(rig.joint().disturbance_known);
  rig.arm();
  rig.move(1.0);
  EXPECT_LT(rms_disturbance(rig, 1500), 1e-4);
  rig.disturb = [](Sensed<1>& sensed) { sensed.axis[0].current_a += Q24::from_double(0.2); };  // as a push of 20 mN m
  rig.ticks(300);
  EXPECT_NEAR(rig.joint().disturbance_nm.to_double(), 0.02, 5e-4);
}

TEST(EffortStage, WithoutALawSaysNothingAndChangesNothing) {
  AxisConfig config;
  set(config, "effort.window", 0.032);
  set(config, "effort.standstill", 1.0);
  set(config, "effort_spring.span", 2.0);  // shapes alone are no law
  CycleRig<> plain;
  CycleRig<> rig({config});
  for (CycleRig<>* each : {&plain, &rig}) {
    each->arm();
    each->move(0.8);
  }
  for (int i = 0; i < 2000; ++i) {
    ASSERT_EQ(plain.tick().axis[0].current_a, rig.tick().axis[0].current_a) << i;
  }
  EXPECT_EQ(rig.joint().disturbance_nm, Q24{});
  EXPECT_FALSE(rig.joint().disturbance_known);
}

TEST(EffortStage, BeginsAnewAfterASensorFailed) {
  CycleRig<> rig({motor_config()});
  rig.ticks(100);
  ASSERT_TRUE(rig.joint().disturbance_known);
  rig.io.encoder = Quality::kInvalid;
  rig.tick();
  EXPECT_FALSE(rig.joint().disturbance_known);
  rig.io.encoder = Quality::kOk;
  rig.ticks(60);
  EXPECT_FALSE(rig.joint().disturbance_known);
  rig.tick();
  EXPECT_TRUE(rig.joint().disturbance_known);
}

TEST(EffortStage, AJointThatIsNotFittedHasNoDisturbance) {
  AxisConfig config = motor_config();
  config.motor.fitted = 0;
  CycleRig<> rig({config});
  rig.ticks(100);
  EXPECT_FALSE(rig.joint().disturbance_known);
}

/// How far the motor's torque is from what the motion takes, so that the servo has nothing to do.
auto following_error(const AxisConfig& config) -> double {
  CycleRig<> rig({config});
  rig.arm();
  rig.move(1.0, 1.5);
  double worst = 0.0;
  for (int i = 0; i < 1000; ++i) {
    rig.tick();
    worst = std::max(worst, std::abs((rig.joint().q1_reference_rad - rig.joint().q1_rad).to_double()));
  }
  return worst;
}

TEST(EffortFeedforward, LeavesTheServoLessToDo) {
  AxisConfig config = motor_config();
  set(config, "control.stiffness", 0.1);
  set(config, "control.damping", 0.002);
  const double with = following_error(config);
  config.effort.feedforward = 0;
  EXPECT_LT(with, 0.2 * following_error(config));
}

TEST(EffortFeedforward, IsOffByItsParameterToTheBit) {
  AxisConfig off = motor_config();
  off.effort.feedforward = 0;
  CycleRig<> plain;
  CycleRig<> rig({off});
  for (CycleRig<>* each : {&plain, &rig}) {
    each->arm();
    each->move(0.8);
  }
  for (int i = 0; i < 2000; ++i) {
    ASSERT_EQ(plain.tick().axis[0].current_a, rig.tick().axis[0].current_a) << i;
  }
}

TEST(EffortFeedforward, PassesOverFromOneDirectionsFrictionToTheOtherWithoutAKick) {
  AxisConfig config;
  set(config, "effort_coulomb_friction.level", 0.05);
  set(config, "control.stiffness", 0.0);
  set(config, "control.damping", 0.0);
  const TorqueLaw<Q24> law(SamplePeriod<Q24>(kCycleRateHz), config.effort.law);
  const MotionLaw<Q24> motion(SamplePeriod<Q24>(kCycleRateHz), config.law);
  Controller controller(config.control);
  double last = controller.rt_start(config.control, motion, Q24{}, {}, &law).to_double();
  EXPECT_NEAR(last, 0.0, 1e-6) << "either way";
  const double largest_step = 0.1 / (0.02 * 1000.0 + 1.0);
  double reference = 0.0;
  for (int i = 0; i < 2000; ++i) {
    const bool forward = i / 500 % 2 == 0;
    reference += forward ? 0.0005 : -0.0005;
    const double torque = controller.rt_update(config, motion, Q24::from_double(reference), Q24{}, &law).to_double();
    ASSERT_LE(std::abs(torque - last), largest_step + 1e-6) << i;
    ASSERT_LE(std::abs(torque), 0.05 + 1e-6) << i;
    last = torque;
    if (i % 500 == 200) {
      ASSERT_NEAR(torque, forward ? 0.05 : -0.05, 0.002) << i;
    }
  }
}

TEST(EffortParameters, ThatAddUpToTooMuchAreRefusedWithACure) {
  AxisConfig config = motor_config();
  EXPECT_EQ(check(config), nullptr);
  for (const char* name : {"effort_offset.offset", "effort_spring.linear", "effort_gravity.sine"}) {
    set(config, name, 99.0);
  }
  const char* reason = check(config);
  ASSERT_NE(reason, nullptr);
  EXPECT_NE(std::string(reason).find("effort law"), std::string::npos);
}

TEST(EffortParameters, HaveARowForEveryCoefficientAndShapeInUnitsOfTorque) {
  std::size_t rows = 0;
  for (const ParameterInfo& parameter : parameters()) {
    rows += std::string_view(parameter.group).starts_with("effort") ? 1 : 0;
  }
  EXPECT_EQ(rows, kEffortRows);
  EXPECT_STREQ(find_parameter("effort_gravity.sine")->unit, "Nm");
  EXPECT_STREQ(find_parameter("effort_angle_periodic_3.order")->unit, "1");
  EXPECT_STREQ(find_parameter("effort_inertia.inertia")->unit, "Nms2/krad");
}

TEST(EffortShell, ModelAndStatusShowTheLawAndItsDisturbance) {
  test::Bench<1> bench;
  EXPECT_NE(bench.say("model").find("no effort law"), std::string::npos);
  EXPECT_EQ(bench.say("status").find("disturbance"), std::string::npos);
  EXPECT_EQ(verdict(bench.say("set joint0.effort_coulomb_friction.level 20 mNm")), "ok");
  EXPECT_EQ(verdict(bench.say("set joint0.effort.window 0.04 s")), "ok");
  EXPECT_EQ(verdict(bench.say("set joint0.effort.status 1")), "ok");
  const std::string model = bench.say("model");
  EXPECT_TRUE(has_line(model, "  effort_coulomb_friction: F (2J - 1)")) << model;
  EXPECT_TRUE(has_line(model, "    it is the feedforward (effort.feedforward); the disturbance is 10 ms old")) << model;
  EXPECT_TRUE(has_line(model, "  the effort law is provisional")) << model;
  bench.ticks(100);
  const std::string status = bench.say("status");
  EXPECT_NE(status.find(" disturbance "), std::string::npos) << status;
  EXPECT_EQ(status.find("not known yet"), std::string::npos) << status;
}

TEST(EffortShell, DisturbanceIsASignalLikeAnyOther) {
  const Signal signal = find_signal("joint0.disturbance", 1);
  ASSERT_NE(signal.info, nullptr);
  EXPECT_STREQ(signal.info->column, "tau_dist_Nm");
  std::array<AxisTelemetry, 1> axes{};
  axes[0].disturbance_nm = Q24::from_double(-0.25);
  EXPECT_EQ(Q24::from_raw(rt_raw(signal, {}, axes)), Q24::from_double(-0.25));
}

TEST(EffortParameters, SurviveARestart) {
  test::Bench<1> bench;
  EXPECT_EQ(verdict(bench.say("set joint0.effort_play_friction_2.slider 30 mNm")), "ok");
  EXPECT_EQ(verdict(bench.say("save")), "ok");
  EXPECT_EQ(verdict(bench.say("defaults")), "ok");
  EXPECT_EQ(verdict(bench.say("load")), "ok");
  EXPECT_NE(bench.say("get joint0.effort_play_friction_2.slider").find("0.03"), std::string::npos);
}

}  // namespace
}  // namespace capstan
