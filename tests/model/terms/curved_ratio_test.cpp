// SPDX-License-Identifier: Apache-2.0
#include "capstan/model/terms/curved_ratio.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>

#include "capstan/tests/model/support.hpp"

namespace capstan {
namespace {

using test::number;
using test::one_khz;
using test::value_of;

static_assert(SumTerm<CurvedRatio<double>, double> && SumTerm<CurvedRatio<Q24>, Q24>);

template <typename Scalar>
auto curve_of(double centre, double span) -> CurvedRatio<Scalar> {
  return {one_khz<Scalar>(), {number<Scalar>(centre), number<Scalar>(span)}};
}

/// u^n inside, its tangent outside, written as the integral of its slope.
auto by_slope(double u, int n) -> double {
  const double inside = std::fmax(-1.0, std::fmin(1.0, u));
  return std::pow(inside, n) + n * std::pow(inside, n - 1) * (u - inside);
}

RC_GTEST_PROP(CurvedRatio, IsSquareAndCubeInsideItsSpanAndTangentsOutside, ()) {
  const double centre = 0.01 * *rc::gen::inRange(-3000, 3001);
  const double span = 0.01 * *rc::gen::inRange(10, 3001);
  const double h = centre + span * 0.001 * *rc::gen::inRange(-2000, 2001);
  const double u = (h - centre) / span;
  Sample<double> sample{.h = h};
  const auto phi = curve_of<double>(centre, span).update(sample);
  RC_ASSERT(std::fabs(phi[0] - by_slope(u, 2)) < 1e-12 && std::fabs(phi[1] - by_slope(u, 3)) < 1e-12);
  const auto fixed = curve_of<Q24>(centre, span).update({.h = number<Q24>(h)});
  // A rounding of h and of the centre is one of u over the span; phi3 has slope 3 and three roundings of its own.
  const double bound = (3.0 * 2.0 / span + 12.0) * test::kLsb;
  RC_ASSERT(std::fabs(fixed[0].to_double() - phi[0]) < bound && std::fabs(fixed[1].to_double() - phi[1]) < bound);
}

TEST(CurvedRatio, SeesWhatComesOutOfTheHysteresisAndNotTheMotor) {
  auto curve = curve_of<double>(0.0, 2.0);
  EXPECT_EQ(curve.update({.q1 = 9.0, .h = 1.0})[0], 0.25);
}

TEST(CurvedRatio, SaysThatADistanceMetTheEndOfTheRange) {
  const auto phi = curve_of<Q24>(-100.0, 60.0).update({.h = number<Q24>(100.0)});
  EXPECT_TRUE(phi[0].is_saturated() && phi[1].is_saturated());
}

/// Ratio and curve by parts of beta: c2, c3 such that the slope stays above a fifth of beta.
struct Joint {
  double beta, c2, c3, centre, span;
  [[nodiscard]] auto angle(double h) const -> double {
    const double u = (h - centre) / span;
    return beta * h + c2 * by_slope(u, 2) + c3 * by_slope(u, 3);
  }
  /// The least slope anywhere, over beta, by looking: beyond the ends it stays. Too large by at most 3 |c3| / (span
  /// |beta|) times the square of half a step.
  [[nodiscard]] auto least_slope_share() const -> double {
    double least = 1e9;
    for (int i = -kLooks; i <= kLooks; ++i) {
      const double u = static_cast<double>(i) / kLooks;
      least = std::fmin(least, 1.0 + (2.0 * c2 + 3.0 * c3 * u) * u / (span * beta));
    }
    return least;
  }
  static constexpr int kLooks = 1000;
};

auto any_joint() -> Joint {
  Joint joint{};
  joint.beta = 0.01 * *rc::gen::inRange(20, 200) * *rc::gen::element(-1.0, 1.0);
  joint.centre = 0.1 * *rc::gen::inRange(-50, 51);
  joint.span = 0.01 * *rc::gen::inRange(20, 2000);
  const double room = 0.8 * std::fabs(joint.beta) * joint.span;  // of |2 c2 + 3 c3|, so that a fifth of beta is left
  const double share = 0.01 * *rc::gen::inRange(-100, 101);
  const double rest = 0.01 * *rc::gen::inRange(-100, 101) * (1.0 - std::fabs(share));
  joint.c2 = 0.5 * room * share;
  joint.c3 = room / 3.0 * rest;
  return joint;
}

template <typename Scalar>
auto inverse_of(const Joint& joint) -> CurveInverse<Scalar> {
  return {number<Scalar>(joint.beta),
          number<Scalar>(joint.c2),
          number<Scalar>(joint.c3),
          {number<Scalar>(joint.centre), number<Scalar>(joint.span)}};
}

RC_GTEST_PROP(CurvedRatio, IsTurnedRoundFromWhereTheMotorWas, ()) {
  const Joint joint = any_joint();
  const double h = joint.centre + joint.span * 0.001 * *rc::gen::inRange(-1500, 1501);
  RC_PRE(std::fabs(joint.angle(h)) < 100.0 && std::fabs(h) < 60.0);
  RC_ASSERT(joint.least_slope_share() > 0.19);
  const auto exact = inverse_of<double>(joint);
  const auto fixed = inverse_of<Q24>(joint);
  const double y = joint.angle(h);
  const double near = h + *rc::gen::element(0.0, 0.001, -0.01) * joint.span;
  RC_ASSERT(std::fabs(exact(y, near) - h) < 2.0 * 1.2e-7 / (0.19 * std::fabs(joint.beta)) * joint.span + 1e-12);
  // In spans: the curve's three products, its coefficients and what is wanted, over the least slope; then the span.
  const double rounding = joint.span * (10.0 / (0.19 * std::fabs(joint.beta)) + 4.0) * (1.0 + 1.0 / joint.span) +
                          (2.0 + std::fabs(h)) / (0.19 * std::fabs(joint.beta)) + 4.0;
  RC_ASSERT(std::fabs(fixed(number<Q24>(y), number<Q24>(near)).to_double() - h) < 2.0 * rounding * test::kLsb);
}

// A reference that jumps: a few cycles, each from the last one's answer.
RC_GTEST_PROP(CurvedRatio, IsTurnedRoundFromAnywhereInAFewCycles, ()) {
  const Joint joint = any_joint();
  const double h = joint.centre + joint.span * 0.001 * *rc::gen::inRange(-1000, 1001);
  const auto exact = inverse_of<double>(joint);
  double near = joint.centre + joint.span * 0.001 * *rc::gen::inRange(-3000, 3001);
  for (int cycle = 0; cycle < 5; ++cycle) {
    near = exact(joint.angle(h), near);
  }
  // It stops at two units of the last place, in spans, over the least slope.
  RC_ASSERT(std::fabs(near - h) < 1.2e-7 / (0.19 * std::fabs(joint.beta)) * 2.0 * joint.span + 1e-12);
}

// Flat at both ends and steep between: Newton's step from one end goes past the other, and back.
TEST(CurvedRatio, IsTurnedRoundFromTheFarEndOfAnS) {
  const Joint s{1.0, 0.0, -0.26, 0.0, 1.0};  // beta, c2, c3, centre, span
  double near = 1.0;
  for (int cycle = 0; cycle < 3; ++cycle) {
    near = inverse_of<double>(s)(s.angle(0.01), near);
  }
  EXPECT_NEAR(near, 0.01, 1e-6);
}

TEST(CurvedRatio, TellsWhetherTheJointFollowsItsMotorEverywhere) {
  const auto follows = [](double beta, double c2, double c3, double span) {
    return follows_everywhere(number<Q24>(beta), number<Q24>(c2), number<Q24>(c3), number<Q24>(span));
  };
  EXPECT_TRUE(follows(1.0, 0.0, 0.0, 1.0)) << "straight";
  EXPECT_TRUE(follows(2.0, 0.9, 0.0, 1.0)) << "2 + 2 c2 u at u = -1: a tenth of beta";
  EXPECT_FALSE(follows(2.0, 0.96, 0.0, 1.0)) << "a twenty-fifth";
  EXPECT_TRUE(follows(-2.0, 0.9, 0.0, 1.0)) << "crossed";
  EXPECT_FALSE(follows(-2.0, 0.96, 0.0, 1.0)) << "crossed";
  EXPECT_FALSE(follows(1.0, 0.0, -0.5, 1.0)) << "turns back at both ends";
  EXPECT_TRUE(follows(1.0, 0.5, 0.3, 1.0)) << "inside the span: 1 - c2^2 / (3 c3) is 0.72";
  EXPECT_FALSE(follows(1.0, 1.4, 0.66, 1.0)) << "inside the span: 0.01, and at the ends 0.18 and more";
}

RC_GTEST_PROP(CurvedRatio, IsCheckedAsItsSlopeIsWhereItIsLeast, ()) {
  const double beta = 0.01 * *rc::gen::inRange(5, 200) * *rc::gen::element(-1.0, 1.0);
  const double span = 0.01 * *rc::gen::inRange(10, 12000);
  const double c2 = 0.001 * *rc::gen::inRange(-1000, 1001) * std::fabs(beta) * span;
  const double c3 = 0.001 * *rc::gen::inRange(-1000, 1001) * std::fabs(beta) * span;
  RC_PRE(std::fabs(c2) < 100.0 && std::fabs(c3) < 100.0);
  const double share = Joint{beta, c2, c3, 0.0, span}.least_slope_share();
  const double doubt = 16.0 * 0x1p-16 / (std::fabs(beta) * span) + 1e-6;  // of the coarse numbers, and of looking
  constexpr double kLeastShare = 0.05;
  RC_PRE(std::fabs(share - kLeastShare) > doubt * (1.0 + std::fabs(share)));
  RC_ASSERT(follows_everywhere(number<Q24>(beta), number<Q24>(c2), number<Q24>(c3), number<Q24>(span)) ==
            (share > kLeastShare));
}

}  // namespace
}  // namespace capstan
