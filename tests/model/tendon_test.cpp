// SPDX-License-Identifier: Apache-2.0
#include "capstan/model/tendon.hpp"

#include <gtest/gtest.h>

#include <array>

#include "capstan/tests/model/integrated_tension.hpp"

namespace capstan {
namespace {

using test::integrate;

constexpr std::array kEtas = {1e-6, 0.03, 0.7, 1.1414, 2.5};
constexpr double kR1 = 0.0026;

TEST(ApparentStiffness, WithoutFrictionIsThatOfASpring) {
  EXPECT_EQ(apparent_stiffness({0.0, 2000.0}, -1.0), 2000.0);
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
