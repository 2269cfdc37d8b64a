// SPDX-License-Identifier: Apache-2.0
#include "capstan/tests/tools/plant/independent_plant.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <random>
#include <stdexcept>

namespace capstan::independent {
namespace {

constexpr int kStepsPerMs = 64;
constexpr double kStep = 1e-3 / kStepsPerMs;  // s
// Guides' bristles are so much stiffer than the springs between them: they yield long before those have stretched.
constexpr double kBristle = 4.0;
// Frequency of the fastest mode times the step; explicit integration fails at 2. Points are as heavy as that takes:
// some 20 g in all, whose inertia at joint speeds is far below any friction.
constexpr double kFastest = 0.7;
constexpr double kDamping = 0.1;  // of the springs, of critical

/// Friction of one rubbing contact: an elastic bristle that yields where it carries `limit`.
struct Bristle {
  double force = 0.0;
  auto move(double stiffness, double way, double limit) -> double {
    force = std::clamp(force + stiffness * way, -limit, limit);
    return force;
  }
};

/// Dahl (1968): dF/dx = sigma (1 - F / Fc sgn v).
struct Dahl {
  double force = 0.0;
  auto move(double sigma, double way, double limit) -> double {
    if (limit <= 0.0) {
      return 0.0;
    }
    force = (force + sigma * way) / (1.0 + sigma * std::abs(way) / limit);
    return force;
  }
};

class Tendon {
 public:
  Tendon(const TendonDrawing& drawing, double tension_n, double hardening, double drag)
      : shares_(drawing.guide_shares), eta_(drawing.eta), hardening_(hardening) {
    const auto guides = static_cast<double>(shares_.size());
    // Half a piece at either end: the sum of the pieces' compliances is that of the whole.
    spring_.assign(shares_.size() + 1, guides * drawing.stiffness_n_per_m);
    spring_.front() *= 2.0;
    spring_.back() *= 2.0;
    const double inner = guides * drawing.stiffness_n_per_m;
    bristle_stiffness_ = kBristle * inner;
    // Hardening by at most twice at usual tensions is in the margin.
    mass_ =
        (6.0 * inner * (hardening > 0.0 ? 2.0 : 1.0) + bristle_stiffness_) * (kStep / kFastest) * (kStep / kFastest);
    damper_ = kDamping * std::sqrt(inner * mass_);
    drag_ = drag / guides;
    points_.resize(shares_.size());
    tensions_.resize(spring_.size());
    stretch_ = tension_n / drawing.stiffness_n_per_m;
    if (hardening > 0.0) {
      stretch_ = std::log1p(2.0 * hardening * tension_n) / (2.0 * hardening * drawing.stiffness_n_per_m);
    }
    share_of_stretch_.resize(spring_.size());
    for (std::size_t i = 0; i < spring_.size(); ++i) {
      share_of_stretch_[i] = drawing.stiffness_n_per_m / spring_[i];
    }
  }

  void shorten(double metres) { stretch_ += metres; }

  /// One step. Positions and speeds of the ends, m, positive toward the motor.
  void step(double in, double in_rate, double out, double out_rate, double eta_factor) {
    double before = in;
    double before_rate = in_rate;
    const std::size_t last = points_.size();
    for (std::size_t i = 0; i <= last; ++i) {
      const double here = i < last ? points_[i].place : out;
      const double here_rate = i < last ? points_[i].rate : out_rate;
      double force = spring_[i] * (before - here + share_of_stretch_[i] * stretch_);
      if (hardening_ > 0.0) {
        force = std::expm1(2.0 * hardening_ * force) / (2.0 * hardening_);
      }
      force += damper_ * (before_rate - here_rate);
      tensions_[i] = std::max(0.0, force);
      before = here;
      before_rate = here_rate;
    }
    const double eta = eta_ * eta_factor;
    for (std::size_t i = 0; i < last; ++i) {
      Point& point = points_[i];
      const double limit = eta * shares_[i] * 0.5 * (tensions_[i] + tensions_[i + 1]);
      const double rub = point.bristle.move(bristle_stiffness_, point.rate * kStep, limit);
      point.rate += kStep / mass_ * (tensions_[i] - tensions_[i + 1] - rub - drag_ * point.rate);
      point.place += kStep * point.rate;
    }
  }

  [[nodiscard]] auto at_motor() const -> double { return tensions_.front(); }
  [[nodiscard]] auto at_joint() const -> double { return tensions_.back(); }

