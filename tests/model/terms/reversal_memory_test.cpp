// SPDX-License-Identifier: Apache-2.0
#include "capstan/model/terms/reversal_memory.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "capstan/model/terms/pretension_offset.hpp"
#include "capstan/model/terms/tendon_elongation.hpp"
#include "capstan/tests/model/support.hpp"

namespace capstan {
namespace {

using test::number;
using test::one_khz;
using test::value_of;

static_assert(SumTerm<ReversalMemory<double>, double> && SumTerm<ReversalMemory<Q24>, Q24>);

/// A joint of appendix A, tendons unlike each other.
constexpr double kR1 = 2.6e-3;
constexpr double kR2 = 2.4e-3;
constexpr double kEtaTop = 1.2;
constexpr double kEtaBottom = 0.8;
constexpr double kKnTop = 5.0e4;
constexpr double kKnBottom = 4.0e4;
constexpr double kLambda = 8.0e-4;  // m

auto simpson(const std::function<double(double)>& f) -> double {
  constexpr int kIntervals = 2000;
  double sum = f(0.0) + f(1.0);
  for (int i = 1; i < kIntervals; ++i) {
    sum += (i % 2 == 1 ? 4.0 : 2.0) * f(static_cast<double>(i) / kIntervals);
  }
  return sum / (3.0 * kIntervals);
}

/// Stretch of the top tendon, m, when all of both slips in direction s under a torque: the two tensions at the motor
/// from torque and constant total stretch, every integral by quadrature.                       (A.5), (A.7), (A.11)
auto top_stretch(double tau, double s) -> double {
  const double top = simpson([s](double phi) { return std::exp(-kEtaTop * s * phi); }) / kKnTop;
  const double bottom = simpson([s](double phi) { return std::exp(kEtaBottom * s * phi); }) / kKnBottom;
  // top T_t + bottom T_b = Lambda,  T_t - T_b = tau / r1
  return top * (kLambda + bottom * tau / kR1) / (top + bottom);
}

struct Compliance {
  double forward;
  double backward;
};
/// a b / (r1 r2 (a + b)) of (A.15) for both directions; c and d are a and b of the other one.
auto compliance() -> Compliance {
  const auto of = [](double s) {
    const double a = -s / (kEtaTop * kKnTop) * (std::exp(-kEtaTop * s) - 1.0);
    const double b = s / (kEtaBottom * kKnBottom) * (std::exp(kEtaBottom * s) - 1.0);
    return a * b / (kR1 * kR2 * (a + b));
  };
  return {of(1.0), of(-1.0)};
}

// A.16 over one stroke: the law's change since the reversal is the stretch since then, for any torques.
TEST(ReversalMemory, WithElongationAndPretensionIsTheStretchSinceTheReversal) {
  const auto [forward, backward] = compliance();
  for (const double s : {1.0, -1.0}) {
    for (const double tau0 : {-0.05, 0.02, 0.09}) {
      for (const double tau : {-0.04, 0.0, 0.07}) {
        SampleConditioner<double> conditioner(one_khz<double>(), {});
        conditioner.update(s * 0.5, 0.0);
        conditioner.update(0.0, tau0);  // comes from the other side and turns here
        const auto sample = conditioner.update(s * 0.1, tau);
        ASSERT_EQ(sample.forward, s > 0.0);
        const auto memory = ReversalMemory<double>(one_khz<double>(), {}).update(sample);
        const auto elongation = TendonElongation<double>(one_khz<double>(), {}).update(sample);
        const double pretension = top_stretch(0.0, s) - top_stretch(0.0, -s);
        const double law = -forward * elongation[0] - backward * elongation[1] + backward * memory[0] +
                           forward * memory[1] - pretension / kR2;
        const double stretch = top_stretch(tau, s) - top_stretch(tau0, -s);
        ASSERT_NEAR(law, -stretch / kR2, 1e-12) << "tau0 " << tau0 << ", tau " << tau;
      }
    }
  }
}

TEST(ReversalMemory, CoefficientsOfTheThesisArePositive) {
  EXPECT_GT(compliance().forward, 0.0);
  EXPECT_GT(compliance().backward, 0.0);
  EXPECT_EQ(ReversalMemory<double>::kInfo.coefficients[0].sign, Sign::kNonNegative);
  EXPECT_EQ(ReversalMemory<double>::kInfo.coefficients[1].sign, Sign::kNonNegative);
}

template <typename Scalar>
class MemoryTerm : public testing::Test {};
using Formats = testing::Types<double, Q24>;
TYPED_TEST_SUITE(MemoryTerm, Formats);

TYPED_TEST(MemoryTerm, GivesTheTorqueOfTheReversalToThePulledTendonAlone) {
  ReversalMemory<TypeParam> term(one_khz<TypeParam>(), {});
  Sample<TypeParam> sample{.tau = number<TypeParam>(9.0), .tau_reversal = number<TypeParam>(-0.375)};
  auto phi = term.update(sample);
  EXPECT_EQ(value_of(phi[0]), -0.375);
  EXPECT_EQ(value_of(phi[1]), 0.0);
  sample.forward = false;
  phi = term.update(sample);
  EXPECT_EQ(value_of(phi[0]), 0.0);
  EXPECT_EQ(value_of(phi[1]), -0.375);
  EXPECT_EQ(term.steady_state(sample), phi);
}

}  // namespace
}  // namespace capstan
