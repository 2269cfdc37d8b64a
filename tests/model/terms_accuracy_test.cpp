// SPDX-License-Identifier: Apache-2.0
// Every effect by itself, in fixed point against double, at the limits of its declared range.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "capstan/model/declared_range.hpp"
#include "capstan/model/effort_catalogue.hpp"
#include "capstan/tests/model/support.hpp"

namespace capstan {
namespace {

using test::number;
using test::one_khz;
using test::RandomMultisine;
using test::value_of;
using Range = DeclaredRange;
using Effect = DeclaredEffectRange;

constexpr int kSamples = 600000;  // ten minutes at 1 kHz
constexpr double kBound = 2e-5;   // rad, and N m
constexpr double kCount = 2.0 * 3.14159265358979323846 / 8192.0;

/// One measured instant of two axes in band-limited random motion with reversals and rests, as 8192-count encoders read
/// it, with a temperature that rises.
class Motion {
 public:
  void advance() {
    time_ += 0.001;
    motion_time_ += 0.001 * std::clamp(2.0 * (0.7 + std::sin(0.37 * time_)), 0.0, 1.0);
  }
  template <typename Scalar>
  [[nodiscard]] auto now() const -> Measured<Scalar> {
    Measured<Scalar> m;
    m.q1 = number<Scalar>(kCount * std::round(angle_(motion_time_) / kCount));
    m.tau = number<Scalar>(torque_(time_));
    m.others.fill({.q1 = number<Scalar>(other_angle_(time_)),
                   .tau = number<Scalar>(other_torque_(time_)),
                   .forward = std::sin(time_) > 0.0});
    m.temperature = number<Scalar>(25.0 + Effect::kWarmthK * std::min(1.0, time_ / 300.0));
    return m;
  }

 private:
  RandomMultisine angle_{301, Range::kMotorAngleRad, 0.05, 1.2};
  RandomMultisine torque_{302, Range::kTorqueNm, 0.05, 2.0};
  RandomMultisine other_angle_{303, Range::kMotorAngleRad, 0.05, 1.2};
  RandomMultisine other_torque_{304, Range::kTorqueNm, 0.05, 2.0};
  double time_ = 0.0;
  double motion_time_ = 0.0;
};

/// q2 = beta q1 + the effect, fed with its own last estimate.
template <template <typename> typename Term, typename Scalar>
class Law {
 public:
  static constexpr std::size_t kCoefficients = kCoefficientsOf<Term<double>>;
  static constexpr std::size_t kShapes = kShapesOf<Term<double>>;

  Law(const std::array<double, kCoefficients>& coefficients, const std::array<double, kShapes>& shapes)
      : conditioner_(one_khz<Scalar>(), {}), term_(one_khz<Scalar>(), convert<kShapes>(shapes)) {
    coefficients_ = convert<kCoefficients>(coefficients);
  }
  auto update(Measured<Scalar> now) -> Scalar {
    now.q2 = q2_;
    conditioner_.update(now);
    conditioner_.delay_torque();
    const auto phi = term_.update(conditioner_.sample());
    Scalar effect{};
    for (std::size_t i = 0; i < kCoefficients; ++i) {
      saturated_ |= ScalarTraits<Scalar>::is_saturated(phi[i]);
      effect += coefficients_[i] * phi[i];
    }
    q2_ = number<Scalar>(0.9373) * now.q1 + effect;
    return effect;
  }
  [[nodiscard]] auto saturated() const -> bool { return saturated_; }

 private:
  template <std::size_t Count>
  static auto convert(const std::array<double, Count>& values) -> std::array<Scalar, Count> {
    std::array<Scalar, Count> result{};
    std::transform(values.begin(), values.end(), result.begin(), number<Scalar>);
    return result;
  }

