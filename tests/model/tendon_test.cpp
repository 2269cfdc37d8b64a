// SPDX-License-Identifier: Apache-2.0
#include "capstan/model/tendon.hpp"

#include <gtest/gtest.h>

#include <array>

#include "capstan/tests/model/integrated_tension.hpp"

namespace capstan {
namespace {

using test::integrate;

constexpr double kRelative = 1e-9;
constexpr std::array kEtas = {1e-6, 0.03, 0.7, 1.1414, 2.5};
constexpr double kR1 = 0.0026;
constexpr double kR2 = 0.0024;

TEST(Tendon, ElongationIsTheIntegralOfTheTension) {
  for (const double eta : kEtas) {
    const Tendon tendon{eta, 5.0664e4};
    for (const double s : {1.0, -1.0}) {
      const double expected = integrate(eta, s, 1.0).area / tendon.stiffness;
      EXPECT_NEAR(elongation_per_tension(tendon, s), expected, kRelative * expected) << eta;
    }
  }
}

TEST(Tendon, WithoutFrictionIsASpring) {
  const Tendon tendon{0.0, 2000.0};
  EXPECT_EQ(elongation_per_tension(tendon, 1.0), 1.0 / 2000.0);
  EXPECT_EQ(apparent_stiffness(tendon, -1.0), 2000.0);
}

// Integrates (5.24) and (5.25), and turns elongation into joint angle by compatibility: whatever the top tendon
// stretches, the joint lags. The printed (5.29) has e^+eta, and the other sign for the bottom tendon; both are refuted
// here.
TEST(ElongationCoefficient, IsTheIntegralOf524And525AndNegativeInBothDirections) {
  for (const double eta : kEtas) {
    const Tendon tendon{eta, 5.0664e4};
    const double tau = 0.1;
    // Top pulled: tension tau / r1 enters at the input, the joint turns back by elongation / r2.
    const double top = -integrate(eta, 1.0, tau / kR1).area / tendon.stiffness / kR2 / tau;
    // Bottom pulled: tau < 0, tension -tau / r1; the bottom tendon's stretch lets the joint lag the other way.
    const double bottom = integrate(eta, 1.0, tau / kR1).area / tendon.stiffness / kR2 / -tau;
    const double a = elongation_coefficient(tendon, kR1, kR2);
    EXPECT_NEAR(a, top, -kRelative * top);
    EXPECT_NEAR(a, bottom, -kRelative * bottom);
    EXPECT_LT(a, 0.0);
    if (eta > 0.01) {
      const double printed = (1.0 - std::exp(eta)) / (kR1 * kR2 * eta * tendon.stiffness);
      EXPECT_GT(std::fabs(printed - a), 0.01 * std::fabs(a)) << "the printed exponent gives another number";
    }
  }
}

// Stretches a tendon by a little more and measures: dF / dDelta.
TEST(ApparentStiffness, IsForcePerElongationOfTheMovingPart) {
  for (const double eta : kEtas) {
    const Tendon tendon{eta, 5.0831e4};
    for (const double front : {0.2, 0.75, 1.0}) {
      for (const double s : {1.0, -1.0}) {
        const double more = integrate(eta, s, 10.001, front).area - integrate(eta, s, 10.0, front).area;
        const double expected = 0.001 * tendon.stiffness / more;
        EXPECT_NEAR(apparent_stiffness(tendon, s, front), expected, 1e-7 * expected) << eta << ", " << front;
      }
    }
  }
}

// The front is where old and new profile have the same tension: integrate both to it and compare.
TEST(SlipFront, IsWhereTheNewProfileMeetsTheOldOne) {
  const Tendon tendon{1.1414, 5.0664e4};
  struct Case {
    double before, s_before, after, s_after;
  };
  for (const Case& c : {Case{10.0, 0.0, 20.0, 1.0}, Case{20.0, 1.0, 5.0, -1.0}, Case{10.0, 0.0, 7.0, -1.0},
                        Case{6.0, -1.0, 11.0, 1.0}}) {
    const double front = slip_front(tendon, c.before, c.s_before, c.after, c.s_after);
    ASSERT_GT(front, 0.0);
    ASSERT_LT(front, 1.0);
    const double meeting = integrate(tendon.eta, c.s_before, c.before, front).end_tension;
    EXPECT_NEAR(integrate(tendon.eta, c.s_after, c.after, front).end_tension, meeting, kRelative * meeting);
  }
  EXPECT_EQ(slip_front(tendon, 10.0, 0.0, 100.0, 1.0), 1.0) << "pulled hard, all of it moves";
  EXPECT_EQ(slip_front(tendon, 10.0, 1.0, 20.0, 1.0), 1.0) << "more in the same direction: all of it moves";
}

// (5.33)-(5.38) from integrals: solve a Ttl + b Tbl = Lambda and Ttl - Tbl = tau / r1, and see where the joint stands.
auto joint_angle(double eta, double stiffness, double tau, double s, double lambda) -> double {
  const double a = integrate(eta, s, 1.0).area / stiffness;
  const double b = integrate(eta, -s, 1.0).area / stiffness;
  const double top = (lambda + b * tau / kR1) / (a + b);
  const double bottom = top - tau / kR1;
  return -(a * top - b * bottom) / (2.0 * kR2);
}

TEST(PretensionContrast, IsHalfTheDifferenceOfTheDirectionsAndNarrowsTheLoop) {
  for (const double eta : {0.03, 0.7, 1.1414}) {
    const Tendon tendon{eta, 5.0664e4};
    double previous_width = 1e9;
    for (const double lambda : {1e-4, 4e-4, 8e-4}) {
      const double expected = 0.5 * (joint_angle(eta, tendon.stiffness, 0.0, 1.0, lambda) -
                                     joint_angle(eta, tendon.stiffness, 0.0, -1.0, lambda));
      const double contrast = pretension_contrast(tendon, tendon, kR2, lambda);
      EXPECT_NEAR(contrast, expected, 1e-8 * expected);
      EXPECT_GT(contrast, 0.0);
      const double width =
          joint_angle(eta, tendon.stiffness, -0.1, -1.0, lambda) - joint_angle(eta, tendon.stiffness, 0.1, 1.0, lambda);
      EXPECT_LT(width, previous_width) << "Fig. 7.6: more pretension, narrower loop";
      previous_width = width;
    }
  }
}

// Table 2.1 gives the torque to four decimals, so Table 2.2 can be met to half of the last one.
TEST(ThesisTable22, FollowsFromTable21WithinTheRoundingOfThePrintedTorque) {
  struct Row {
    double torque_nm, eta, printed_n;
  };
  constexpr double kEtaTop = 1.1414;
  constexpr double kEtaBottom = 1.1404;
  constexpr std::array kRows = {Row{0.1227, kEtaTop, 28.1393}, Row{-0.1140, kEtaBottom, 26.1471},
                                Row{0.1299, kEtaTop, 29.7820}, Row{-0.1115, kEtaBottom, 25.5756},
                                Row{0.1258, kEtaTop, 28.8535}};
  for (const Row& row : kRows) {
    const double half_last_digit = row.printed_n * 0.00005 / std::fabs(row.torque_nm);
    EXPECT_NEAR(pretension_from_slack_torque(row.eta, row.torque_nm, kR1), row.printed_n, half_last_digit)
        << row.torque_nm;
  }
}

}  // namespace
}  // namespace capstan
