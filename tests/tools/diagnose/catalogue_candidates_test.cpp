// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "capstan/tools/diagnose/candidate.hpp"
#include "capstan/tools/diagnose/round.hpp"

namespace capstan::tools {
namespace {

/// A joint without any effect, along a course of its motor: 60 s at 100 Hz.
auto log_along(auto&& course) -> AxisLog {
  constexpr Eigen::Index kRows = 6000;
  AxisLog log;
  log.name = "made.csv";
  log.period_s = 0.01;
  log.time_s = Eigen::VectorXd::LinSpaced(kRows, 0.0, 0.01 * static_cast<double>(kRows - 1));
  log.q1_rad.resize(kRows);
  std::transform(log.time_s.begin(), log.time_s.end(), log.q1_rad.begin(), course);
  log.tau_nm = Eigen::VectorXd::Zero(kRows);
  log.q2_rad = 0.5 * log.q1_rad;
  return log;
}

/// Six places, 2 s at each, with moves of 0.2 s between them.
auto along_places(double t) -> double {
  constexpr double kPlaces[] = {-0.9, 0.4, 1.0, -0.2, 0.7, -0.6};
  const auto stay = static_cast<int>(t / 2.0);
  const double share = std::min(1.0, (t - 2.0 * stay) / 0.2);
  return kPlaces[(stay + 5) % 6] + share * (kPlaces[stay % 6] - kPlaces[(stay + 5) % 6]);
}

auto tries(const AxisLog& log, const std::string& name) -> bool {
  const LawForm law = form_of_model("kinematic", {log});
  const Preparation p = prepare({log}, law);
  const auto candidates = catalogue_candidates(p, law, residual_of(p, law));
  return std::any_of(candidates.begin(), candidates.end(), [&](const auto& c) { return c.name == name; });
}

TEST(CatalogueCandidates, PeriodsOfAnAngleAreNotAskedOfAFewPlaces) {
  EXPECT_FALSE(tries(log_along(along_places), "angle_periodic"));
  EXPECT_TRUE(tries(log_along(along_places), "play"));
  EXPECT_TRUE(tries(log_along([](double t) { return std::sin(0.6 * t); }), "angle_periodic"));
}

}  // namespace
}  // namespace capstan::tools
