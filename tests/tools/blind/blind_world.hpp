// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <cmath>
#include <random>

#include "capstan/tests/tools/blind/blind_joint.hpp"

namespace capstan::tools::blind {

using Signal = Eigen::ArrayXd;
inline constexpr double kStep = 0.001;  // s, of the made-up world

/// Numbers of one joint, all from its seed.
class Draw {
 public:
  explicit Draw(std::uint64_t seed) : random_(seed * 0x9E3779B97F4A7C15ULL + 12345) {}
  auto between(double low, double high) -> double { return std::uniform_real_distribution<double>(low, high)(random_); }
  auto ratio_between(double low, double high) -> double { return low * std::pow(high / low, between(0.0, 1.0)); }
  auto one_of(int count) -> int { return std::uniform_int_distribution<int>(0, count - 1)(random_); }
  auto normal() -> double { return normal_(random_); }

 private:
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_{0.0, 1.0};
};

/// Everything that happens in the world, step by step.
struct World {
  Signal time, q, speed, acceleration, tau, joint;
  Signal other_q, other_tau;
  Signal sign;         // direction of the motor, 1 or -1, kept at rest
  Signal tau_turned;   // torque at the last reversal
  Signal temperature;  // degrees Celsius
  double beta = 1.0, offset = 0.0;
  double elongation_top = 0.0, elongation_bottom = 0.0;  // rad/Nm
  double tau_span = 1.0, q_span = 1.0, duration = 1.0;
};

/// A world by a case's motion, without any effect beyond ratio, offset and elongation.
auto world_of(const Case& c, Draw& draw) -> World;

/// The same world to somebody who knows the motor's direction no sooner than an encoder of this step, rad, can tell:
/// one count back.
auto as_seen(World world, double step) -> World;

/// What is left of an effect when ratio, offset and both elongations have taken what they can.
auto outside_base(const World& w, const Signal& effect) -> Signal;

/// `top` where the motor goes forward, `bottom` elsewhere.
auto by_direction(const World& w, double top, double bottom) -> Signal;
auto low_passed(const Signal& input, double time_s) -> Signal;
/// Dahl's bristle over a path, in rad.
auto bristle(const Signal& path, double width) -> Signal;

}  // namespace capstan::tools::blind
