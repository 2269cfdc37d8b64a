// SPDX-License-Identifier: Apache-2.0
#include "capstan/tests/tools/blind/blind_axis.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <numbers>

#include "capstan/tests/tools/blind/blind_world.hpp"

namespace capstan::tools::blind {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kVisibleShare = 0.03;

/// The world of an axis, and what its motion alone asks for.
struct Axis {
  World w;
  Signal acceleration, rigid;
  double inertia = 0.0, drag = 0.0;
  double hangs_at = 0.0;  ///< the weight is nothing there, rad
};

auto rms(const Signal& signal) -> double {
  return std::sqrt(signal.square().mean());
}

auto slope(const Signal& signal) -> Signal {
  Signal result = Signal::Zero(signal.size());
  const Eigen::Index inner = signal.size() - 2;
  result.segment(1, inner) = (signal.tail(inner) - signal.head(inner)) / (2.0 * kStep);
  return result;
}

auto axis_of(const Case& c, Draw& draw) -> Axis {
  Axis axis;
  axis.w = world_of(c, draw);
  axis.acceleration = slope(axis.w.speed);
  axis.inertia = draw.ratio_between(0.005, 0.1);
  // Some axes have next to no drag, some little but drag.
  axis.drag = axis.inertia * rms(axis.acceleration) / rms(axis.w.speed) * draw.ratio_between(0.1, 5.0);
  axis.rigid = axis.inertia * axis.acceleration + axis.drag * axis.w.speed;
  axis.hangs_at = draw.between(0.0, 2.0 * kPi);
  return axis;
}

/// A slider dragged along behind a slack, by a spring that gives way at one.
auto slack_slider(const Signal& path, double way, double slack) -> Signal {
  Signal force(path.size());
  double spring = 0.0;
  for (Eigen::Index i = 0; i < path.size(); ++i) {
    spring = std::clamp(spring + (i > 0 ? path[i] - path[i - 1] : 0.0) / way, -1.0, 1.0);
    force[i] = std::copysign(std::max(0.0, std::abs(spring) - slack) / (1.0 - slack), spring);
  }
  return force;
}

auto random_walk(Eigen::Index steps, Draw& draw) -> Signal {
  Signal walk(steps);
  double x = 0.0;
  for (double& value : walk) {
    x += draw.normal();
    value = x;
  }
  return walk;
}

/// Pulls back to a rest that may be anywhere in the motion; hardens, or does not.
auto spring_of(const Axis& axis, Draw& draw) -> Signal {
  const Signal away = axis.w.q / axis.w.q_span - draw.between(-0.5, 0.5);
  const double hardening = draw.one_of(2) == 0 ? 0.0 : draw.between(2.0, 10.0);
  return away + hardening * away.cube();
}

/// Drag by a power of the speed: grease that thins, or what is churned.
auto power_law_of(const Axis& axis, Draw& draw) -> Signal {
  const double exponent = draw.one_of(2) == 0 ? draw.between(0.2, 0.6) : draw.between(1.6, 3.0);
  return axis.w.sign * (axis.w.speed.abs() / rms(axis.w.speed)).pow(exponent);
}

auto delayed(const Signal& signal, double delay_s) -> Signal {
  const auto steps = static_cast<Eigen::Index>(std::lround(delay_s / kStep));
  Signal late(signal.size());
  late.head(steps).setConstant(signal[0]);
  late.tail(signal.size() - steps) = signal.head(signal.size() - steps);
  return late;
}

/// Rms size is free, but for effects that say what they do to the rigid effort.
using Effort = std::function<Signal(const Axis&, Draw&)>;

auto named_efforts() -> const std::map<std::string, Effort>& {
  static const std::map<std::string, Effort> kEfforts = {
      {"coulomb_friction", [](const Axis& a, Draw&) { return a.w.sign; }},
      {"friction_asymmetry",
       [](const Axis& a, Draw& d) {
         const double speed = rms(a.w.speed);
         return Signal(by_direction(a.w, 1.0, 0.0) * (d.between(-1.0, 1.0) + a.w.speed / speed));
       }},
      {"stribeck_friction",
       [](const Axis& a, Draw& d) {
         const double speed = d.between(0.1, 0.4) * rms(a.w.speed);
         return Signal(a.w.sign * (-(a.w.speed / speed).square()).exp());
       }},
      {"play_friction",
       [](const Axis& a, Draw& d) {
         const double way = d.ratio_between(0.01, 0.06) * a.w.q_span;
         if (d.one_of(2) == 0) {
           return slack_slider(a.w.q, way, d.between(0.2, 0.7));
         }
         return Signal(bristle(a.w.q, way) / way);
       }},
      {"offset", [](const Axis& a, Draw&) { return Signal(Signal::Ones(a.w.q.size())); }},
      {"gravity", [](const Axis& a, Draw&) { return Signal((a.w.q - a.hangs_at).sin()); }},
      {"load_friction",  // of a gear that carries the weight
       [](const Axis& a, Draw&) { return Signal(a.w.sign * (a.w.q - a.hangs_at).sin().abs()); }},
      {"power_law_friction", power_law_of},
      {"spring", spring_of},
      {"angle_periodic",
       [](const Axis& a, Draw& d) {
         return Signal((std::round(d.between(4.0, 24.0)) * a.w.q + d.between(0.0, 6.0)).sin());
       }},
      {"axis_coupling",
       [](const Axis& a, Draw& d) {
         return d.one_of(2) == 0 ? Signal(a.w.other_q + d.between(0.0, 2.0) * a.w.other_tau) : slope(a.w.other_q);
       }},
      {"thermal_drift",
       [](const Axis& a, Draw& d) {
         return d.one_of(2) == 0 ? Signal(1.0 - (-a.w.time / (d.between(0.2, 0.8) * a.w.duration)).exp())
                                 : Signal(a.w.temperature - a.w.temperature[0]);
       }},
      {"transport_delay",
       [](const Axis& a, Draw& d) { return Signal(delayed(a.rigid, d.between(0.004, 0.02)) - a.rigid); }},
  };
  return kEfforts;
}

auto nameless_efforts() -> const std::map<std::string, Effort>& {
  static const std::map<std::string, Effort> kEfforts = {
      {"dead_zone",  // of the sensor: what is below it is not seen
       [](const Axis& a, Draw& d) {
         const double zone = d.between(0.2, 0.8) * rms(a.rigid);
         return Signal(-a.rigid.max(-zone).min(zone));
       }},
      {"effort_friction", [](const Axis& a, Draw&) { return Signal(a.w.sign * a.rigid.abs()); }},
      {"place_friction",
       [](const Axis& a, Draw& d) {
         return Signal(a.w.sign * (2.0 * kPi * a.w.q / a.w.q_span * d.between(0.7, 1.5) + d.between(0.0, 6.0)).sin());
       }},
      {"log_drag",
       [](const Axis& a, Draw& d) {
         const double speed = d.ratio_between(0.02, 0.5) * rms(a.w.speed);
         return Signal(a.w.sign * (1.0 + a.w.speed.abs() / speed).log());
       }},
      {"random_walk", [](const Axis& a, Draw& d) { return random_walk(a.w.q.size(), d); }},
      {"sticky_spot",
       [](const Axis& a, Draw& d) {
         return Signal(a.w.sign * (-((a.w.q - d.between(-0.4, 0.4)) / 0.2).square()).exp());
       }},
      {"relaxation",
       [](const Axis& a, Draw& d) { return Signal(a.w.q - low_passed(a.w.q, d.ratio_between(0.2, 2.0))); }},
      {"swinging_load",
       [](const Axis& a, Draw& d) { return Signal(a.acceleration * (a.w.q + d.between(0.0, 2.0 * kPi)).cos()); }},
      {"running_in", [](const Axis& a, Draw&) { return Signal(a.w.sign * (a.w.time / a.w.duration - 0.5)); }},
  };
  return kEfforts;
}

/// What is left of an effect when inertia, drag and the columns beside have taken what they can.
auto outside(const Axis& axis, const std::vector<Signal>& beside, const Signal& effect) -> Signal {
  Eigen::MatrixXd base(effect.size(), 2 + static_cast<Eigen::Index>(beside.size()));
  base.col(0) = axis.acceleration;
  base.col(1) = axis.w.speed;
  for (std::size_t i = 0; i < beside.size(); ++i) {
    base.col(2 + static_cast<Eigen::Index>(i)) = beside[i];
  }
  const Eigen::VectorXd theta = (base.transpose() * base).ldlt().solve(base.transpose() * effect.matrix());
  return effect - (base * theta).array();
}

/// Whether an effect changes the rigid effort itself, so that its size is given by its form.
auto has_own_size(const std::string& name) -> bool {
  return name == "dead_zone" || name == "transport_delay";
}

struct Efforts {
  Signal sum;                                                ///< rigid and all effects
  double weakest = std::numeric_limits<double>::infinity();  ///< rms outside the base law
  bool visible = true;
};

auto efforts_of(const Case& c, const Axis& axis, Draw& draw) -> Efforts {
  Efforts efforts;
  efforts.sum = axis.rigid;
  std::vector<Signal> beside;
  for (const auto& name : c.truths) {
    const auto found = named_efforts().find(name);
    Signal effect = (found != named_efforts().end() ? found->second : nameless_efforts().at(name))(axis, draw);
    if (!has_own_size(name)) {
      effect *= draw.ratio_between(0.1, 0.6) * rms(axis.rigid) / rms(effect);
    }
    if (name == "friction_asymmetry" ||
        name == "spring") {  // a level beside Coulomb's, or a rest, is an offset as well
      beside.push_back(Signal::Ones(effect.size()));
    }
    const double own = rms(outside(axis, beside, effect));
    efforts.visible = efforts.visible && own > kVisibleShare * rms(effect);
    efforts.weakest = std::min(efforts.weakest, own);
    efforts.sum += effect;
    beside.push_back(effect);
  }
  return efforts;
}

auto coloured_noise(Eigen::Index rows, double period_s, Draw& draw) -> Eigen::VectorXd {
  const double memory = std::exp(-period_s / draw.ratio_between(0.01, 0.15));
  const double share = draw.between(0.0, 0.8);
  Eigen::VectorXd noise(rows);
  double coloured = draw.normal();
  for (double& value : noise) {
    coloured = memory * coloured + std::sqrt(1.0 - memory * memory) * draw.normal();
    value = std::sqrt(share) * coloured + std::sqrt(1.0 - share) * draw.normal();
  }
  return noise;
}

}  // namespace

