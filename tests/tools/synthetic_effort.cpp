// SPDX-License-Identifier: Apache-2.0
#include "capstan/tests/tools/synthetic_effort.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

namespace capstan::tools::test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kFine = 10;  // steps of the made-up world per sample

struct Motion {
  double angle = 0.0, speed = 0.0, acceleration = 0.0;
};

/// Sines with a common cycle: reversals at many places, speeds over a decade.
class Drive {
 public:
  explicit Drive(const EffortRequest& request) : base_(2.0 * kPi / request.cycle_s) {
    std::mt19937_64 random(request.seed * 6151 + 11);
    std::uniform_real_distribution<double> phase(0.0, 2.0 * kPi);
    for (double& value : phases_) {
      value = phase(random);
    }
  }
  [[nodiscard]] auto at(double time) const -> Motion {
    Motion sum;
    for (std::size_t i = 0; i < kHarmonics.size(); ++i) {
      const double w = base_ * kHarmonics[i];
      const double angle = w * time + phases_[i];
      sum.angle += kAmplitudes[i] * std::sin(angle);
      sum.speed += kAmplitudes[i] * w * std::cos(angle);
      sum.acceleration -= kAmplitudes[i] * w * w * std::sin(angle);
    }
    return sum;
  }

 private:
  static constexpr std::array<double, 6> kHarmonics = {1, 2, 5, 11, 19, 37};
  static constexpr std::array<double, 6> kAmplitudes = {1.3, 0.7, 0.35, 0.2, 0.12, 0.02};
  double base_;
  std::array<double, 6> phases_{};
};

/// The axis itself, stepped finely; every state has its own equation.
class Axis {
 public:
  explicit Axis(const EffortRequest& request) : r_(request) {}

  auto step(double time, double dt, const Motion& m) -> double {
    const double travel = started_ ? m.angle - last_ : 0.0;
    last_ = m.angle;
    if (!started_) {
      follower_ = m.angle;
    }
    started_ = true;
    // A block dragged along by a spring that slips at one unit of force, and reaches it after kWay; the spring has a
    // slack of half of that.
    spring_ = std::clamp(spring_ + travel / kWay, -1.0, 1.0);
    bristle_ += (travel - std::abs(travel) * bristle_) / kBristle;
    follower_ += (m.angle - follower_) * dt / 0.8;
    return 0.03 * m.acceleration + 0.05 * m.speed + r_.strength * effect(time, m);
  }

 private:
  static constexpr double kWay = 0.06;
  static constexpr double kBristle = 0.04;

  [[nodiscard]] auto effect(double time, const Motion& m) const -> double {
    const double side = m.speed > 0.0 ? 1.0 : -1.0;
    switch (r_.truth) {
      case EffortTruth::kNone:
      case EffortTruth::kDelay:
        return 0.0;
      case EffortTruth::kCoulomb:
        return 0.05 * side;
      case EffortTruth::kAsymmetry:
        return 0.05 * side + (side > 0.0 ? 0.02 + 0.03 * m.speed : 0.0);
      case EffortTruth::kStribeck:
        return side * (0.05 + 0.05 * std::exp(-std::pow(m.speed / 0.25, 2)));
      case EffortTruth::kSlack:
        return 0.05 * std::copysign(std::max(0.0, std::abs(spring_) - 0.5) / 0.5, spring_);
      case EffortTruth::kBristle:
        return 0.05 * bristle_;
      case EffortTruth::kOffset:
        return 0.03;
      case EffortTruth::kGravity:
        return 0.04 * std::sin(m.angle) - 0.02 * std::cos(m.angle);
      case EffortTruth::kRipple:
        return 0.02 * std::sin(9.0 * m.angle + 0.7);
      case EffortTruth::kWarmUp:
        return -0.05 * std::exp(-time / 24.0);
      case EffortTruth::kQuadraticDrag:
        return 0.03 * m.speed * std::abs(m.speed);
      case EffortTruth::kHardSpring:
        return 0.006 * std::pow(m.angle, 3);
      case EffortTruth::kStickySpot:
        return 0.08 * side * std::exp(-std::pow((m.angle - 0.5) / 0.25, 2));
      case EffortTruth::kRelaxation:
        return 0.04 * (m.angle - follower_);
    }
    return 0.0;
  }

  EffortRequest r_;
  bool started_ = false;
  double last_ = 0.0, spring_ = 0.0, bristle_ = 0.0, follower_ = 0.0;
};

/// Adds noise to the effort, half white and half coloured, and the steps of the encoder.
void spoil(const EffortRequest& r, AxisLog& log) {
  std::mt19937_64 random(r.seed + 77);
  std::normal_distribution<double> normal(0.0, 1.0);
  const double keep = std::exp(-1.0 / (0.1 * r.rate_hz));
  const double step = 2.0 * kPi / 1.0e6;
  double coloured = normal(random);
  for (Eigen::Index i = 0; i < log.samples(); ++i) {
    coloured = keep * coloured + std::sqrt(1.0 - keep * keep) * normal(random);
    log.effort[i] += r.noise_nm * std::sqrt(0.5) * (coloured + normal(random));
    log.q1_rad[i] = std::floor(log.q1_rad[i] / step) * step;
  }
}

}  // namespace

auto truth_name(EffortTruth truth) -> std::string {
  constexpr std::array<const char*, 15> kNames = {
      "none",   "coulomb", "asymmetry", "stribeck",       "slack",       "bristle",     "offset",    "gravity",
      "ripple", "delay",   "warm_up",   "quadratic_drag", "hard_spring", "sticky_spot", "relaxation"};
  return kNames[static_cast<std::size_t>(truth)];
}

auto synthetic_effort_log(const EffortRequest& r) -> AxisLog {
  AxisLog log;
  log.name = "synthetic_effort_" + truth_name(r.truth);
  log.target = "axis0/tau_Nm";
  log.period_s = 1.0 / r.rate_hz;
  const auto rows = static_cast<Eigen::Index>(r.cycle_s * r.cycles * r.rate_hz);
  for (Eigen::VectorXd* signal : {&log.time_s, &log.q1_rad, &log.tau_nm, &log.effort}) {
    *signal = Eigen::VectorXd::Zero(rows);
  }
  const Drive drive(r);
  Axis axis(r);
  const double dt = log.period_s / kFine;
  const double late_s = r.truth == EffortTruth::kDelay ? 0.014 * r.strength : 0.0;
  const auto late = static_cast<std::size_t>(std::lround(late_s / dt));
  std::vector<double> past;  // efforts, one per fine step
  for (Eigen::Index i = 0; i < rows; ++i) {
    for (int k = 0; k < kFine; ++k) {
      const double time = static_cast<double>(i) * log.period_s + (k + 1 - kFine) * dt;
      past.push_back(axis.step(time, dt, drive.at(time)));
    }
    log.time_s[i] = static_cast<double>(i) * log.period_s;
    log.q1_rad[i] = drive.at(log.time_s[i]).angle;
    log.effort[i] = past[past.size() - 1 - std::min(late, past.size() - 1)];
  }
  spoil(r, log);
  return log;
}

}  // namespace capstan::tools::test