  SampleConditioner<Scalar> conditioner_;
  Term<Scalar> term_;
  std::array<Scalar, kCoefficients> coefficients_{};
  Scalar q2_{};
  bool saturated_ = false;
};

template <template <typename> typename Term>
void expect_accurate(const std::array<double, kCoefficientsOf<Term<double>>>& coefficients,
                     const std::array<double, kShapesOf<Term<double>>>& shapes) {
  Law<Term, double> exact(coefficients, shapes);
  Law<Term, Q24> fixed(coefficients, shapes);
  Motion motion;
  double worst = 0.0;
  double largest = 0.0;
  for (int i = 0; i < kSamples; ++i, motion.advance()) {
    const double expected = exact.update(motion.now<double>());
    largest = std::fmax(largest, std::fabs(expected));
    worst = std::fmax(worst, std::fabs(value_of(fixed.update(motion.now<Q24>())) - expected));
  }
  std::printf("law %s | effects to %.2f rad or N m | %.1e rad or N m\n", Term<double>::kInfo.name, largest, worst);
  EXPECT_LT(worst, kBound);
  EXPECT_FALSE(fixed.saturated());
  EXPECT_GT(largest, 1000.0 * kBound) << "the effect must show, or this test shows nothing";
}

// Just inside each limit, and on no number that fixed point holds exactly.
TEST(EffectAccuracy, OfReversalMemory) {
  expect_accurate<ReversalMemory>({0.9999 * Effect::kMemoryRadPerNm, 0.9997 * Effect::kMemoryRadPerNm}, {});
}
TEST(EffectAccuracy, OfSlipPropagationThatFades) {
  expect_accurate<SlipPropagation>({-0.1, 0.9999 * Effect::kFadingRadPerNm, -0.9997 * Effect::kFadingRadPerNm},
                                   {0.9999 * Range::kSlipTorqueNm});
  constexpr double kSmallNm = 0.0113;
  constexpr double kInProportion = kSmallNm * Effect::kFadingRadPerNm;
  expect_accurate<SlipPropagation>({0.0, 0.9999 * kInProportion, 0.9997 * kInProportion}, {kSmallNm});
}
TEST(EffectAccuracy, OfPresliding) {
  expect_accurate<Presliding>({0.9999 * Effect::kPreslidingGain}, {0.9999 * Effect::kPreslidingWidthRad});
  expect_accurate<Presliding>({0.9999 * Effect::kPreslidingGain}, {0.0113});
}
TEST(EffectAccuracy, OfGravityFedWithItsOwnEstimate) {
  expect_accurate<Gravity>({0.7071 * Effect::kGravityRad, -0.7071 * Effect::kGravityRad}, {});
}
TEST(EffectAccuracy, OfAxisCoupling) {
  expect_accurate<AxisCoupling>(
      {0.9999 * Effect::kCouplingRatio, -0.9999 * Effect::kCouplingRadPerNm, -0.9997 * Effect::kCouplingRadPerNm}, {});
}
TEST(EffectAccuracy, OfViscoelasticCreepFastAndSlow) {
  expect_accurate<ViscoelasticCreep>({-0.9999 * Effect::kCreepRadPerNm}, {0.0137});
  expect_accurate<ViscoelasticCreep>({-0.9999 * Effect::kCreepRadPerNm}, {119.7});
}
TEST(EffectAccuracy, OfThermalDriftFastAndSlow) {
  expect_accurate<ThermalDrift>({0.9999 * Effect::kWarmUpRad, 0.9999 * Effect::kWarmthRadPerK}, {0.0513});
  expect_accurate<ThermalDrift>({0.9999 * Effect::kWarmUpRad, -0.9999 * Effect::kWarmthRadPerK}, {119.7});
}
TEST(EffectAccuracy, OfAnglePeriodic) {
  expect_accurate<AnglePeriodic>({0.9999 * Effect::kPeriodicRad, 0.9997 * Effect::kPeriodicRad},
                                 {0.9999 * Effect::kPeriodicOrder});
}
TEST(EffectAccuracy, OfStiffnessHardening) {
  const std::array<double, 2> coefficients = {0.9999 * Effect::kHardeningRadPerNm2,
                                              0.9997 * Effect::kHardeningRadPerNm2};
  expect_accurate<StiffnessHardening>(coefficients, {0.0021});
  expect_accurate<StiffnessHardening>(coefficients, {0.9999 * Range::kTorqueNm});
}
TEST(EffectAccuracy, OfLoadInertia) {
  expect_accurate<LoadInertia>({-0.9999 * Effect::kInertia}, {});
}

// Efforts for a motor with friction of about 1 N m.
TEST(EffortAccuracy, OfEveryTerm) {
  expect_accurate<effort::Inertia>({0.4137}, {});
  expect_accurate<effort::ViscousFriction>({0.0513}, {});
  expect_accurate<effort::CoulombFriction>({0.7113}, {});
  expect_accurate<effort::FrictionAsymmetry>({0.3117, 0.0213}, {});
  expect_accurate<effort::StribeckFriction>({0.5713}, {1.0713});
  expect_accurate<effort::PlayFriction>({0.4117, 0.3713, 0.2171}, {0.0513});
  expect_accurate<effort::Offset>({-0.4117}, {});
  // Superlinear only: below 1, a unit of the rate at standstill is worth (6e-8)^p; power_test has the power itself.
  expect_accurate<effort::PowerLawFriction>({0.4113}, {2.0171, 5.9713});
  expect_accurate<effort::Spring>({0.8117, -0.2113}, {0.1013, 1.0713});
  expect_accurate<effort::LoadFriction>({0.3117, 0.2113, 0.1171, -0.0917}, {0.3013, 1.0713});
}

}  // namespace
}  // namespace capstan
