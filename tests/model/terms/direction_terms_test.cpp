// SPDX-License-Identifier: Apache-2.0
// The terms without memory of their own: what they yield is the sample, sorted by the direction.
#include <gtest/gtest.h>
#include <algorithm>
#include <vector>

#include "capstan/tests/model/integrated_tension.hpp"
#include "capstan/tests/model/support.hpp"

namespace capstan {
namespace {

using test::number;
using test::one_khz;
using test::value_of;

template <typename Scalar>
class Terms : public testing::Test {
 protected:
  static auto sample(bool forward) -> Sample<Scalar> {
    Sample<Scalar> sample;
    sample.q1 = sample.h = number<Scalar>(1.5);
    sample.dq1 = sample.dh = number<Scalar>(-2.25);
    sample.tau = number<Scalar>(0.375);
    sample.forward = forward;
    return sample;
  }
  template <template <typename> typename Term>
  static auto make() -> Term<Scalar> {
    return Term<Scalar>(one_khz<Scalar>(), {});
  }
};
using Formats = testing::Types<double, Q24>;
TYPED_TEST_SUITE(Terms, Formats);

TYPED_TEST(Terms, RigidPartIsTheMotorAngleAndOne) {
  auto angle = this->template make<MotorAngle>();
  auto offset = this->template make<JointOffset>();
  EXPECT_EQ(value_of(angle.update(this->sample(true))[0]), 1.5);
  EXPECT_EQ(value_of(angle.steady_state(this->sample(false))[0]), 1.5);
  EXPECT_EQ(value_of(offset.update(this->sample(true))[0]), 1.0);
  EXPECT_EQ(value_of(offset.steady_state(this->sample(false))[0]), 1.0);
}

TYPED_TEST(Terms, ElongationGivesTheTorqueToThePulledTendonAlone) {
  auto term = this->template make<TendonElongation>();
  const auto forward = term.update(this->sample(true));
  const auto backward = term.update(this->sample(false));
  EXPECT_EQ(value_of(forward[0]), 0.375);
  EXPECT_EQ(value_of(forward[1]), 0.0);
  EXPECT_EQ(value_of(backward[0]), 0.0);
  EXPECT_EQ(value_of(backward[1]), 0.375);
  EXPECT_EQ(term.steady_state(this->sample(true)), forward);
  EXPECT_EQ(term.steady_state(this->sample(false)), backward);
}

TYPED_TEST(Terms, ViscousGivesTheRateToThePulledTendonAlone) {
  auto term = this->template make<TransmissionViscous>();
  const auto forward = term.update(this->sample(true));
  const auto backward = term.update(this->sample(false));
  EXPECT_EQ(value_of(forward[0]), -2.25);
  EXPECT_EQ(value_of(forward[1]), 0.0);
  EXPECT_EQ(value_of(backward[0]), 0.0);
  EXPECT_EQ(value_of(backward[1]), -2.25);
  EXPECT_EQ(term.steady_state(this->sample(true)), forward);
  EXPECT_EQ(term.steady_state(this->sample(false)), backward);
}

// What the term's header says of its sign, from the integral of (6.17).
TEST(TransmissionViscousSign, DragShortensAPulledTendonByWhatTheHeaderSays) {
  constexpr double kDragN = 2.4;  // b L v
  constexpr double kInputN = 20.0;
  for (const double eta : {0.03, 0.7, 1.1414, 2.5}) {
    const test::Integrated with = test::integrate(eta, 1.0, kInputN, 1.0, kDragN);
    const test::Integrated without = test::integrate(eta, 1.0, kInputN);
    EXPECT_NEAR(without.end_tension - with.end_tension, kDragN * mean_decay(eta), 1e-9 * kInputN) << eta;
    EXPECT_NEAR(without.area - with.area, kDragN * (1.0 - mean_decay(eta)) / eta, 1e-9 * kInputN) << eta;
    EXPECT_GT(without.area, with.area) << "the joint is ahead: g > 0";
  }
}

TYPED_TEST(Terms, PretensionIsPlusOneForwardAndMinusOneBack) {
  auto term = this->template make<PretensionOffset>();
  EXPECT_EQ(value_of(term.update(this->sample(true))[0]), 1.0);
  EXPECT_EQ(value_of(term.update(this->sample(false))[0]), -1.0);
  EXPECT_EQ(value_of(term.steady_state(this->sample(false))[0]), -1.0);
}

// On a triangle of slope v the motor rate is known without any filter: +v up, -v down, once the filter has settled.
TYPED_TEST(Terms, ViscousRegressorsOfATriangleAreItsTwoSlopes) {
  constexpr double kSlope = 2.0;
  SampleConditioner<TypeParam> conditioner(one_khz<TypeParam>(), {});
  auto term = this->template make<TransmissionViscous>();
  for (int i = 0; i < 4000; ++i) {
    const double phase = 0.001 * (i % 2000);
    const double q1 = kSlope * (phase < 1.0 ? phase : 2.0 - phase);
    const auto phi = term.update(conditioner.update(number<TypeParam>(q1), number<TypeParam>(0.0)));
    if (const double since_turn = phase < 1.0 ? phase : phase - 1.0; since_turn > 0.2) {  // forty time constants
      ASSERT_NEAR(value_of(phi[0]), phase < 1.0 ? kSlope : 0.0, 1e-4) << i;
      ASSERT_NEAR(value_of(phi[1]), phase < 1.0 ? 0.0 : -kSlope, 1e-4) << i;
    }
  }
}

TEST(Catalogue, EveryNameIsSnakeCaseAndNoneRepeats) {
  std::vector<std::string_view> names;
  auto collect = [&names]<typename Term>() { names.emplace_back(Term::kInfo.name); };
  SumTerms::for_each<double>(collect);
  OutputTerms::for_each<double>(collect);
  for (std::size_t i = 0; i < names.size(); ++i) {
    EXPECT_FALSE(names[i].empty());
    EXPECT_EQ(names[i].find_first_not_of("abcdefghijklmnopqrstuvwxyz_0123456789"), std::string_view::npos) << names[i];
    EXPECT_EQ(std::count(names.begin(), names.end(), names[i]), 1) << names[i];
  }
}

TEST(Catalogue, EveryShapeStartsInsideItsRangeAndTheRangeFitsFixedPoint) {
  auto verify = []<typename Term>() {
    for (const ShapeInfo& shape : Term::kInfo.shapes) {
      EXPECT_LE(shape.minimum, shape.initial) << shape.name;
      EXPECT_LE(shape.initial, shape.maximum) << shape.name;
      EXPECT_FALSE(Q24::from_double(shape.minimum).is_saturated()) << shape.name;
      EXPECT_FALSE(Q24::from_double(shape.maximum).is_saturated()) << shape.name;
    }
  };
  SumTerms::for_each<double>(verify);
  OutputTerms::for_each<double>(verify);
}

}  // namespace
}  // namespace capstan
