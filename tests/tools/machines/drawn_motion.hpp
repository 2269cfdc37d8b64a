// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>

#include "capstan/tools/support/random.hpp"

namespace capstan::tools::machines {

inline constexpr double kTurn = 2.0 * std::numbers::pi;

/// Of the simulation, for each row of the log.
inline constexpr Eigen::Index kSteps = 10;

/// Numbers by chance.
class Draw {
 public:
  explicit Draw(std::uint64_t seed) : random_(seed) {}
  auto operator()(double low, double high) -> double { return low + (high - low) * random_.uniform(); }
  auto in_ratio(double low, double high) -> double { return low * std::pow(high / low, random_.uniform()); }
  template <std::size_t N>
  auto one_of(const std::array<double, N>& values) -> double {
    return values[static_cast<std::size_t>(random_.uniform() * static_cast<double>(N))];
  }
  auto normal(Eigen::Index count, double spread) -> Eigen::ArrayXd {
    return Eigen::ArrayXd::NullaryExpr(count, [&](Eigen::Index) { return spread * random_.normal(); });
  }

 private:
  Random random_;
};

/// Motor angle at every step, with speed and acceleration.
struct Motion {
  Motion(const Eigen::ArrayXd& angle, double step_s);
  Eigen::ArrayXd t, q, v, a;
  double amplitude = 0.0, top_speed = 0.0;
};

/// Motor angles from -1 to 1 at these times.
using MotionKind = Eigen::ArrayXd (*)(Draw&, const Eigen::ArrayXd& t);
/// Sines, triangles of several heights, a decaying sine, reaches with rests, a chirp.
extern const std::array<std::pair<const char*, MotionKind>, 5> kMotions;

/// A motion for a log of so long, or of the most rows that are drawn.
auto motion_of(Draw& draw, MotionKind kind, double seconds, double period_s, double amplitude) -> Motion;

}  // namespace capstan::tools::machines
