// SPDX-License-Identifier: Apache-2.0
// Before the templates that are used with it.
#include "capstan/tests/boards/stm32f405/single_precision.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "capstan/model/declared_range.hpp"
#include "capstan/tests/model/support.hpp"

namespace capstan {
namespace {

using test::LawBuilder;
using test::number;
using test::RandomMultisine;
using Range = DeclaredRange;

constexpr int kSamples = 600000;  // ten minutes at 1 kHz
constexpr double kBound = 2e-5;   // rad
constexpr double kCount = 2.0 * 3.14159265358979323846 / 8192.0;

/// Band-limited random motion of the motor with reversals, now and then at rest, as an 8192-count encoder reads it.
class Motion {
 public:
  Motion(std::uint32_t seed, double amplitude_rad, double torque_nm)
      : angle_(seed, amplitude_rad, 0.05, 1.2), torque_(seed + 1, torque_nm, 0.05, 2.0) {}
  void advance() {
    time_ += 0.001;
    motion_time_ +=
        0.001 * std::clamp(2.0 * (0.7 + std::sin(0.37 * time_)), 0.0, 1.0);  // at rest a quarter of the time
  }
  [[nodiscard]] auto q1() const -> double { return kCount * std::round(angle_(motion_time_) / kCount); }
  [[nodiscard]] auto tau() const -> double { return torque_(time_); }

