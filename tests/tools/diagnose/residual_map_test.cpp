// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/diagnose/residual_map.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace capstan::tools {
namespace {

constexpr Eigen::Index kRows = 8000;
constexpr double kPeriodS = 0.01;

/// Two sines without a common period, and a load of its own.
auto motion() -> MapSignals {
  MapSignals s{Eigen::VectorXd(kRows), Eigen::VectorXd(kRows), Eigen::VectorXd(kRows)};
  for (Eigen::Index i = 0; i < kRows; ++i) {
    const double t = kPeriodS * static_cast<double>(i);
    s.time_s[i] = t;
    s.q1[i] = 0.8 * std::sin(2.1 * t) + 0.3 * std::sin(3.37 * t);
    s.load[i] = std::sin(1.13 * t + 0.7);
  }
  return s;
}

/// Noise with a memory of half a second: neighbouring rows say the same.
auto noise(std::uint64_t seed) -> Eigen::VectorXd {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  Eigen::VectorXd x(kRows);
  double state = normal(random);
  for (double& value : x) {
    state = 0.98 * state + std::sqrt(1.0 - 0.98 * 0.98) * normal(random);
    value = state;
  }
  return x;
}

auto found_in(const ResidualMap& map, const std::string& signal) -> std::vector<MapCell> {
  std::vector<MapCell> found;
  std::copy_if(map.cells.begin(), map.cells.end(), std::back_inserter(found),
               [&](const auto& cell) { return cell.found && cell.signal == signal; });
  return found;
}

TEST(ResidualMap, OfNoiseWithMemoryFindsSomethingInOneLogOfTwentyAtMost) {
  const MapSignals s = motion();
  int found = 0;
  constexpr int kLogs = 100;
  for (int seed = 0; seed < kLogs; ++seed) {
    const ResidualMap map = residual_map(s, noise(static_cast<std::uint64_t>(seed) + 1));
    found += std::any_of(map.cells.begin(), map.cells.end(), [](const auto& cell) { return cell.found; }) ? 1 : 0;
  }
  EXPECT_LE(found, kLogs / 20);
}

TEST(ResidualMap, ACellThatWasVisitedSeldomHasItsMeanAndIsNotFound) {
  MapSignals s = motion();
  s.q1 = (0.157 * s.time_s.array()).sin().matrix();  // two cycles
  const ResidualMap map = residual_map(s, Eigen::VectorXd::Constant(kRows, 0.3));
  int seldom = 0;
  for (const auto& cell : map.cells) {
    EXPECT_NEAR(cell.mean, 0.3, 1e-12) << cell.signal;
    if (cell.signal == "angle" && cell.visits < 4) {
      ++seldom;
      EXPECT_FALSE(cell.found);
      EXPECT_EQ(cell.p_value, 1.0);
    }
  }
  EXPECT_GT(seldom, 0);
}

TEST(ResidualMap, FindsASpotOfOneDirectionWhereItIs) {
  const MapSignals s = motion();
  Eigen::VectorXd residual = 0.1 * noise(7);
  for (Eigen::Index i = 1; i < kRows; ++i) {
    residual[i] += s.q1[i] > 0.5 && s.q1[i] < 0.7 && s.q1[i] > s.q1[i - 1] ? 0.5 : 0.0;
  }
  const auto found = found_in(residual_map(s, residual), "angle");
  ASSERT_FALSE(found.empty());
  for (const auto& cell : found) {
    EXPECT_TRUE(cell.forward);
    EXPECT_GT(cell.to, 0.45);
    EXPECT_LT(cell.from, 0.75);
    EXPECT_GT(cell.mean, 0.1);
  }
}

TEST(ResidualMap, FindsWhatFadesAfterEachReversal) {
  const MapSignals s = motion();
  Eigen::VectorXd residual = 0.1 * noise(8);
  double turned = 0.0;
  double sign = 1.0;
  for (Eigen::Index i = 2; i < kRows; ++i) {
    const double now = s.q1[i] > s.q1[i - 1] ? 1.0 : -1.0;
    turned = now != sign ? s.time_s[i] : turned;
    sign = now;
    residual[i] += 0.5 * sign * std::exp(-(s.time_s[i] - turned) / 0.1);
  }
  const auto found = found_in(residual_map(s, residual), "time_since_reversal");
  const auto soon = [](bool forward) {
    return [forward](const auto& cell) {
      return cell.forward == forward && cell.from < 0.1 && (cell.mean > 0.1) == forward;
    };
  };
  EXPECT_TRUE(std::any_of(found.begin(), found.end(), soon(true)));
  EXPECT_TRUE(std::any_of(found.begin(), found.end(), soon(false)));
}

TEST(ResidualMap, FindsTheLoadOnlyWhereItIsLogged) {
  MapSignals s = motion();
  const Eigen::VectorXd residual = 0.1 * noise(9) + 0.2 * s.load.cwiseProduct(s.load);
  EXPECT_FALSE(found_in(residual_map(s, residual), "load").empty());
  s.load.resize(0);
  const ResidualMap map = residual_map(s, residual);
  EXPECT_TRUE(std::none_of(map.cells.begin(), map.cells.end(), [](const auto& cell) { return cell.signal == "load"; }));
}

TEST(ResidualMap, DependsOnNoUnit) {
  MapSignals s = motion();
  Eigen::VectorXd residual = 0.1 * noise(10) + 0.2 * s.q1.cwiseAbs2();
  const ResidualMap plain = residual_map(s, residual);
  constexpr double kUnit = 1024.0;  // a power of two: what ties before ties after
  s.q1 *= kUnit;
  s.time_s /= kUnit;
  s.load /= kUnit;
  residual *= kUnit;
  const ResidualMap scaled = residual_map(s, residual);
  ASSERT_EQ(scaled.cells.size(), plain.cells.size());
  for (std::size_t i = 0; i < plain.cells.size(); ++i) {
    EXPECT_EQ(scaled.cells[i].found, plain.cells[i].found);
    EXPECT_DOUBLE_EQ(scaled.cells[i].mean, kUnit * plain.cells[i].mean);
  }
}

TEST(ResidualMap, OfNothingHasNoCells) {
  EXPECT_TRUE(residual_map({}, {}).cells.empty());
}

}  // namespace
}  // namespace capstan::tools