auto listed_efforts() -> const std::vector<std::vector<std::string>>& {
  static const std::vector<std::vector<std::string>> kTruths = [] {
    std::vector<std::vector<std::string>> truths;
    for (const auto& entry : named_efforts()) {
      const std::string& name = entry.first;
      truths.push_back({name});
      if (name == "friction_asymmetry" || name == "stribeck_friction") {
        truths.back().insert(truths.back().begin(), "coulomb_friction");
      } else if (name == "load_friction") {
        truths.back().insert(truths.back().begin(), "gravity");
      }
    }
    return truths;
  }();
  return kTruths;
}

auto unlisted_efforts() -> const std::vector<std::string>& {
  static const std::vector<std::string> kNames = [] {
    std::vector<std::string> names;
    for (const auto& entry : nameless_efforts()) {
      names.push_back(entry.first);
    }
    return names;
  }();
  return kNames;
}

auto blind_axis(const Case& c) -> BlindAxis {
  Draw draw(c.seed);
  const Axis axis = axis_of(c, draw);
  const Efforts efforts = efforts_of(c, axis, draw);
  constexpr std::array<Eigen::Index, 4> kEvery = {1, 2, 5, 10};
  const Eigen::Index every = kEvery[static_cast<std::size_t>(draw.one_of(4))];
  const double step = 2.0 * kPi / draw.ratio_between(16384.0, 1e6);
  constexpr Eigen::Index kEdge = 10;  // speed and acceleration jump at the world's ends, where they have one neighbour
  const Eigen::Index rows = (axis.w.q.size() - 2 * kEdge) / every;
  const double noise =
      c.truths.empty() ? draw.ratio_between(0.005, 0.05) * rms(axis.rigid) : efforts.weakest / c.strength;
  BlindAxis blind;
  blind.noise = noise * coloured_noise(rows, kStep * static_cast<double>(every), draw);
  blind.visible = efforts.visible;
  blind.inertia = axis.inertia;
  blind.drag = axis.drag;
  AxisLog& log = blind.log;
  log.name = "blind";
  log.target = "axis0/tau_Nm";
  log.period_s = kStep * static_cast<double>(every);
  const auto seen = [&](const Signal& signal) -> Eigen::VectorXd {
    return signal(Eigen::seqN(kEdge, rows, every)).matrix();
  };
  const auto to_step = [step](double angle) { return std::round(angle / step) * step; };
  log.time_s = seen(axis.w.time);
  blind.angle = seen(axis.w.q);
  log.q1_rad = blind.angle.unaryExpr(to_step);
  log.tau_nm = Eigen::VectorXd::Zero(rows);
  log.effort = seen(efforts.sum) + blind.noise;
  log.temperature_c = seen(axis.w.temperature).unaryExpr([&draw](double t) { return t + 0.05 * draw.normal(); });
  log.others = {OtherAxis{1, seen(axis.w.other_q).unaryExpr(to_step), seen(axis.w.other_tau)}};
  log.side = {{"temperature_C", log.temperature_c},
              {"axis1/q1_rad", log.others[0].q1_rad},
              {"axis1/tau_Nm", log.others[0].tau_nm}};
  return blind;
}

}  // namespace capstan::tools::blind
