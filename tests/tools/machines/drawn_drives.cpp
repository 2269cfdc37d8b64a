// SPDX-License-Identifier: Apache-2.0
#include "capstan/tests/tools/machines/drawn_drives.hpp"

#include <algorithm>
#include <cmath>

#include "capstan/tests/tools/play_operator.hpp"

namespace capstan::tools::machines {
namespace {

using Eigen::ArrayXd;

/// Runs smoothly from 0 to 1.
auto eased(const ArrayXd& share) -> ArrayXd {
  const ArrayXd s = share.max(0.0).min(1.0);
  return s.square() * (3.0 - 2.0 * s);
}

/// Another of these values every so often.
template <std::size_t N>
auto levels(Draw& draw, const ArrayXd& t, double every_s, const std::array<double, N>& values) -> ArrayXd {
  ArrayXd x(t.size());
  for (Eigen::Index i = 0, known = -1; i < t.size(); ++i) {
    const auto now = static_cast<Eigen::Index>(t[i] / every_s);
    x[i] = now == known ? x[i - 1] : draw.one_of(values);
    known = now;
  }
  return x;
}

/// A first-order lag, there and back, so that nothing is late.
auto smoothed(const ArrayXd& x, double time_constant_s, double step_s) -> ArrayXd {
  const double share = step_s / (time_constant_s + step_s);
  ArrayXd y = x;
  for (Eigen::Index i = 1; i < y.size(); ++i) {
    y[i] = y[i - 1] + share * (y[i] - y[i - 1]);
  }
  for (Eigen::Index i = y.size() - 2; i >= 0; --i) {
    y[i] = y[i + 1] + share * (y[i] - y[i + 1]);
  }
  return y;
}

auto integral_of(const ArrayXd& speed, double step_s) -> ArrayXd {
  ArrayXd q = ArrayXd::Zero(speed.size());
  for (Eigen::Index i = 1; i < q.size(); ++i) {
    q[i] = q[i - 1] + speed[i] * step_s;
  }
  return q;
}

auto two_sines(Draw& draw, const ArrayXd& t) -> ArrayXd {
  return (draw(0.8, 1.3) * t).sin() + 0.3 * (5.0 * t).sin() * (2.0 * t).sin();
}

auto growing_sine(Draw& draw, const ArrayXd& t) -> ArrayXd {
  return (draw(0.7, 1.1) * t.square()).sin();
}

auto up_and_down(Draw& /*draw*/, const ArrayXd& t) -> ArrayXd {
  const double half_s = 0.5 * t[t.size() - 1];
  return 1.4 * eased((t / half_s).min(2.0 - t / half_s));
}

auto lift(Draw& draw, const ArrayXd& t) -> ArrayXd {
  return -1.4 * eased(t / (draw(0.4, 0.7) * t[t.size() - 1]));
}

auto places(Draw& draw, const ArrayXd& t) -> ArrayXd {
  constexpr double kEveryS = 0.7;
  return levels(draw, t, kEveryS, std::array{-1.0, -0.7, -0.3, 0.2, 0.5, 0.9});
}

/// Torques in N m. Friction between two torques that meet in a gear: the motor's and the load's.
struct ServoFriction {
  double coulomb, drag, stribeck, stribeck_speed, with_load, with_motor;
  [[nodiscard]] auto level(double speed, double motor, double load) const -> double {
    return coulomb * (1.0 + stribeck * std::exp(-std::pow(speed / stribeck_speed, 2))) + with_load * std::abs(load) +
           with_motor * std::abs(motor);
  }
};

auto servo_friction(Draw& draw, double weight) -> ServoFriction {
  const auto or_none = [&](double value) { return draw(0.0, 1.0) < 0.5 ? value : 0.0; };
  ServoFriction friction{};
  friction.coulomb = weight * draw(0.05, 0.35);
  friction.drag = weight * draw(0.01, 0.1);
  friction.stribeck = or_none(draw(0.1, 0.6));
  friction.stribeck_speed = draw(0.05, 0.4);
  friction.with_load = or_none(draw(0.05, 0.25));
  friction.with_motor = or_none(draw(0.02, 0.1));
  return friction;
}

auto by_hand(Draw& draw, const ArrayXd& t) -> ArrayXd {
  const double slow_s = draw(0.15, 0.5);
  return integral_of(smoothed(draw.normal(t.size(), 1.0), slow_s, t[1]), t[1]);
}

auto in_sines(Draw& draw, const ArrayXd& t) -> ArrayXd {
  return (kTurn * draw(0.05, 0.5) * t).sin() + 0.3 * (kTurn * draw(0.3, 0.8) * t).sin();
}

auto at_steady_speeds(Draw& draw, const ArrayXd& t) -> ArrayXd {
  constexpr double kEveryS = 2.0;
  constexpr double kRoundedS = 0.05;
  const ArrayXd speed = levels(draw, t, kEveryS, std::array{-1.0, -0.5, 0.5, 1.0});
  return smoothed(integral_of(speed, t[1]), kRoundedS, t[1]);
}

/// A motor's torque by whoever tests a gear: levels, sines, or by chance; 1 at most.
auto test_torque(Draw& draw, const ArrayXd& t) -> ArrayXd {
  constexpr double kLevelS = 5.0;
  const double kind = draw(0.0, 3.0);
  if (kind < 1.0) {
    return levels(draw, t, kLevelS, std::array{-1.0, -0.5, -0.2, 0.0, 0.2, 0.5, 0.8, 1.0});
  }
  if (kind < 2.0) {
    return 0.6 * (kTurn * draw(0.1, 0.6) * t + 1.0).sin() + 0.4 * (kTurn * draw(0.5, 1.5) * t).sin();
  }
  constexpr double kSlowS = 0.2;
  const ArrayXd noise = smoothed(draw.normal(t.size(), 1.0), kSlowS, t[1]);
  return noise / noise.abs().maxCoeff();
}

auto times(double seconds, double period_s) -> ArrayXd {
  const auto rows = static_cast<Eigen::Index>(seconds / period_s);
  return ArrayXd::LinSpaced(rows, 0.0, period_s * static_cast<double>(rows - 1));
}

}  // namespace

const std::array<std::pair<const char*, GoalKind>, 5> kGoals = {
    {{"sines", two_sines}, {"growing", growing_sine}, {"updown", up_and_down}, {"lift", lift}, {"places", places}}};

const std::array<std::pair<const char*, TurnKind>, 3> kTurns = {
    {{"hand", by_hand}, {"sines", in_sines}, {"steady", at_steady_speeds}}};

auto servo_log(Draw& draw, GoalKind goal) -> DriveLog {
  constexpr double kGravity = 9.81;
  constexpr double kCount = kTurn / 4096.0;
  constexpr double kNoiseShare = 0.01;
  const double period_s = 1.0 / draw.one_of(std::array{100.0, 140.0, 190.0});
  DriveLog log;
  log.time_s = times(draw(0.0, 1.0) < 0.6 ? 6.0 : draw(8.0, 25.0), period_s);
  const ArrayXd goals = draw(0.5, 1.6) * goal(draw, log.time_s);
  const double mass_kg = draw.in_ratio(0.05, 1.0);
  const double length_m = draw(0.05, 0.2);
  const double weight = mass_kg * kGravity * length_m;
  const double inertia = mass_kg * length_m * length_m * draw(1.0, 1.4) + draw.in_ratio(1e-4, 1e-3);
  const double torque_per_volt = weight * draw.in_ratio(0.15, 0.5);
  const double volts_per_rad = draw.in_ratio(8.0, 40.0);
  const double most_volts = draw(5.0, 12.0);
  const ServoFriction friction = servo_friction(draw, weight);
  const double back_emf = 0.6 * torque_per_volt;  // N m s/rad
  const double step_s = period_s / static_cast<double>(kSteps);
  double angle = 0.0;
  double speed = 0.0;
  log.motor_angle = log.effort = ArrayXd::Zero(log.time_s.size());
  for (Eigen::Index i = 0; i < log.time_s.size(); ++i) {
    const double volts = std::clamp(volts_per_rad * (goals[i] - angle), -most_volts, most_volts);
    log.motor_angle[i] = std::round(angle / kCount) * kCount;
    log.effort[i] = volts;
    for (Eigen::Index k = 0; k < kSteps; ++k) {
      const double motor = torque_per_volt * volts - (back_emf + friction.drag) * speed;
      const double load = -weight * std::sin(angle);
      // Friction takes the speed away, and no more.
      const double next = speed + step_s / inertia * (motor + load);
      const double most = step_s / inertia * friction.level(speed, motor, load);
      speed = next - std::clamp(next, -most, most);
      angle += step_s * speed;
    }
  }
  log.effort += draw.normal(log.effort.size(), kNoiseShare * std::sqrt(log.effort.square().mean()));
  return log;
}

auto gear_log(Draw& draw, TurnKind turn) -> DriveLog {
  const double period_s = 1.0 / draw.one_of(std::array{100.0, 200.0, 500.0});
  DriveLog log;
  log.time_s = times(draw(25.0, 60.0), period_s);
  const double range = draw(0.2, 2.0);
  ArrayXd angle = turn(draw, log.time_s);
  angle *= range / (angle.maxCoeff() - angle.minCoeff());
  const Motion motion(angle, period_s);
  const double most = draw.in_ratio(1.0, 20.0);
  const ArrayXd torque = test_torque(draw, log.time_s);  // below in shares of the most
  const double ratio = draw(0.0, 1.0) < 0.7 ? draw(0.8, 1.3) : draw(5.0, 10.0);
  const double saturation = draw(0.0, 1.0) < 0.5 ? draw(0.0, 0.25) : 0.0;
  const ArrayXd carried = torque * (1.0 - saturation * torque.abs());
  const double own = draw(0.01, 0.08);
  const double with_load = draw(0.02, 0.2);
  const double driven = draw(0.0, 0.5);  // how much more where the load drives
  const double way = range * draw(0.001, 0.02);
  ArrayXd output =
      carried - draw(0.0, 0.05) * motion.v / motion.top_speed - draw(0.0, 0.04) * motion.a / motion.a.abs().maxCoeff();
  double grip = 0.0;
  for (Eigen::Index i = 1; i < angle.size(); ++i) {
    grip = std::clamp(grip + (angle[i] - angle[i - 1]) / way, -1.0, 1.0);
    const double more = std::copysign(driven, carried[i] * motion.v[i]);
    output[i] -= (own + with_load * std::abs(carried[i]) * (1.0 + more)) * grip;
  }
  if (draw(0.0, 1.0) < 0.4) {
    output += 0.02 * (std::floor(draw(5.0, 40.0)) * angle).sin();
  }
  output += draw.normal(output.size(), draw(0.004, 0.03)) + draw(-0.03, 0.03);
  const ArrayXd noisy = torque + draw.normal(torque.size(), 0.004);
  const auto late = std::lround(draw(-2.5, 4.5));
  log.effort = ArrayXd::NullaryExpr(noisy.size(), [&](Eigen::Index i) {
    return most * noisy[std::clamp<Eigen::Index>(i - late, 0, noisy.size() - 1)];
  });
  constexpr double kCount = 1e-4;
  log.motor_angle = (angle / kCount).round() * kCount;
  log.output_torque = most * ratio * output;
  return log;
}

}  // namespace capstan::tools::machines