 private:
  struct Point {
    double place = 0.0, rate = 0.0;
    Bristle bristle;
  };
  std::vector<double> shares_, spring_, tensions_, share_of_stretch_;
  std::vector<Point> points_;
  double eta_, hardening_, stretch_ = 0.0, bristle_stiffness_ = 0.0, mass_ = 0.0, damper_ = 0.0, drag_ = 0.0;
};

/// A turning body with a bearing that rubs.
struct Body {
  double angle = 0.0, rate = 0.0;
  Bristle bearing;
  void step(double torque, double inertia) {
    rate += kStep / inertia * torque;
    angle += kStep * rate;
  }
};

/// Position servo of 1 kHz on the encoder: proportional, integral, filtered rate; then the current's lag.
class Servo {
 public:
  explicit Servo(double inertia) : inertia_(inertia) {}
  void sample(double wanted, double measured) {
    constexpr double kPeriod = 1e-3;
    constexpr double kBand = 2.0 * std::numbers::pi * 30.0;
    const double error = wanted - measured;
    rate_ += 0.3 * ((error - last_) / kPeriod - rate_);
    last_ = error;
    const double stiffness = inertia_ * kBand * kBand;
    sum_ = std::clamp(sum_ + kPeriod * 20.0 * stiffness * error, -kLargest, kLargest);
    command_ = std::clamp(stiffness * error + 1.4 * inertia_ * kBand * rate_ + sum_, -kLargest, kLargest);
  }
  auto torque() -> double {
    torque_ += kStep * 2.0 * std::numbers::pi * 300.0 * (command_ - torque_);
    return torque_;
  }

 private:
  static constexpr double kLargest = 0.25;
  double inertia_, rate_ = 0.0, last_ = 0.0, sum_ = 0.0, command_ = 0.0, torque_ = 0.0;
};

/// Standard normal by the polar way, alike with every standard library.
class Noise {
 public:
  explicit Noise(std::uint64_t seed) : bits_(seed) {}
  auto operator()() -> double {
    for (;;) {
      const double a = even();
      const double b = even();
      const double square = a * a + b * b;
      if (square > 0.0 && square < 1.0) {
        return a * std::sqrt(-2.0 * std::log(square) / square);
      }
    }
  }

 private:
  auto even() -> double { return static_cast<double>(bits_() >> 11) * 0x1.0p-52 - 1.0; }
  std::mt19937_64 bits_;
};

class Plant {
 public:
  Plant(const Parameters& p, double duration_s)
      : p_(p),
        e_(p.effects),
        top_(p.top, 0.5 * p.pretension_n, e_.hardening_per_n, e_.drag_ns_per_m),
        bottom_(p.bottom, 0.5 * p.pretension_n, e_.hardening_per_n, e_.drag_ns_per_m),
        servo_(p.motor_inertia_kgm2),
        slip_at_(duration_s / 6.0) {
    top_.shorten(0.5 * e_.pretension_n / p.top.stiffness_n_per_m);
    bottom_.shorten(0.5 * e_.pretension_n / p.bottom.stiffness_n_per_m);
  }

  void servo(double wanted) { servo_.sample(wanted, counted()); }

  [[nodiscard]] auto counted() const -> double {
    const double count = 2.0 * std::numbers::pi / p_.counts_per_turn;
    return count * std::floor(motor_.angle / count);
  }
  [[nodiscard]] auto motor_torque() const -> double { return motor_torque_; }
  [[nodiscard]] auto joint() const -> double { return joint_.angle; }
  [[nodiscard]] auto joint_torque() const -> double { return joint_torque_; }

  void step(double time) {
    const double pulley = motor_.angle + e_.gear_error_rad * (std::sin(5.0 * motor_.angle + 0.7) - std::sin(0.7)) -
                          (time > slip_at_ ? e_.slip_rad : 0.0);
    const double gain = 1.0 + 5.0 * e_.gear_error_rad * std::cos(5.0 * motor_.angle + 0.7);
    const double in = p_.motor_radius_m * pulley;
    const double in_rate = p_.motor_radius_m * gain * motor_.rate;
    const Body& wheel = e_.play_rad > 0.0 ? pulley_ : joint_;
    const double out = p_.joint_radius_m * wheel.angle;
    const double out_rate = p_.joint_radius_m * wheel.rate;
    const double grown = e_.growth_m * -std::expm1(-time / 300.0);
    top_.shorten(grown_ - grown);
    grown_ = grown;
    way_ += std::abs(motor_.rate) * kStep;
    const double eta_factor = (1.0 + e_.wear_per_rad * way_) * (1.0 + e_.bend_per_rad * std::abs(joint_.angle));
    top_.step(in, in_rate, out, out_rate, eta_factor);
    bottom_.step(-in, -in_rate, -out, -out_rate, eta_factor);
    step_motor(gain);
    step_joint(time);
  }

