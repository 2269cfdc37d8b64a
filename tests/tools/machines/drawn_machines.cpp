// SPDX-License-Identifier: Apache-2.0
#include "capstan/tests/tools/machines/drawn_machines.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>

#include "capstan/tests/tools/machines/drawn_drives.hpp"
#include "capstan/tests/tools/machines/drawn_motion.hpp"
#include "capstan/tests/tools/play_operator.hpp"

namespace capstan::tools::machines {
namespace {

using Eigen::ArrayXd;

/// z' = q' - beta |q'| |z|^(n-1) z - gamma q' |z|^n, all per width: z tends to the width.
auto bouc_wen(const ArrayXd& q, double width, double gamma = 0.0, double n = 1.0) -> ArrayXd {
  ArrayXd z(q.size());
  z[0] = 0.0;
  for (Eigen::Index i = 1; i < q.size(); ++i) {
    const double step = q[i] - q[i - 1];
    const double x = z[i - 1] / width;
    const double held = std::pow(std::abs(x), n);
    z[i] = z[i - 1] + step - std::abs(step) * std::copysign(held, x) - gamma * step * held;
  }
  return z;
}

auto backlash(const ArrayXd& q, double half_width) -> ArrayXd {
  return test::play_of(q, half_width);
}

/// What eight springs, each on a slider of its own, hold back.
auto maxwell_slip(Draw& draw, const ArrayXd& q, double widest) -> ArrayXd {
  constexpr int kSliders = 8;
  ArrayXd held = ArrayXd::Zero(q.size());
  double weights = 0.0;
  for (int i = 0; i < kSliders; ++i) {
    const double half = widest * std::pow(0.03, 1.0 - static_cast<double>(i) / (kSliders - 1));
    const double weight = -std::log(1.0 - draw(0.0, 1.0));
    weights += weight;
    held += weight * (q - backlash(q, half));
  }
  return held / weights;
}

auto low_pass(const ArrayXd& x, double time_constant_s, double step_s) -> ArrayXd {
  ArrayXd y(x.size());
  y[0] = x[0];
  for (Eigen::Index i = 1; i < x.size(); ++i) {
    y[i] = y[i - 1] + (x[i - 1] - y[i - 1]) * step_s / time_constant_s;
  }
  return y;
}

/// A joint behind a spring of stiffness one, with Dahl's friction and some drag: its angle.
auto behind_a_spring(const ArrayXd& q, double friction, double presliding, double step_s) -> ArrayXd {
  constexpr double kDragS = 0.02;
  constexpr int kFiner = 8;
  const double stiffness = friction / presliding;
  ArrayXd joint(q.size());
  double x = 0.0;
  double z = 0.0;
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    for (int k = 0; k < kFiner; ++k) {
      const double v = (q[i] - x - stiffness * z) / kDragS;
      z += step_s / kFiner * (v - std::abs(v) * z / presliding);
      x += step_s / kFiner * v;
    }
    joint[i] = x;
  }
  return joint;
}

/// What a joint's log is made from, every step.
struct Joint {
  ArrayXd q2, other, torque;  ///< another motor's angle and this one's torque, where there are any
};
using JointKind = Joint (*)(Draw&, const Motion&, const Motion&);

constexpr std::array<std::pair<const char*, JointKind>, 10> kJoints = {{
    {"boucwen",
     [](Draw& draw, const Motion& m, const Motion& /*other*/) -> Joint {
       return {m.q - draw(0.3, 0.9) * bouc_wen(m.q, m.amplitude * draw(0.1, 0.5), draw(-0.2, 0.1)), {}, {}};
     }},
    {"elastic",
     [](Draw& draw, const Motion& m, const Motion& /*other*/) -> Joint {
       const ArrayXd joint =
           behind_a_spring(m.q, m.amplitude * draw(0.05, 0.25), m.amplitude * draw(0.01, 0.05), m.t[1]);
       const ArrayXd torque = draw.in_ratio(0.05, 2.0) * (m.q - joint);
       return {joint, {}, draw(0.0, 1.0) < 0.5 ? torque : ArrayXd()};
     }},
    {"backlash",
     [](Draw& draw, const Motion& m, const Motion& /*other*/) -> Joint {
       const ArrayXd p = backlash(m.q, m.amplitude * draw(0.03, 0.2));
       return {draw(0.7, 1.0) * p + 0.1 * m.amplitude * (p / m.amplitude * draw(1.0, 2.5)).sin(), {}, {}};
     }},
    {"eccentric",
     [](Draw& draw, const Motion& m, const Motion& /*other*/) -> Joint {
       const ArrayXd wave = (m.q / m.amplitude * draw.in_ratio(1.0, 8.0) + draw(0.0, kTurn)).sin();
       return {
           m.q - draw(0.4, 1.0) * bouc_wen(m.q, m.amplitude * draw(0.03, 0.15)) + m.amplitude * draw(0.02, 0.08) * wave,
           {},
           {}};
     }},
    {"maxwell",
     [](Draw& draw, const Motion& m, const Motion& /*other*/) -> Joint {
       const ArrayXd y = m.q - draw(0.6, 1.0) * maxwell_slip(draw, m.q, m.amplitude * draw(0.3, 0.8));
       return {y + 0.05 * y.square() / m.amplitude, {}, {}};
     }},
    {"creep",
     [](Draw& draw, const Motion& m, const Motion& /*other*/) -> Joint {
       const ArrayXd p = backlash(m.q, m.amplitude * draw(0.02, 0.1));
       return {0.85 * p + 0.15 * low_pass(p, draw.in_ratio(0.5, 10.0), m.t[1]), {}, {}};
     }},
    {"coupled",
     [](Draw& draw, const Motion& m, const Motion& other) -> Joint {
       const ArrayXd own = m.q - 0.8 * bouc_wen(m.q, m.amplitude * draw(0.05, 0.2));
       return {
           own + draw(-0.3, 0.3) * (other.q - 0.6 * bouc_wen(other.q, other.amplitude * draw(0.05, 0.2))), other.q, {}};
     }},
    {"sheath",
     [](Draw& draw, const Motion& m, const Motion& /*other*/) -> Joint {
       const ArrayXd y =
           m.q - draw(0.8, 1.0) * bouc_wen(m.q, m.amplitude * draw(0.1, 0.5), draw(-0.3, 0.3), draw(1.0, 1.6));
       return {y + 0.03 * y.max(0.0).square() / m.amplitude, {}, {}};
     }},
    {"drift",
     [](Draw& draw, const Motion& m, const Motion& /*other*/) -> Joint {
       return {m.q - 0.9 * bouc_wen(m.q, m.amplitude * draw(0.05, 0.2), 0.0, 1.2) +
                   0.05 * m.amplitude * (1.0 - (-m.t / draw(15.0, 60.0)).exp()),
               {},
               {}};
     }},
    {"fourbar",
     [](Draw& draw, const Motion& m, const Motion& /*other*/) -> Joint {
       const double r = draw(0.4, 0.8);
       ArrayXd x = m.q / m.amplitude * draw(0.4, 1.0);
       x -= 0.8 * bouc_wen(x, draw(0.05, 0.2));
       return {
           (r * x.sin()).binaryExpr(1.0 - r * x.cos(), [](double s, double c) { return std::atan2(s, c); }), {}, {}};
     }},
}};

/// Its state's friction is F at high speed and more at low: LuGre without its damping.
auto lugre(const ArrayXd& v, double step_s, double friction, double more, double stribeck_speed, double presliding)
    -> ArrayXd {
  ArrayXd force(v.size());
  double z = 0.0;
  for (Eigen::Index i = 0; i < v.size(); ++i) {
    const double level = friction + more * std::exp(-std::pow(v[i] / stribeck_speed, 2));
    const double rate = std::abs(v[i]) * friction / (presliding * level);
    z = (z + step_s * v[i]) / (1.0 + step_s * rate);
    force[i] = friction / presliding * z;
  }
  return force;
}

/// What an axis asks for beside its inertia. Friction of about one; `s` is the direction of the motion.
struct AxisDraw {
  Draw& draw;
  const Motion& m;
  ArrayXd s;
  double friction, drag;
  [[nodiscard]] auto weight(double least, double most) const -> ArrayXd {
    return draw(least, most) * (m.q + draw(0.0, kTurn)).sin();
  }
};
using AxisKind = ArrayXd (*)(const AxisDraw&);

constexpr std::array<std::pair<const char*, AxisKind>, 11> kAxes = {{
    {"lugre",
     [](const AxisDraw& d) -> ArrayXd {
       return lugre(d.m.v, d.m.t[1], d.friction, d.friction * d.draw(0.0, 0.6), d.m.top_speed * d.draw(0.02, 0.1),
                    d.m.amplitude * d.draw(0.002, 0.03)) +
              d.drag * d.m.v + d.weight(0.2, 1.0);
     }},
    {"power",
     [](const AxisDraw& d) -> ArrayXd {
       return d.friction * d.s +
              d.drag * d.m.top_speed * d.m.v.sign() * (d.m.v.abs() / d.m.top_speed).pow(d.draw(0.3, 0.7)) +
              d.draw(-0.3, 0.3);
     }},
    {"load",
     [](const AxisDraw& d) -> ArrayXd {
       const ArrayXd load = d.weight(0.6, 2.0);
       return load + d.s * (0.5 * d.friction + d.draw(0.1, 0.35) * load.abs()) + d.drag * d.m.v;
     }},
    {"spring",
     [](const AxisDraw& d) -> ArrayXd {
       const ArrayXd x = d.m.q / d.m.amplitude;
       return d.draw(0.5, 2.0) * x.sign() * (x.abs() - 0.1).max(0.0) + d.draw(0.0, 0.6) * x.cube() +
              0.4 * d.friction * d.s + d.drag * d.m.v;
     }},
    {"cogging",
     [](const AxisDraw& d) -> ArrayXd {
       return d.friction * d.s + d.drag * d.m.v +
              d.draw(0.1, 0.4) * (std::floor(d.draw(4.0, 14.0)) * d.m.q + d.draw(0.0, kTurn)).sin() +
              d.weight(0.3, 1.0);
     }},
    {"hysteretic",
     [](const AxisDraw& d) -> ArrayXd {
       const double width = d.m.amplitude * d.draw(0.03, 0.2);
       return d.friction / width * bouc_wen(d.m.q, width) + d.drag * d.m.v + d.draw(0.2, 1.0) / d.m.amplitude * d.m.q;
     }},
    {"asymmetric",
     [](const AxisDraw& d) -> ArrayXd {
       const double back = d.draw(0.4, 0.9);
       const double back_drag = d.draw(0.5, 1.5);
       const ArrayXd friction = d.friction * d.s + d.drag * d.m.v;
       return (d.m.v > 0.0).select(friction, back * d.friction * d.s + back_drag * d.drag * d.m.v) + d.weight(0.5, 1.5);
     }},
    {"squared",
     [](const AxisDraw& d) -> ArrayXd {
       return 0.5 * d.friction * d.s + d.drag * d.m.v +
              d.draw(0.2, 1.0) * d.m.v * d.m.v.abs() / (d.m.top_speed * d.m.top_speed) + d.draw(-0.3, 0.3);
     }},
    {"stribeck",
     [](const AxisDraw& d) -> ArrayXd {
       const ArrayXd x = d.m.v / (d.m.top_speed * d.draw(0.05, 0.2));
       return d.friction * d.s * (1.0 + d.draw(0.2, 0.8) * (-x.square()).exp()) + d.drag * d.m.v + d.weight(0.2, 0.6);
     }},
    {"warming",
     [](const AxisDraw& d) -> ArrayXd {
       return 0.5 * d.friction * d.s + d.drag * d.m.v * (1.0 + d.draw(0.3, 1.0) * (-d.m.t / d.draw(5.0, 20.0)).exp()) +
              d.weight(0.2, 0.6);
     }},
    {"saturating",
     [](const AxisDraw& d) -> ArrayXd {
       const ArrayXd effort = d.friction * d.s + d.drag * d.m.v + d.weight(1.0, 2.0);
       const double most = effort.abs().maxCoeff() / 1.2;
       return most * (effort / most).tanh();
     }},
}};

/// What a log holds of a signal: its rows.
auto rows_of(const ArrayXd& signal) -> ArrayXd {
  const Eigen::Index rows = signal.size() / kSteps;
  return ArrayXd::NullaryExpr(rows, [&](Eigen::Index i) { return signal[i * kSteps]; });
}
auto late_by(const ArrayXd& rows, Eigen::Index late) -> ArrayXd {
  return ArrayXd::NullaryExpr(rows.size(), [&](Eigen::Index i) { return rows[std::max<Eigen::Index>(0, i - late)]; });
}
auto counted(const ArrayXd& rows, double count) -> ArrayXd {
  return (rows / count).round() * count;
}
auto spread_of(const ArrayXd& rows) -> double {
  return std::sqrt((rows - rows.mean()).square().mean());
}

struct LogColumns {
  std::vector<std::string> names;
  std::vector<ArrayXd> values;
  void add(const std::string& name, const ArrayXd& rows) {
    names.push_back(name);
    values.push_back(rows);
  }
};

auto machine_of(const std::string& name, const LogColumns& log) -> DrawnMachine {
  DrawnMachine machine{name, log.names, Eigen::MatrixXd(log.values.front().size(), std::ssize(log.values))};
  for (std::size_t i = 0; i < log.values.size(); ++i) {
    machine.rows.col(static_cast<Eigen::Index>(i)) = log.values[i].matrix();
  }
  return machine;
}

auto joint_log(Draw& draw, JointKind kind, MotionKind moves) -> LogColumns {
  const double period_s = 1.0 / draw.one_of(std::array{30.0, 50.0, 100.0, 200.0});
  const double seconds = draw(25.0, 70.0);
  const double amplitude = draw.in_ratio(0.3, 6.0);
  const Motion motion = motion_of(draw, moves, seconds, period_s, amplitude);
  const Motion other = motion_of(draw, moves, seconds, period_s, amplitude * draw(0.4, 1.3));
  const Joint joint = kind(draw, motion, other);
  const ArrayXd q2 =
      draw.in_ratio(0.2, 1.2) * late_by(rows_of(joint.q2), std::lround(draw.one_of(std::array{0.0, 0.0, 1.0, 2.0})));
  const double spread = spread_of(q2);
  LogColumns log;
  log.add("time_s", rows_of(motion.t));
  log.add("axis0/q1_rad", counted(rows_of(motion.q), 1e-4 * amplitude));
  log.add("axis0/q2_rad", counted(q2 + draw.normal(q2.size(), spread * draw.in_ratio(0.0015, 0.012)),
                                  spread * draw.in_ratio(1e-4, 3e-3)));
  if (joint.torque.size() > 0) {
    const ArrayXd torque = rows_of(joint.torque);
    log.add("axis0/tau_Nm", torque + draw.normal(torque.size(), 0.02 * spread_of(torque)));
  }
  if (joint.other.size() > 0) {
    log.add("axis1/q1_rad", rows_of(joint.other));
  }
  return log;
}

auto axis_log(Draw& draw, AxisKind kind, MotionKind moves) -> LogColumns {
  const double period_s = 1.0 / draw.one_of(std::array{50.0, 100.0, 250.0, 500.0});
  const double seconds = draw(15.0, 45.0);
  const double amplitude = draw(0.5, 2.5);
  const Motion motion = motion_of(draw, moves, seconds, period_s, amplitude);
  const double friction = draw(0.3, 1.0);
  const double drag = draw(0.1, 0.8) / motion.top_speed;
  const AxisDraw axis{draw, motion, (motion.v / (0.01 * motion.top_speed)).tanh(), friction, drag};
  const ArrayXd inertia = draw(0.05, 0.6) / motion.a.abs().maxCoeff() * motion.a;
  const ArrayXd effort = rows_of(inertia + kind(axis));
  LogColumns log;
  log.add("time_s", rows_of(motion.t));
  log.add("axis0/q1_rad", counted(rows_of(motion.q), 5e-5 * amplitude));
  log.add("axis0/tau_Nm", effort + draw.normal(effort.size(), spread_of(effort) * draw.in_ratio(0.01, 0.08)));
  return log;
}

auto columns_of(const DriveLog& drive) -> LogColumns {
  LogColumns log;
  log.add("time_s", drive.time_s);
  log.add("axis0/q1_rad", drive.motor_angle);
  log.add("axis0/tau_Nm", drive.effort);
  if (drive.output_torque.size() > 0) {
    log.add("axis0/tau_out_Nm", drive.output_torque);
  }
  return log;
}

}  // namespace

