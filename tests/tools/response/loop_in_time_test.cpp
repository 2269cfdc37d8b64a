// SPDX-License-Identifier: Apache-2.0
// The servo run cycle by cycle, against what its frequency response says and with what that leaves out.
#include "capstan/tools/response/loop_in_time.hpp"

#include <gtest/gtest.h>

#include "capstan/tools/response/limit_cycle.hpp"

namespace capstan::tools {
namespace {

/// About the simulated forceps; its gains as `commission` finds them.
auto motor() -> MotorModel {
  return {.inertia_kgm2 = 2e-5, .viscous_nms = 4e-4, .delay_s = 6e-4, .lag_s = 2e-4, .hold_s = 1e-3};
}
auto forceps_gains() -> LoopGains {
  LoopGains gains;
  gains.ki_per_s = 30.0;
  gains.stiffness = 0.58;
  gains.damping = 0.0061;
  gains.rate_time_constant_s = 2e-4;
  gains.rate_nm = 0.0056;
  return gains;
}

/// As a perfect log would show it, of a joint that travels so fast.
auto response_of(const MotorModel& model, const LoopGains& gains, double way_rad_s) -> Response {
  Response all{.name = "known", .points = {}, .distortion = {}};
  for (double hz = 1.0; hz < 400.0; hz *= 1.12) {
    ResponsePoint point{.hz = hz};
    point.motor = {model.at(hz), 1e-3 * std::abs(model.at(hz))};
    point.joint = {1.0, 0.0};
    const Law law = law_of(gains, hz);
    point.loop.value = model.at(hz) * (law.servo + through_joint(gains, law, 1.0, 1.0));
    point.loop.radius95 = 1e-3 * std::abs(point.loop.value);
    point.coherence = 1.0;
    all.points.push_back(point);
  }
  all.travels = way_rad_s > 0.0;
  all.motor_speed_rad_s = way_rad_s;
  all.forward_nm = 0.08;
  all.backward_nm = -0.08;
  return all;
}

TEST(LoopInTime, WithFineStepsAndWithoutALimitItSwingsWhereTheFrequencyResponseSays) {
  LoopGains gains = forceps_gains();
  gains.counts_per_turn = 1e8;
  gains.rate_nm = 50.0;
  MotorModel with_joint = motor();
  with_joint.joint_inertia_kgm2 = 1e-5;
  with_joint.joint_hz = 40.0;
  with_joint.joint_damping = 0.05;
  with_joint.joint_drag = 0.05;
  for (const MotorModel& model : {motor(), with_joint}) {
    const auto cycle = predict_limit_cycle(response_of(model, gains, 0.0), gains);
    ASSERT_TRUE(cycle);
    const LoopInTime loop(model, gains, 1.0, 0.08);
    EXPECT_FALSE(loop.swings(0.97 * cycle->onset, 0.5)) << cycle->onset;
    EXPECT_TRUE(loop.swings(1.03 * cycle->onset, 0.5)) << cycle->onset;
    EXPECT_NEAR(loop.at(1.03 * cycle->onset, 0.5).hz, cycle->hz, 0.05 * cycle->hz);
  }
}

TEST(LoopInTime, FrictionHoldsASwingBetweenItsWaysSpeedAndFourteenTenthsOfIt) {
  LoopGains gains = forceps_gains();
  gains.rate_nm = 50.0;
  const auto cycle = predict_limit_cycle(response_of(motor(), gains, 0.0), gains);
  ASSERT_TRUE(cycle);
  const double speed = LoopInTime(motor(), gains, 1.0, 0.08).at(1.1 * cycle->onset, 0.5).speed_rad_s;
  EXPECT_GT(speed, 0.45);
  EXPECT_LT(speed, 0.75);
}

TEST(LoopInTime, BentItHasTheResponseThatIsGiven) {
  LoopInTime loop(motor(), forceps_gains(), 1.0, 0.08);
  const Complex asked = 0.9 * std::polar(1.0, -0.05) * motor().at(160.0);
  loop.bend(160.0, asked);
  EXPECT_LT(std::abs(loop.model().at(160.0) - asked), 1e-3 * std::abs(asked));
}

TEST(LimitCycle, StepsOfTheEncoderThatMeetTheGatesLimitBringItForward) {
  // A count is 35 mA of torque at four times these gains, and the gate lets 56 mA through in a cycle.
  LoopGains gains = forceps_gains();
  const auto cycle = predict_limit_cycle(response_of(motor(), gains, 0.5), gains);
  ASSERT_TRUE(cycle);
  EXPECT_LT(cycle->onset, 0.93 * cycle->smooth_onset);
  EXPECT_GT(cycle->onset, 0.6 * cycle->smooth_onset);
  EXPECT_NE(sentence_of(*cycle, 0.5).find("if the gate did not limit"), std::string::npos);
  gains.counts_per_turn = 1e6;
  const auto fine = predict_limit_cycle(response_of(motor(), gains, 0.5), gains);
  ASSERT_TRUE(fine);
  EXPECT_GT(fine->onset, 0.95 * fine->smooth_onset);
  EXPECT_EQ(sentence_of(*fine, 0.5).find("if the gate did not limit"), std::string::npos);
}

TEST(Tuning, GainsThatSwingSoonerForTheGatesLimitAreNotChosen) {
  LoopGains gains = forceps_gains();
  gains.rate_nm = 50.0;
  const Response response = response_of(motor(), gains, 0.5);
  Wanted wanted;
  wanted.onset = 3.8;
  LoopGains careless = tune(response, gains, wanted).gains;
  careless.rate_nm = gains.rate_nm = 0.003;
  const auto sooner = predict_limit_cycle(response, careless);
  ASSERT_TRUE(sooner);
  EXPECT_LT(sooner->onset, 0.95 * wanted.onset) << "or this test asks nothing";
  const LoopGains held = tune(response, gains, wanted).gains;
  const auto cycle = predict_limit_cycle(response, held);
  ASSERT_TRUE(cycle);
  EXPECT_GE(cycle->onset, 0.98 * wanted.onset);
  EXPECT_LT(held.stiffness, careless.stiffness);
}

TEST(Tuning, TheDumpTellsHowFastTheGateLetsTheTorqueChange) {
  const std::string dump = "set joint0.motor.torque_per_current 0.1 Nm/A\nset joint0.limits.joint_speed 2 rad/s\n";
  EXPECT_NEAR(read_gains(dump, 0).rate_nm, 0.05, 1e-6) << "limits.current_rate of the firmware";
  EXPECT_NEAR(read_gains(dump + "set joint0.limits.current_rate 0.2 A/cycle\n", 0).rate_nm, 0.02, 1e-6);
  // The observer's: half of joint_speed in two cycles, J v / 4 / 2 cycles.
  EXPECT_NEAR(read_gains(dump + "set joint0.observer.inertia 0.0222354 gm2\n", 0).rate_nm, 0.00556, 1e-5);
}

}  // namespace
}  // namespace capstan::tools
