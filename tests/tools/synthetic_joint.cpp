// SPDX-License-Identifier: Apache-2.0
#include "capstan/tests/tools/synthetic_joint.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>

namespace capstan::tools::test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kFine = 8;  // steps of the made-up world per sample

/// Position and speed of the motor at a time.
struct Moving {
  double angle = 0.0;
  double speed = 0.0;
};

auto sine(double time, double amplitude, double hertz, double phase) -> Moving {
  const double w = 2.0 * kPi * hertz;
  return {amplitude * std::sin(w * time + phase), amplitude * w * std::cos(w * time + phase)};
}

auto multisine(double time, double cycle_s, std::mt19937_64& random) -> Moving {
  Moving sum;
  std::uniform_real_distribution<double> phase(0.0, 2.0 * kPi);
  for (const int harmonic : {2, 3, 5, 8, 13, 21, 34}) {
    const Moving one = sine(time, 0.9 / std::sqrt(harmonic), harmonic / cycle_s, phase(random));
    sum.angle += one.angle;
    sum.speed += one.speed;
  }
  return sum;
}

/// Swings of several sizes and speeds about several centres, with short holds: nested loops.
auto ladder(double time, double cycle_s) -> Moving {
  constexpr std::array<std::array<double, 3>, 10> kSwings = {{{0.0, 1.2, 1.0},
                                                              {1.2, -1.2, 2.0},
                                                              {-1.2, 0.6, 0.8},
                                                              {0.6, -0.2, 0.5},
                                                              {-0.2, 1.0, 1.5},
                                                              {1.0, -0.6, 0.6},
                                                              {-0.6, 0.1, 0.4},
                                                              {0.1, -0.9, 1.2},
                                                              {-0.9, 0.4, 0.7},
                                                              {0.4, 0.0, 0.5}}};
  double total = 0.0;
  for (const auto& swing : kSwings) {
    total += swing[2] * 1.15;
  }
  double left = std::fmod(time, cycle_s) / cycle_s * total;
  for (const auto& [from, to, length] : kSwings) {
    if (left < length) {
      const double s = left / length;
      const double rate = total / cycle_s / length;
      return {from + (to - from) * 0.5 * (1.0 - std::cos(kPi * s)), (to - from) * 0.5 * kPi * std::sin(kPi * s) * rate};
    }
    left -= length * 1.15;
    if (left < 0.0) {
      return {to, 0.0};
    }
  }
  return {};
}

auto motor_at(const SyntheticRequest& r, double time) -> Moving {
  std::mt19937_64 phases(r.seed * 7919 + 17);
  switch (r.motion) {
    case Motion::kMultisine:
      return multisine(time, r.cycle_s, phases);
    case Motion::kLadder:
      return ladder(time, r.cycle_s);
    case Motion::kSine:
      break;
  }
  return sine(time, 1.0, 8.0 / r.cycle_s, 0.3);
}

/// The joint itself, stepped finely; every state has its own equation.
class Joint {
 public:
  explicit Joint(const SyntheticRequest& request) : r_(request) {}

  void step(double time, double dt, const Moving& motor) {
    const double moved = motor.angle - last_angle_;
    last_angle_ = started_ ? motor.angle : motor.angle;
    if (!started_) {
      play_ = motor.angle;
    }
    const double travel = started_ ? moved : 0.0;
    started_ = true;
    if (std::abs(motor.speed) > 1e-9) {
      top_ = motor.speed > 0.0;
    }
    // Friction that has to be wound up, on top of a spring, a drag and a load that comes and goes.
    friction_ += travel / 0.01 - friction_ * std::abs(travel) / 0.01;
    const double load = 0.02 * std::sin(2.0 * kPi * 3.0 * time / r_.cycle_s + 0.4) +
                        0.015 * std::sin(2.0 * kPi * 7.0 * time / r_.cycle_s);
    torque_ = 0.035 * motor.angle + 0.025 * friction_ + 0.004 * motor.speed + load;
    play_ = std::clamp(play_, motor.angle - width(), motor.angle + width());
    creep_ += (torque_ - creep_) * dt / 2.0;
    bristle_ += travel - bristle_ * std::abs(travel) / 0.08;
    angle_ = rigid_part(motor) + effect(time, motor);
  }

  [[nodiscard]] auto torque() const -> double { return torque_; }
  [[nodiscard]] auto angle() const -> double { return angle_; }

 private:
  [[nodiscard]] auto width() const -> double { return 0.008 * r_.strength; }

  [[nodiscard]] auto rigid_part(const Moving& motor) const -> double {
    return 1.08 * motor.angle + 0.03 + (top_ ? -0.9 : -0.6) * torque_;
  }

