// SPDX-License-Identifier: Apache-2.0
#include "capstan/tests/tools/plant/coulomb_plant.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <utility>

namespace capstan::coulomb {
namespace {

constexpr double kStep = 1e-4;  // s
constexpr std::size_t kPoints = 10;
constexpr double kTurn = 2.0 * std::numbers::pi;

/// A tendon from the motor's pulley to the joint's: springs between points that stick while the tensions to either side
/// are within e^(eta / points) of each other, and slide to that bound if not.
class Tendon {
 public:
  Tendon(const Parameters& p, double eta)
      : stiffness_(p.stiffness_n_per_m * (kPoints + 1)),
        eta_(eta / kPoints),
        rest_(p.tension_n / stiffness_),
        tight_(p.effects.pretension_n / stiffness_),
        hardening_(p.effects.hardening) {}

  /// @param motor,joint  where the ends are, m, both counted towards the joint
  /// @param more  friction numbers, times
  void move(double motor, double joint, double more) {
    motor_ = motor;
    joint_ = joint;
    const double bound = std::exp(eta_ * more);
    // Points that slide are 0.1 ms behind then; 8 sweeps leave them 0.3 ms, which is 0.5 mrad at 1.25 rad/s.
    constexpr int kSweeps = 25;
    constexpr double kSettled = 1e-9;
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
      double most = 0.0;
      for (std::size_t i = 0; i < kPoints; ++i) {
        most = std::max(most, settle(sweep % 2 == 0 ? i : kPoints - 1 - i, bound));
      }
      if (most < kSettled) {
        return;
      }
    }
  }
  void lengthen(double by_m) { longer_ = by_m / (kPoints + 1); }
  [[nodiscard]] auto at_motor() const -> double { return tension(places_.front() - motor_); }
  [[nodiscard]] auto at_joint() const -> double { return tension(joint_ - places_.back()); }
  void start_at(double place) { places_.fill(place); }

 private:
  [[nodiscard]] auto stretched(double by) const -> double { return rest_ + tight_ - longer_ + by; }
  [[nodiscard]] auto tension(double by) const -> double {
    const double all = stretched(by);
    return all <= 0.0 ? 0.0 : stiffness_ * all * (1.0 + hardening_ * (all / rest_ - 1.0));
  }
  [[nodiscard]] auto slope(double by) const -> double {
    return stiffness_ * (1.0 + hardening_ * (2.0 * stretched(by) / rest_ - 1.0));
  }
  /// By how far a point slid.
  auto settle(std::size_t i, double bound) -> double {
    const double left = i > 0 ? places_[i - 1] : motor_;
    const double right = i + 1 < kPoints ? places_[i + 1] : joint_;
    const double before = tension(places_[i] - left);
    const double behind = tension(right - places_[i]);
    if (behind <= bound * before && before <= bound * behind) {
      return 0.0;
    }
    const double ratio = behind > before ? bound : 1.0 / bound;
    const bool is_slack = stretched(right - left) + stretched(0.0) <= 0.0;
    double place =
        is_slack ? 0.5 * (left + right) : (right + stretched(0.0) - ratio * (stretched(0.0) - left)) / (1.0 + ratio);
    for (int step = 0; hardening_ != 0.0 && !is_slack && step < 4; ++step) {
      place += (tension(right - place) - ratio * tension(place - left)) /
               (slope(right - place) + ratio * slope(place - left));
    }
    return std::abs(std::exchange(places_[i], place) - place);
  }

  double stiffness_, eta_, rest_, tight_, hardening_;
  double motor_ = 0.0, joint_ = 0.0, longer_ = 0.0;
  std::array<double, kPoints> places_{};
};

/// Dahl's friction: rises over its width and holds.
class Dahl {
 public:
  Dahl(double level, double width) : level_(level), width_(width) {}
  auto move(double rate) -> double {
    bent_ += kStep * rate * (1.0 - bent_ / width_ * (rate > 0.0 ? 1.0 : -1.0));
    bent_ = std::clamp(bent_, -width_, width_);
    return level_ * bent_ / width_;
  }