auto drawn_machines(std::uint64_t seed) -> std::vector<DrawnMachine> {
  Draw draw(seed);
  std::vector<DrawnMachine> machines;
  const auto add_log = [&](const char* kind, const char* moves, const LogColumns& log) {
    machines.push_back(machine_of(std::string(kind) + "_" + moves + "_" + std::to_string(seed), log));
  };
  std::size_t next = seed % kMotions.size();
  const auto add = [&](const char* kind, auto make) {
    const auto& [moves, motion] = kMotions[next++ % kMotions.size()];
    add_log(kind, moves, make(motion));
  };
  for (const auto& [name, kind] : kJoints) {
    add(name, [&draw, make = kind](MotionKind motion) { return joint_log(draw, make, motion); });
  }
  for (const auto& [name, kind] : kAxes) {
    add(name, [&draw, make = kind](MotionKind motion) { return axis_log(draw, make, motion); });
  }
  for (const auto& [moves, goal] : kGoals) {
    add_log("servo", moves, columns_of(servo_log(draw, goal)));
  }
  for (const auto& [moves, turn] : kTurns) {
    add_log("gear", moves, columns_of(gear_log(draw, turn)));
  }
  return machines;
}

void write_machines(const std::string& folder, const std::vector<DrawnMachine>& machines, int digits) {
  for (const auto& machine : machines) {
    std::ofstream file(folder + "/" + machine.name + ".csv");
    for (std::size_t i = 0; i < machine.columns.size(); ++i) {
      file << (i > 0 ? "," : "") << machine.columns[i];
    }
    file << "\n" << machine.rows.format(Eigen::IOFormat(digits, Eigen::DontAlignCols, ",", "\n")) << "\n";
  }
}

}  // namespace capstan::tools::machines