  [[nodiscard]] auto effect(double time, const Moving& motor) const -> double {
    const double s = r_.strength;
    const double sign = top_ ? 1.0 : -1.0;
    switch (r_.truth) {
      case Truth::kNone:
      case Truth::kDelay:
        return 0.0;
      case Truth::kViscous:
        return (top_ ? -0.006 : -0.009) * s * motor.speed;
      case Truth::kPretension:
        return 0.006 * s * sign;
      case Truth::kPlay:
        return 1.08 * (play_ - motor.angle);
      case Truth::kAngleRipple:
        return 0.008 * s * std::sin(3.0 * motor.angle);
      case Truth::kTorqueRipple:
        return 0.15 * s * torque_ * std::sin(5.0 * motor.angle);
      case Truth::kCreep:
        return -0.25 * s * creep_;
      case Truth::kHardening:
        return 2.5 * s * torque_ * std::abs(torque_);
      case Truth::kPresliding:
        return -0.1 * s * bristle_;
      case Truth::kStickySpot:
        return -0.02 * s * sign * std::exp(-std::pow((motor.angle - 0.3) / 0.15, 2));
      case Truth::kDrift:
        return 0.015 * s * (1.0 - std::exp(-time / 60.0));
      case Truth::kCoulomb:
        return -0.006 * s * sign;
    }
    return 0.0;
  }

  SyntheticRequest r_;
  bool started_ = false, top_ = true;
  double last_angle_ = 0.0, friction_ = 0.0, torque_ = 0.0, play_ = 0.0, creep_ = 0.0, bristle_ = 0.0, angle_ = 0.0;
};

/// Adds sensor noise, half white and half coloured, and the steps of the encoder.
void spoil(const SyntheticRequest& r, AxisLog& log) {
  std::mt19937_64 random(r.seed);
  std::normal_distribution<double> normal(0.0, 1.0);
  const double keep = std::pow(r.noise_memory, 100.0 / r.rate_hz);
  const double step = 2.0 * kPi / r.counts_per_turn;
  double coloured = normal(random);
  for (Eigen::Index i = 0; i < log.samples(); ++i) {
    coloured = keep * coloured + std::sqrt(1.0 - keep * keep) * normal(random);
    log.q2_rad[i] += r.noise_rad * std::sqrt(0.5) * (coloured + normal(random));
    log.tau_nm[i] += 0.0003 * normal(random);
    log.q1_rad[i] = std::floor(log.q1_rad[i] / step) * step;
  }
}

}  // namespace

auto truth_name(Truth truth) -> std::string {
  constexpr std::array<const char*, 13> kNames = {"none",
                                                  "transmission_viscous",
                                                  "pretension_offset",
                                                  "play",
                                                  "transport_delay",
                                                  "angle_ripple",
                                                  "torque_ripple",
                                                  "creep",
                                                  "hardening",
                                                  "presliding",
                                                  "sticky_spot",
                                                  "drift",
                                                  "coulomb"};
  return kNames[static_cast<std::size_t>(truth)];
}

auto synthetic_log(const SyntheticRequest& r) -> AxisLog {
  AxisLog log;
  log.name = "synthetic_" + truth_name(r.truth);
  log.target = "axis0/q2_rad";
  log.period_s = 1.0 / r.rate_hz;
  log.has_torque = true;
  const auto rows = static_cast<Eigen::Index>(r.cycle_s * r.cycles * r.rate_hz);
  for (Eigen::VectorXd* signal : {&log.time_s, &log.q1_rad, &log.tau_nm, &log.q2_rad}) {
    signal->resize(rows);
  }
  Joint joint(r);
  const double dt = log.period_s / kFine;
  const double delay_s = r.truth == Truth::kDelay ? 0.006 * r.strength : 0.0;
  std::vector<double> past;  // of the joint's angle, one entry per fine step
  for (Eigen::Index i = 0; i < rows; ++i) {
    Moving motor;
    for (int k = 0; k < kFine; ++k) {
      const double time = static_cast<double>(i) * log.period_s + (k + 1 - kFine) * dt;
      motor = motor_at(r, std::max(time, 0.0));
      joint.step(time, dt, motor);
      past.push_back(joint.angle());
    }
    const double age = std::min(delay_s / dt, static_cast<double>(past.size() - 2));
    const auto whole = static_cast<std::size_t>(age);
    const double part = age - static_cast<double>(whole);
    const double newer = past[past.size() - 1 - whole];
    log.time_s[i] = static_cast<double>(i) * log.period_s;
    log.q1_rad[i] = motor.angle;
    log.tau_nm[i] = joint.torque();
    log.q2_rad[i] = newer + part * (past[past.size() - 2 - whole] - newer);
  }
  spoil(r, log);
  return log;
}

auto log_text(const AxisLog& log) -> std::string {
  std::string text = "time_s,axis0/q1_rad,axis0/tau_Nm,axis0/q2_rad\n";
  for (Eigen::Index i = 0; i < log.samples(); ++i) {
    text += log_number(log.time_s[i]) + "," + log_number(log.q1_rad[i]) + "," + log_number(log.tau_nm[i]) + "," +
            log_number(log.q2_rad[i]) + "\n";
  }
  return text;
}

}  // namespace capstan::tools::test