 private:
  double level_, width_, bent_ = 0.0;
};

/// The motor, critically damped behind what is asked.
struct Motor {
  double angle = 0.0, rate = 0.0, acceleration = 0.0;
  void follow(double asked) {
    constexpr double kFast = 2.0 / 0.01;  // 1/s
    acceleration = kFast * kFast * (asked - angle) - 2.0 * kFast * rate;
    rate += kStep * acceleration;
    angle += kStep * rate;
  }
};

}  // namespace

auto moved(const Parameters& p, const std::function<double(double)>& motor_angle, double duration_s, double rate_hz,
           std::uint64_t seed) -> std::vector<Row> {
  const Effects& e = p.effects;
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  Tendon top(p, p.eta_top);
  Tendon bottom(p, p.eta_bottom);
  Dahl own_friction(p.joint_friction_nm, 1e-3);
  Dahl presliding(e.presliding_nm, 0.05);
  Motor motor;
  motor.angle = motor_angle(0.0);
  double q2 = motor.angle * p.motor_radius_m / p.joint_radius_m;
  double rate = 0.0;
  double load = q2;
  std::array<double, 2> longer{};
  top.start_at(-p.joint_radius_m * q2);
  bottom.start_at(p.joint_radius_m * q2);
  const double inertia = p.joint_inertia_kgm2 + e.load_inertia_kgm2;
  const auto steps_a_row = static_cast<std::size_t>(std::lround(1.0 / (kStep * rate_hz)));
  const auto late = static_cast<std::size_t>(std::lround((p.camera_late_s + e.camera_delay_s) / kStep));
  const double count = kTurn / p.counts_per_turn;
  std::vector<double> shown;
  std::vector<Row> rows;
  double torque = 0.0;
  for (std::size_t i = 0; static_cast<double>(i) * kStep < duration_s; ++i) {
    const double time = static_cast<double>(i) * kStep;
    motor.follow(motor_angle(time));
    const double turned = motor.angle - (time > 0.5 * duration_s ? e.slip_rad : 0.0);
    const double bell = std::exp(-std::pow((q2 - 0.2) / 0.15, 2.0));
    const double more = 1.0 + e.wear * time / duration_s + e.sticky * bell;
    const double grown = e.growth_rad * p.joint_radius_m * (1.0 - std::exp(-time / 20.0));
    top.move(-p.motor_radius_m * turned - grown, -p.joint_radius_m * q2, more);
    bottom.move(p.motor_radius_m * turned + grown, p.joint_radius_m * q2, more);
    const std::array<double, 2> tension = {top.at_joint(), bottom.at_joint()};
    for (std::size_t k = 0; k < 2; ++k) {
      longer[k] += kStep / 3.0 * (e.creep_per_n * (tension[k] - p.tension_n) - longer[k]);
    }
    top.lengthen(longer[0]);
    bottom.lengthen(longer[1]);

    const double outside = e.tremor_nm * std::sin(kTurn * 9.0 * time) + e.detent_nm * std::sin(12.0 * q2) -
                           e.weight_nm * std::sin(q2) - own_friction.move(rate) - presliding.move(rate);
    rate += kStep * (p.joint_radius_m * (tension[0] - tension[1]) + outside) / inertia;
    rate /= 1.0 + kStep * (p.joint_viscous_nms + e.drag_nms) / inertia;  // implicit, for a light joint
    q2 += kStep * rate;
    load = std::clamp(load, q2 - e.play_rad, q2 + e.play_rad);
    shown.push_back(load + e.dial_error_rad * std::sin(7.0 * motor.angle + 0.7));

    torque += p.motor_inertia_kgm2 * motor.acceleration + p.motor_viscous_nms * motor.rate +
              p.motor_friction_nm * std::tanh(motor.rate / 0.01) +
              p.motor_radius_m * (top.at_motor() - bottom.at_motor());
    if ((i + 1) % steps_a_row == 0) {
      rows.push_back({time, count * std::round(motor.angle / count),
                      torque / static_cast<double>(steps_a_row) + p.torque_noise_nm * normal(random),
                      shown[i - std::min(i, late)] + p.camera_noise_rad * normal(random)});
      torque = 0.0;
    }
  }
  return rows;
}

}  // namespace capstan::coulomb
