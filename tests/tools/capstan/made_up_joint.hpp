// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <numbers>
#include <random>
#include <string>
#include <vector>

namespace capstan::tools::test {

/// What a log of one joint beside two others shows. The joint stretches by 0.15 and 0.10 rad/Nm.
struct MadeUpJoint {
  std::uint32_t seed = 1;  ///< of motions and noise: another log of the same joint
  bool axis1_moves = true, axis2_moves = true;
  double of_axis1 = 0.0, of_axis2 = 0.0;  ///< what their motion pulls this joint by
  double ratio = 0.9, zero_rad = 0.1, play_rad = 0.0;
  double rest_s = 0.0;  ///< before the motion
  double friction_nm = 0.02;
  bool others_torque = false;  ///< is logged, and pulls by 0.25 rad/Nm of what its axis's angle does
};

/// What the torque of a motor is made of: inertia, drag, dry friction, and another axis's acceleration.
struct MadeUpEffort {
  std::uint32_t seed = 1;
  bool axis1_moves = true;
  double of_axis1_kgm2 = 0.004;
};

inline constexpr double kMadeUpRateHz = 100.0;
inline constexpr double kMadeUpS = 40.0;

/// A sum of three sines, with its derivatives.
class MadeUpMotion {
 public:
  MadeUpMotion(std::uint32_t seed, std::array<double, 3> hz, double size_rad) : hz_(hz), size_(size_rad) {
    std::mt19937 random(seed);
    for (auto& phase : phases_) {
      phase = 1e-3 * static_cast<double>(random() % 6283);
    }
  }
  [[nodiscard]] auto derivative(double t, int order) const -> double {
    constexpr std::array kShares = {0.5, 0.3, 0.2};
    double sum = 0.0;
    for (std::size_t i = 0; i < kShares.size(); ++i) {
      const double w = 2.0 * std::numbers::pi * hz_[i];
      sum += kShares[i] * std::pow(w, order) * std::sin(w * t + phases_[i] + 0.5 * std::numbers::pi * order);
    }
    return size_ * sum;
  }

 private:
  std::array<double, 3> hz_, phases_{};
  double size_;
};

/// Columns of a log by the contract; those named in `without` are left out.
class MadeUpLog {
 public:
  MadeUpLog(std::vector<std::string> names, std::vector<std::string> without)
      : names_(std::move(names)), without_(std::move(without)) {
    add(names_);
  }
  void row(const std::vector<double>& values) {
    std::vector<std::string> cells;
    for (const double value : values) {
      char text[32];
      std::snprintf(text, sizeof(text), "%.9f", value);
      cells.emplace_back(text);
    }
    add(cells);
  }
  [[nodiscard]] auto text() const -> const std::string& { return text_; }

 private:
  void add(const std::vector<std::string>& cells) {
    std::string line;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      if (std::find(without_.begin(), without_.end(), names_[i]) == without_.end()) {
        line += (line.empty() ? "" : ",") + cells[i];
      }
    }
    text_ += line + "\n";
  }

  std::vector<std::string> names_, without_;
  std::string text_;
};

inline auto joint_log(const MadeUpJoint& joint, const std::vector<std::string>& without = {}) -> std::string {
  const MadeUpMotion motor(joint.seed, {0.1, 0.27, 0.61}, 0.6);
  const MadeUpMotion first(joint.seed + 100, {0.13, 0.31, 0.5}, joint.axis1_moves ? 0.6 : 0.0);
  const MadeUpMotion second(joint.seed + 200, {0.09, 0.22, 0.44}, joint.axis2_moves ? 0.6 : 0.0);
  std::mt19937 random(joint.seed);
  std::normal_distribution<double> noise(0.0, 5e-4);
  std::vector<std::string> left_out = without;
  if (!joint.others_torque) {
    left_out.insert(left_out.end(), {"axis1/tau_Nm", "axis2/tau_Nm"});
  }
  MadeUpLog log({"time_s", "axis0/q1_rad", "axis0/q2_rad", "axis0/tau_Nm", "axis1/q1_rad", "axis2/q1_rad",
                 "axis1/tau_Nm", "axis2/tau_Nm"},
                left_out);
  const auto torque_of = [&joint](const MadeUpMotion& other, double t) {
    const double speed = other.derivative(t, 1);
    return joint.others_torque ? 0.02 * std::tanh(speed / 0.01) + 0.002 * speed + 0.004 * other.derivative(t, 0) : 0.0;
  };
  double behind_play = motor.derivative(0.0, 0);
  for (int i = 0; i < static_cast<int>((joint.rest_s + kMadeUpS) * kMadeUpRateHz); ++i) {
    const double time = i / kMadeUpRateHz;
    const double t = std::max(0.0, time - joint.rest_s);
    const double speed = time < joint.rest_s ? 0.0 : motor.derivative(t, 1);
    const double q = motor.derivative(t, 0);
    behind_play = std::min(std::max(behind_play, q - joint.play_rad), q + joint.play_rad);
    const double tau = joint.friction_nm * std::tanh(speed / 0.01) + 0.1 * joint.friction_nm * speed;
    const double q2 = joint.ratio * behind_play + joint.zero_rad + (speed >= 0.0 ? -0.15 : -0.10) * tau +
                      joint.of_axis1 * (first.derivative(t, 0) + 0.25 * torque_of(first, t)) +
                      joint.of_axis2 * (second.derivative(t, 0) + 0.25 * torque_of(second, t));
    log.row({time, q, q2 + noise(random), tau, first.derivative(t, 0), second.derivative(t, 0), torque_of(first, t),
             torque_of(second, t)});
  }
  return log.text();
}

inline auto effort_log(const MadeUpEffort& effort) -> std::string {
  const MadeUpMotion motor(effort.seed, {0.15, 0.4, 0.9}, 0.8);
  const MadeUpMotion first(effort.seed + 100, {0.11, 0.35, 0.8}, effort.axis1_moves ? 0.8 : 0.0);
  std::mt19937 random(effort.seed);
  std::normal_distribution<double> noise(0.0, 1e-3);
  MadeUpLog log({"time_s", "axis0/q1_rad", "axis0/tau_Nm", "axis1/q1_rad"}, {});
  for (int i = 0; i < static_cast<int>(kMadeUpS * kMadeUpRateHz); ++i) {
    const double t = i / kMadeUpRateHz;
    const double speed = motor.derivative(t, 1);
    const double tau = 0.004 * motor.derivative(t, 2) + 0.01 * speed + 0.05 * std::tanh(speed / 0.02) +
                       effort.of_axis1_kgm2 * first.derivative(t, 2);
    log.row({t, motor.derivative(t, 0), tau + noise(random), first.derivative(t, 0)});
  }
  return log.text();
}

}  // namespace capstan::tools::test
