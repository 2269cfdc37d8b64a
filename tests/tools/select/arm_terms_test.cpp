// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/select/arm_terms.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace capstan::tools {
namespace {

/// Where two joints are, and how fast they go.
struct State {
  double q = 0.0, v = 0.0, other_q = 0.0, other_v = 0.0;
};
using Energy = double (*)(const State&);

/// Two motions without a common period, by their own formulas.
auto state_at(double t) -> State {
  return {0.3 + 0.8 * std::sin(1.7 * t), 0.8 * 1.7 * std::cos(1.7 * t), -0.4 + 0.6 * std::cos(2.3 * t),
          -0.6 * 2.3 * std::sin(2.3 * t)};
}
auto samples_at(double t) -> std::pair<Sample<double>, Sample<double>> {
  const State s = state_at(t);
  Sample<double> own;
  own.q1 = s.q;
  own.dq1 = s.v;
  own.ddq1 = 1e-3 * -0.8 * 1.7 * 1.7 * std::sin(1.7 * t);
  Sample<double> other;
  other.q1 = s.other_q;
  other.dq1 = s.other_v;
  other.ddq1 = 1e-3 * -0.6 * 2.3 * 2.3 * std::cos(2.3 * t);
  return {own, other};
}

constexpr double kStep = 1e-4;

auto slope_in_speed(Energy energy, State s) -> double {
  s.v += kStep;
  const double above = energy(s);
  s.v -= 2.0 * kStep;
  return (above - energy(s)) / (2.0 * kStep);
}
auto slope_in_angle(Energy energy, State s) -> double {
  s.q += kStep;
  const double above = energy(s);
  s.q -= 2.0 * kStep;
  return (above - energy(s)) / (2.0 * kStep);
}

/// d/dt dT/dv - dT/dq by differences of the energy alone.
auto by_lagrange(Energy kinetic, double t) -> double {
  const double momentum_slope =
      (slope_in_speed(kinetic, state_at(t + kStep)) - slope_in_speed(kinetic, state_at(t - kStep))) / (2.0 * kStep);
  return momentum_slope - slope_in_angle(kinetic, state_at(t));
}

struct Expected {
  Energy energy;
  bool potential = false;
};

void expect_columns(const CatalogueTerm& term, const std::vector<Expected>& expected) {
  ASSERT_EQ(term.coefficients.size(), expected.size());
  for (const double t : {0.2, 0.9, 1.6, 2.7, 4.1}) {
    const auto [own, other] = samples_at(t);
    const Eigen::MatrixXd row = term.pair_columns({own}, {other});
    ASSERT_EQ(row.rows(), 1);
    ASSERT_EQ(row.cols(), std::ssize(expected));
    for (std::size_t i = 0; i < expected.size(); ++i) {
      const double effort =
          expected[i].potential ? slope_in_angle(expected[i].energy, state_at(t)) : by_lagrange(expected[i].energy, t);
      EXPECT_NEAR(row(0, static_cast<Eigen::Index>(i)), effort, 1e-5) << term.coefficients[i].name << " at " << t;
    }
  }
}

TEST(ArmTerms, PostureIsLagrangesEquationOfTheEnergyThatTwoTurningJointsShare) {
  expect_columns(posture_coupling(false),
                 {{[](const State& s) { return 0.5 * std::cos(s.other_q) * s.v * s.v; }},
                  {[](const State& s) { return 0.5 * std::sin(s.other_q) * s.v * s.v; }},
                  {[](const State& s) { return 0.5 * std::cos(2.0 * s.other_q) * s.v * s.v; }},
                  {[](const State& s) { return 0.5 * std::sin(2.0 * s.other_q) * s.v * s.v; }},
                  {[](const State& s) { return std::cos(s.other_q) * s.v * s.other_v; }},
                  {[](const State& s) { return std::sin(s.other_q) * s.v * s.other_v; }},
                  {[](const State& s) { return std::cos(s.q) * s.v * s.other_v; }},
                  {[](const State& s) { return std::sin(s.q) * s.v * s.other_v; }},
                  {[](const State& s) { return 0.5 * std::cos(s.q) * s.other_v * s.other_v; }},
                  {[](const State& s) { return 0.5 * std::sin(s.q) * s.other_v * s.other_v; }},
                  {[](const State& s) { return 0.5 * std::cos(2.0 * s.q) * s.other_v * s.other_v; }},
                  {[](const State& s) { return 0.5 * std::sin(2.0 * s.q) * s.other_v * s.other_v; }},
                  {[](const State& s) { return std::sin(s.q + s.other_q); }, true},
                  {[](const State& s) { return -std::cos(s.q + s.other_q); }, true},
                  {[](const State& s) { return std::sin(s.q - s.other_q); }, true},
                  {[](const State& s) { return -std::cos(s.q - s.other_q); }, true}});
}

TEST(ArmTerms, PostureOfASlideIsThatOfACartThatCarriesALink) {
  expect_columns(posture_coupling(true), {{[](const State& s) { return std::cos(s.other_q) * s.v * s.other_v; }},
                                          {[](const State& s) { return std::sin(s.other_q) * s.v * s.other_v; }},
                                          {[](const State& s) { return s.q * s.v * s.other_v; }},
                                          {[](const State& s) { return 0.5 * s.q * s.other_v * s.other_v; }},
                                          {[](const State& s) { return 0.5 * s.q * s.q * s.other_v * s.other_v; }},
                                          {[](const State& s) { return s.q * std::cos(s.other_q); }, true},
                                          {[](const State& s) { return s.q * std::sin(s.other_q); }, true}});
}

TEST(ArmTerms, ReachIsThatOfALinkFromWhichAnotherSlidesOut) {
  expect_columns(reach_coupling(), {{[](const State& s) { return 0.5 * s.other_q * s.v * s.v; }},
                                    {[](const State& s) { return 0.5 * s.other_q * s.other_q * s.v * s.v; }},
                                    {[](const State& s) { return s.other_q * s.v * s.other_v; }},
                                    {[](const State& s) { return std::cos(s.q) * s.v * s.other_v; }},
                                    {[](const State& s) { return std::sin(s.q) * s.v * s.other_v; }},
                                    {[](const State& s) { return s.other_q * std::sin(s.q); }, true},
                                    {[](const State& s) { return -s.other_q * std::cos(s.q); }, true}});
}

TEST(ArmTerms, EveryNumberIsInOnePart) {
  const auto verify = [](const CatalogueTerm& term, const std::vector<std::vector<std::size_t>>& parts) {
    std::vector<std::size_t> all;
    for (const auto& part : parts) {
      all.insert(all.end(), part.begin(), part.end());
    }
    ASSERT_EQ(all.size(), term.coefficients.size());
    for (std::size_t i = 0; i < all.size(); ++i) {
      EXPECT_EQ(all[i], i);
    }
  };
  verify(posture_coupling(false), posture_parts(false));
  verify(posture_coupling(true), posture_parts(true));
  verify(reach_coupling(), reach_parts());
}

}  // namespace
}  // namespace capstan::tools