 private:
  RandomMultisine angle_;
  RandomMultisine torque_;
  double time_ = 0.0;
  double motion_time_ = 0.0;
};

struct Outcome {
  double worst_now = 0.0;
  double worst_reported = 0.0;
  double largest_angle = 0.0;
  double largest_step = 0.0;
  double largest_jump = 0.0;
  int reversals = 0;
  int rests = 0;
  int saturated = 0;
};

auto run(const LawBuilder& joint, Motion motion) -> Outcome {
  auto exact = joint.law<double>();
  auto fixed = joint.law<Q24>();
  Outcome outcome;
  bool forward = true;
  double before = motion.q1();
  double estimate_before = 0.0;
  for (int i = 0; i < kSamples; ++i, motion.advance()) {
    const double q1 = motion.q1();
    const auto expected = exact.update(q1, motion.tau());
    const auto estimate = fixed.update(number<Q24>(q1), number<Q24>(motion.tau()));
    outcome.worst_now = std::fmax(outcome.worst_now, std::fabs(estimate.q2.to_double() - expected.q2));
    outcome.worst_reported =
        std::fmax(outcome.worst_reported, std::fabs(estimate.q2_reported.to_double() - expected.q2_reported));
    outcome.largest_angle = std::fmax(outcome.largest_angle, std::fabs(q1));
    outcome.largest_step = std::fmax(outcome.largest_step, std::fabs(q1 - before));
    outcome.largest_jump = std::fmax(outcome.largest_jump, i > 0 ? std::fabs(expected.q2 - estimate_before) : 0.0);
    outcome.reversals += exact.sample().forward != forward ? 1 : 0;
    outcome.rests += q1 == before ? 1 : 0;
    outcome.saturated += estimate.saturated ? 1 : 0;
    forward = exact.sample().forward;
    before = q1;
    estimate_before = expected.q2;
  }
  return outcome;
}

void expect_accurate(const char* name, const Outcome& outcome) {
  std::printf(
      "law motion_law | %s: q1 to %.0f rad, rate to %.0f rad/s | %.1e rad, as a late sensor reports it %.1e rad\n",
      name, outcome.largest_angle, outcome.largest_step * 1000.0, outcome.worst_now, outcome.worst_reported);
  EXPECT_LT(outcome.worst_now, kBound);
  // A delay is held to half a unit, which is 3e-5 of a sample; where the estimate jumps, so much of the jump is early
  // or late.
  EXPECT_LT(outcome.worst_reported, kBound + outcome.largest_jump * 0.5 * test::kLsb * 1000.0);
  EXPECT_EQ(outcome.saturated, 0);
  EXPECT_GT(outcome.reversals, 100) << "the motion must reverse, or the direction switch is not tried";
  EXPECT_GT(outcome.rests, kSamples / 10) << "the motion must rest now and then";
  EXPECT_LT(outcome.largest_step, Range::kMotorRateRadPerS * 0.001) << "the motion must stay in the declared range";
}

TEST(MotionLawAccuracy, OfADaVinciJointIsWithinTheBoundForTenMinutes) {
  LawBuilder joint;
  joint.coefficient("motor_angle", "beta", 1.142)
      .coefficient("joint_offset", "offset", -0.31)
      .coefficient("tendon_elongation", "top", -1.626)
      .coefficient("tendon_elongation", "bottom", -1.213)
      .coefficient("transmission_viscous", "top", -0.021)
      .coefficient("transmission_viscous", "bottom", -0.034)
      .coefficient("pretension_offset", "contrast", 0.017)
      .coefficient("play", "gain", 1.142)
      .shape("play", "half_width", 0.0213)
      .coefficient("slip_propagation", "a", -0.713)
      .shape("slip_propagation", "torque", 0.0511)
      .shape("transport_delay", "delay", 0.0127);
  const auto outcome = run(joint, Motion(101, 3.0, 0.13));
  expect_accurate("da Vinci joint", outcome);
  EXPECT_LT(outcome.worst_reported, kBound);
}

/// The law in one format beside the law in double.
auto worst_in_single_precision(const LawBuilder& joint, Motion motion) -> double {
  auto exact = joint.law<double>();
  MotionLaw<float> single(SamplePeriod<float>(0.001F), joint.parameters<float>());
  double worst = 0.0;
  for (int i = 0; i < kSamples; ++i, motion.advance()) {
    const double expected = exact.update(motion.q1(), motion.tau()).q2;
    const float estimate = single.update(static_cast<float>(motion.q1()), static_cast<float>(motion.tau())).q2;
    worst = std::fmax(worst, std::fabs(static_cast<double>(estimate) - expected));
  }
  return worst;
}

TEST(MotionLawAccuracy, AtTheLimitsOfTheDeclaredRangeIsWithinTheBoundForTenMinutes) {
  // Just inside each limit, and on no number that fixed point holds exactly.
  LawBuilder joint;
  joint.coefficient("motor_angle", "beta", 0.9999 * Range::kBeta)
      .coefficient("joint_offset", "offset", 0.9999 * Range::kOffsetRad)
      .coefficient("tendon_elongation", "top", -0.9999 * Range::kElongationRadPerNm)
      .coefficient("tendon_elongation", "bottom", -0.9997 * Range::kElongationRadPerNm)
      .coefficient("transmission_viscous", "top", -0.9999 * Range::kViscousS)
      .coefficient("transmission_viscous", "bottom", -0.9993 * Range::kViscousS)
      .coefficient("pretension_offset", "contrast", 0.9999 * Range::kContrastRad)
      .coefficient("play", "gain", 0.9999 * Range::kPlayGain)
      .shape("play", "half_width", 0.9999 * Range::kPlayHalfWidthRad)
      .coefficient("slip_propagation", "a", -0.9999 * Range::kElongationRadPerNm)
      .shape("slip_propagation", "torque", 0.9999 * Range::kSlipTorqueNm)
      .shape("transport_delay", "delay", 0.0537);
  const auto outcome = run(joint, Motion(202, Range::kMotorAngleRad, Range::kTorqueNm));
  EXPECT_GT(outcome.largest_angle, 0.7 * Range::kMotorAngleRad);
  expect_accurate("limits of the declared range", outcome);
  // Why the law is not in single precision, which the FPU would run faster: the rate is a difference of two angles.
  const double single = worst_in_single_precision(joint, Motion(202, Range::kMotorAngleRad, Range::kTorqueNm));
  std::printf("law motion_law in float | limits of the declared range | %.1e rad\n", single);
  EXPECT_GT(single, kBound);
}

}  // namespace
}  // namespace capstan