 private:
  void step_motor(double gain) {
    motor_torque_ = servo_.torque();
    const double tendons = (top_.at_motor() - bottom_.at_motor()) * p_.motor_radius_m * gain;
    const double rub = motor_.bearing.move(p_.motor_friction_nm / 2e-4, kStep * motor_.rate, p_.motor_friction_nm) +
                       p_.motor_viscous_nms * motor_.rate + e_.detent_nm * std::sin(35.0 * motor_.angle);
    motor_.step(motor_torque_ - tendons - rub, p_.motor_inertia_kgm2);
    if (!(std::abs(motor_.angle) < 1e3)) {
      throw std::runtime_error("the independent plant diverged");
    }
  }

  void step_joint(double time) {
    joint_torque_ = (top_.at_joint() - bottom_.at_joint()) * p_.joint_radius_m;
    if (p_.held) {
      return;
    }
    double drive = joint_torque_;
    if (e_.play_rad > 0.0) {
      // A light wheel that carries the joint along by stiff cheeks, a gap between them.
      const double apart = pulley_.angle - joint_.angle;
      const double pressed = apart - std::clamp(apart, -e_.play_rad, e_.play_rad);
      double contact = 150.0 * pressed + 1e-3 * (pulley_.rate - joint_.rate) * (pressed != 0.0 ? 1.0 : 0.0);
      contact = pressed == 0.0 || contact * pressed < 0.0 ? 0.0 : contact;
      pulley_.step(joint_torque_ - contact - 1e-5 * pulley_.rate, kWheel * p_.joint_inertia_kgm2);
      drive = contact;
    }
    const double bell = (joint_.angle - 0.2) / 0.05;
    const double limit = p_.joint_friction_nm + e_.sticky_nm * std::exp(-bell * bell);
    drive -= joint_.bearing.move(p_.joint_friction_nm / 5e-4, kStep * joint_.rate, limit);
    drive -= bent_.move(e_.presliding_nm / 0.02, kStep * joint_.rate, e_.presliding_nm);
    drive -= p_.joint_viscous_nms * joint_.rate + e_.weight_nm * std::sin(joint_.angle + e_.weight_angle_rad);
    drive += e_.tremor_nm * std::sin(2.0 * std::numbers::pi * 3.0 * time);
    joint_.step(drive, p_.joint_inertia_kgm2 * (e_.play_rad > 0.0 ? 1.0 - kWheel : 1.0) + e_.load_inertia_kgm2);
  }

  static constexpr double kWheel = 0.3;  // its share of the joint's inertia
  const Parameters& p_;
  const Effects& e_;
  Tendon top_, bottom_;
  Servo servo_;
  Body motor_, joint_, pulley_;
  Dahl bent_;
  double slip_at_, grown_ = 0.0, way_ = 0.0, motor_torque_ = 0.0, joint_torque_ = 0.0;
};

}  // namespace

auto moved(const Parameters& parameters, const std::function<double(double)>& motor_angle, double duration_s,
           double rate_hz, std::uint64_t seed) -> std::vector<Row> {
  Plant plant(parameters, duration_s);
  Noise noise(seed);
  const auto per_row = static_cast<long>(std::lround(1000.0 * kStepsPerMs / rate_hz));
  const auto steps = static_cast<long>(std::llround(duration_s * 1000.0 * kStepsPerMs));
  const auto late = static_cast<std::size_t>(std::lround(parameters.effects.camera_delay_s / kStep));
  std::vector<double> seen(late + 1, 0.0);  // ring of joint angles
  std::vector<Row> rows;
  rows.reserve(static_cast<std::size_t>(steps / per_row) + 1);
  for (long n = 0; n < steps; ++n) {
    const double time = static_cast<double>(n) * kStep;
    if (n % kStepsPerMs == 0) {
      plant.servo(motor_angle(time));
    }
    seen[static_cast<std::size_t>(n) % seen.size()] = plant.joint();
    if (n % per_row == 0) {
      const double late_angle = seen[(static_cast<std::size_t>(n) + 1) % seen.size()];
      const double step = parameters.torque_step_nm;
      const double torque = plant.motor_torque() + parameters.torque_noise_nm * noise();
      rows.push_back({time, plant.counted(), step * std::round(torque / step),
                      late_angle + parameters.camera_noise_rad * noise(),
                      plant.joint_torque() + parameters.tip_torque_noise_nm * noise()});
    }
    plant.step(time);
  }
  return rows;
}

}  // namespace capstan::independent
