// SPDX-License-Identifier: Apache-2.0
// Formulas that the thesis prints otherwise than they must be. (2.21) is in pull_push_plant_test.cpp, (3.22) and (3.26)
// in stiffness_test.cpp.
#include <gtest/gtest.h>

#include <numbers>

#include "capstan/model/tension_profile.hpp"
#include "capstan/tests/model/integrated_tension.hpp"

namespace capstan {
namespace {

using test::integrate;

// (5.10) compares exp(-mu x / R) with the old tension and leaves out T_in: a number with a force. With T_in it is the
// front; without, the front would not depend on how hard the tendon is pulled.
TEST(Erratum510, FrontIsWhereInputTensionTimesDecayIsTheOldTension) {
  TensionProfile profile({1.1414, 5.0664e4}, 10.0);
  for (const double pull : {12.0, 18.0, 27.0}) {
    profile.pull_to(pull);
    EXPECT_NEAR(integrate(1.1414, 1.0, pull, profile.front()).end_tension, 10.0, 1e-8);
    EXPECT_LT(std::exp(-1.1414 * profile.front()), 1.0) << "never the 10 N that (5.10) asks for";
  }
}

// (5.26), (5.29) print e^+eta, and the other sign for the bottom tendon. By (5.24), (5.25) and compatibility whatever a
// pulled tendon stretches the joint lags, so both coefficients are negative, and both have e^-eta.
TEST(Erratum529, BothCoefficientsAreNegativeAndTheExponentIsToo) {
  constexpr double kR1 = 0.0026;
  constexpr double kR2 = 0.0024;
  constexpr double kStiffness = 5.0664e4;
  for (const double eta : {0.03, 0.7, 1.1414, 2.5}) {
    for (const double tau : {0.1, -0.1}) {  // the top tendon pulls, or the bottom one
      TensionProfile pulled({eta, kStiffness}, 0.0);
      pulled.pull_to(std::fabs(tau) / kR1);
      const double lag = (tau > 0.0 ? -1.0 : 1.0) * pulled.integral() / kStiffness / kR2;
      const double expected =
          -integrate(eta, 1.0, std::fabs(tau) / kR1).area / (kStiffness * kR2 * std::fabs(tau));  // rad/(N m)
      EXPECT_NEAR(lag / tau, expected, -1e-9 * expected) << eta;
      const double printed = (1.0 - std::exp(eta)) / (kR1 * kR2 * eta * kStiffness);
      EXPECT_LT(printed, 1.01 * expected) << "the printed exponent gives another number";
    }
  }
}

// (5.38) divides by Kn once more. nabla = Delta_t - Delta_b from integrals: a Ttl + b Tbl = Lambda, Ttl - Tbl = tau /
// r1.
TEST(Erratum538, NablaDoesNotDivideByTheStiffnessASecondTime) {
  constexpr double kR1 = 0.0026;
  constexpr double kStiffness = 5.0664e4;
  for (const double s : {1.0, -1.0}) {
    const double a = integrate(1.1414, s, 1.0).area / kStiffness;
    const double b = integrate(1.1414, -s, 1.0).area / kStiffness;
    const double lambda = 6e-4;
    const double tau = 0.03;
    const double top = (lambda + b * tau / kR1) / (a + b);
    const double nabla = a * top - b * (top - tau / kR1);
    const double mended = 2.0 * a * b / (kR1 * (a + b)) * tau + (a - b) / (a + b) * lambda;
    EXPECT_NEAR(mended, nabla, 1e-12 * std::fabs(nabla));
    EXPECT_LT(std::fabs(mended / kStiffness), 1e-4 * std::fabs(nabla)) << "as printed";
  }
}

/// Largest value of a sum of ten cosines over one period.
auto crest(double quadratic) -> double {
  constexpr int kTones = 10;
  double largest = 0.0;
  for (int i = 0; i < 20000; ++i) {
    double sum = 0.0;
    for (int k = 1; k <= kTones; ++k) {
      const double phase = 0.5 * std::numbers::pi + quadratic * std::numbers::pi * k * (k - 1) / kTones;
      sum += std::cos(2.0 * std::numbers::pi * k * i / 20000.0 + phase);
    }
    largest = std::fmax(largest, std::fabs(sum));
  }
  return largest;
}

// (5.31) prints phi_1 - -pi k (k - 1) / N. One minus is meant; with two the signal runs backward in time and its crest
// is the same, so nothing that was measured hangs on it.
TEST(Erratum531, EitherSignOfTheSchroederPhaseGivesTheSameLowCrest) {
  EXPECT_NEAR(crest(-1.0), crest(1.0), 1e-9);
  EXPECT_LT(crest(-1.0), 0.75 * crest(0.0));
}

}  // namespace
}  // namespace capstan
