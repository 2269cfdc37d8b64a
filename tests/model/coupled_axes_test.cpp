// SPDX-License-Identifier: Apache-2.0
#include "capstan/model/coupled_axes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "capstan/tests/model/any_coupling.hpp"
#include "capstan/tests/model/support.hpp"

namespace capstan {
namespace {

using test::any_matrices;
using test::number;
using test::value_of;

/// Table 6.1 and the identified coefficients of chapter 6.
template <typename Scalar>
auto thesis_wrist() -> WristTransmission<Scalar> {
  const auto n = [](double x) { return number<Scalar>(x); };
  return {n(0.996),
          n(1.109),
          n(1.138),
          n(0.674),
          n(0.664),
          {n(-0.424), n(-2.828)},
          {n(-1.907), n(-1.054)},
          {n(-1.047), n(-0.541)}};
}

TEST(WristCoupling, IsEquations614To616) {
  const auto m = coupling_of(thesis_wrist<double>());
  EXPECT_EQ(m.rigid[0], (std::array{0.996, 0.0, 0.0}));
  EXPECT_EQ(m.rigid[1], (std::array{0.674 * 0.996, 1.109, 0.0}));
  EXPECT_EQ(m.rigid[2], (std::array{0.664 * 0.996, 0.0, 1.138}));
  EXPECT_EQ(m.elongation_top[1], (std::array{0.674 * -0.424, -1.907, 0.0}));
  EXPECT_EQ(m.elongation_bottom[2], (std::array{0.664 * -2.828, 0.0, -0.541}));
}

// Between the output angles there is no hysteresis (figure 6.5): whatever the pitch's torque and direction, a jaw whose
// own motor stands still follows the pitch by K.
TEST(WristCoupling, JawFollowsThePitchWithoutAnyHysteresisBetweenTheAngles) {
  const CoupledAxes<double, 3> wrist(coupling_of(thesis_wrist<double>()));
  for (const bool forward : {true, false}) {
    for (const double tau : {-0.1, 0.0, 0.07}) {
      const auto theta = wrist.joints({0.3, 0.0, 0.0}, {tau, 0.0, 0.0}, {forward, true, true});
      EXPECT_NEAR(theta[1], 0.674 * theta[0], 1e-15);
      EXPECT_NEAR(theta[2], 0.664 * theta[0], 1e-15);
    }
  }
}

/// The product of (6.8) with S written out, 2n x n.
auto by_switching_matrix(const CouplingMatrices<double, 3>& m, const std::array<double, 3>& q,
                         const std::array<double, 3>& tau, const std::array<bool, 3>& forward)
    -> std::array<double, 3> {
  std::array<std::array<double, 6>, 3> a{};
  std::array<std::array<double, 3>, 6> s{};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      a[i][2 * j] = m.elongation_top[i][j];
      a[i][2 * j + 1] = m.elongation_bottom[i][j];
    }
    s[2 * i][i] = forward[i] ? 1.0 : 0.0;
    s[2 * i + 1][i] = 1.0 - s[2 * i][i];
  }
  std::array<double, 3> theta = m.offset;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      theta[i] += m.rigid[i][j] * q[j];
      for (std::size_t k = 0; k < 6; ++k) {
        theta[i] += a[i][k] * s[k][j] * tau[j];
      }
    }
  }
  return theta;
}

TEST(CoupledAxes, AreEquation68AndTheirInverseGoesBack) {
  std::mt19937 engine(61);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (int round = 0; round < 500; ++round) {
    const auto m = any_matrices<double>(engine);
    const CoupledAxes<double, 3> axes(m);
    ASSERT_TRUE(axes.is_usable());
    const std::array q = {3.0 * unit(engine), 3.0 * unit(engine), 3.0 * unit(engine)};
    const std::array tau = {unit(engine), unit(engine), unit(engine)};
    const std::array forward = {unit(engine) > 0.0, unit(engine) > 0.0, unit(engine) > 0.0};
    const auto theta = axes.joints(q, tau, forward);
    const auto expected = by_switching_matrix(m, q, tau, forward);
    const auto back = axes.motors(theta, tau, forward);
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_NEAR(theta[i], expected[i], 1e-12);
      EXPECT_NEAR(back[i], q[i], 1e-12);
    }
  }
}

TEST(CoupledAxes, SingularOrMissingMatricesAreNotUsable) {
  auto m = coupling_of(thesis_wrist<double>());
  m.rigid[2] = m.rigid[1];
  const CoupledAxes<double, 3> singular(m);
  EXPECT_FALSE(singular.is_usable());
  EXPECT_EQ(singular.motors({1.0, 1.0, 1.0}, {}, {}), (std::array{0.0, 0.0, 0.0}));
  m = coupling_of(thesis_wrist<double>());
  m.elongation_bottom[1][2] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE((CoupledAxes<double, 3>(m).is_usable()));
}

}  // namespace
}  // namespace capstan
