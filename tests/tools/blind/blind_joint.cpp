// SPDX-License-Identifier: Apache-2.0
#include "tests/tools/blind/blind_joint.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <random>

namespace capstan::tools::blind {
namespace {

using Signal = Eigen::ArrayXd;
constexpr double kPi = std::numbers::pi;
constexpr double kStep = 0.001;  // s, of the made-up world

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
  double beta = 1.0;
  double tau_span = 1.0, q_span = 1.0, duration = 1.0;
};

/// Points of rest from one to the next along half a cosine, with a short hold at each.
auto swings(const Signal& time, double cycle_s, const std::vector<double>& points, const std::vector<double>& lengths)
    -> Signal {
  double total = 0.0;
  for (const double length : lengths) {
    total += 1.15 * length;
  }
  Signal q(time.size());
  for (Eigen::Index i = 0; i < time.size(); ++i) {
    double left = std::fmod(time[i], cycle_s) / cycle_s * total;
    std::size_t k = 0;
    while (k + 1 < lengths.size() && left >= 1.15 * lengths[k]) {
      left -= 1.15 * lengths[k];
      ++k;
    }
    const double share = std::min(1.0, left / lengths[k]);
    const double next = points[(k + 1) % points.size()];
    q[i] = points[k] + (next - points[k]) * 0.5 * (1.0 - std::cos(kPi * share));
  }
  return q;
}

auto sines(const Signal& time, double cycle_s, const std::vector<int>& harmonics, double slope, Draw& draw) -> Signal {
  Signal q = Signal::Zero(time.size());
  for (const int h : harmonics) {
    const double phase = draw.between(0.0, 2.0 * kPi);
    q += std::pow(static_cast<double>(h), slope) * (2.0 * kPi * h / cycle_s * time + phase).sin();
  }
  return q;
}

auto triangles(const Signal& time, double cycle_s, int wealth, Draw& draw) -> Signal {
  std::vector<double> points = {0.0};
  std::vector<double> lengths;
  for (const double speed : {0.2, 0.5, 1.2, 3.0}) {
    for (int k = 0; k < 2 * wealth; ++k) {
      points.push_back((points.size() % 2 == 1 ? 1.0 : -1.0) * draw.between(0.4, 1.2));
      lengths.push_back(std::abs(points.back() - points[points.size() - 2]) / speed);
    }
  }
  lengths.push_back(std::abs(points.back()));
  double total = 0.0;
  for (const double length : lengths) {
    total += length;
  }
  Signal q(time.size());
  for (Eigen::Index i = 0; i < time.size(); ++i) {
    double left = std::fmod(time[i], cycle_s) / cycle_s * total;
    std::size_t k = 0;
    while (k + 1 < lengths.size() && left >= lengths[k]) {
      left -= lengths[k];
      ++k;
    }
    const double next = k + 1 < points.size() ? points[k + 1] : points[0];
    q[i] = points[k] + (next - points[k]) * std::min(1.0, left / lengths[k]);
  }
  return q;
}

auto low_passed(const Signal& input, double time_s) -> Signal {
  const double share = 1.0 - std::exp(-kStep / time_s);
  Signal output(input.size());
  double x = input[0];
  for (Eigen::Index i = 0; i < input.size(); ++i) {
    x += (input[i] - x) * share;
    output[i] = x;
  }
  return output;
}

auto slope_of(const Signal& signal) -> Signal {
  Signal slope = Signal::Zero(signal.size());
  for (Eigen::Index i = 1; i + 1 < signal.size(); ++i) {
    slope[i] = (signal[i + 1] - signal[i - 1]) / (2.0 * kStep);
  }
  return slope;
}

/// A motor that can not jump: what is asked for, through two lags.
/// `wealth`: how many cycles' worth of different motion one cycle has.
auto motor_motion(const Case& c, const Signal& time, double cycle_s, int wealth, Draw& draw) -> Signal {
  Signal wanted;
  switch (c.motion) {
    case Motion::kSine:
      wanted = (2.0 * kPi * std::round(cycle_s / draw.between(3.0, 8.0)) / cycle_s * time).sin();
      break;
    case Motion::kMultisine:
      wanted = wealth == 1 ? sines(time, cycle_s, {2, 3, 5, 8, 13, 21, 34}, -0.5, draw) * 0.6
                           : sines(time, cycle_s, {7, 13, 19, 33, 53, 85, 137}, -0.5, draw) * 1.2;
      break;
    case Motion::kLadder: {
      std::vector<double> points = {0.0};
      std::vector<double> lengths;
      for (int k = 0; k < 10 * wealth; ++k) {
        const double next = k == 10 * wealth - 1 ? 0.0 : (k % 2 == 0 ? 1.0 : -1.0) * draw.between(0.05, 1.2);
        lengths.push_back(draw.ratio_between(0.3, 2.0));
        points.push_back(next);
      }
      wanted = swings(time, cycle_s, points, lengths);
      break;
    }
    case Motion::kTriangles:
      wanted = triangles(time, cycle_s, wealth, draw);
      break;
  }
  return low_passed(low_passed(wanted, 0.03), 0.03);
}

void remember_turns(World& w) {
  w.sign.resize(w.q.size());
  w.tau_turned.resize(w.q.size());
  double sign = 1.0;
  double turned = w.tau[0];
  for (Eigen::Index i = 0; i < w.q.size(); ++i) {
    const double now = std::abs(w.speed[i]) < 1e-7 ? sign : (w.speed[i] > 0.0 ? 1.0 : -1.0);
    if (now != sign) {
      turned = w.tau[i];
      sign = now;
    }
    w.sign[i] = sign;
    w.tau_turned[i] = turned;
  }
}

/// Dahl's bristle over a path, in rad.
auto bristle(const Signal& path, double width) -> Signal {
  Signal z(path.size());
  double state = 0.0;
  for (Eigen::Index i = 0; i < path.size(); ++i) {
    const double step = i > 0 ? path[i] - path[i - 1] : 0.0;
    state += step - std::abs(step) * state / width;
    z[i] = state;
  }
  return z;
}

auto play(const Signal& input, double half_width) -> Signal {
  Signal output(input.size());
  double p = input[0];
  for (Eigen::Index i = 0; i < input.size(); ++i) {
    p = std::clamp(p, input[i] - half_width, input[i] + half_width);
    output[i] = p;
  }
  return output;
}

/// `top` where the motor goes forward, `bottom` elsewhere.
auto by_direction(const World& w, double top, double bottom) -> Signal {
  return 0.5 * (top + bottom) + 0.5 * (top - bottom) * w.sign;
}

using Effect = std::function<Signal(const World&, Draw&)>;

auto slip(const World& w, Draw& draw) -> Signal {
  const double scale = draw.between(0.08, 0.25) * w.tau_span;
  const int form = draw.one_of(3);
  if (form == 2) {  // a front that works its way along: friction elements in a row
    constexpr int kElements = 60;
    Signal lag = Signal::Zero(w.tau.size());
    for (int k = 0; k < kElements; ++k) {
      lag += (play(w.tau, scale * (k + 0.5) / kElements) - w.tau) / kElements;
    }
    return -lag;
  }
  const Signal since = (w.tau - w.tau_turned).abs();
  const Signal share =
      form == 0 ? Signal((-since / scale).exp()) : Signal((1.0 - since / (2.0 * scale)).max(0.0).square());
  return by_direction(w, 1.0, 0.8) * w.tau * share;
}

auto late(const Signal& signal, double delay_s) -> Signal {
  Signal result(signal.size());
  for (Eigen::Index i = 0; i < signal.size(); ++i) {
    const double at = std::max(0.0, static_cast<double>(i) - delay_s / kStep);
    const auto whole = static_cast<Eigen::Index>(at);
    const double part = at - static_cast<double>(whole);
    result[i] = signal[whole] + part * (signal[std::min(whole + 1, signal.size() - 1)] - signal[whole]);
  }
  return result;
}

auto listed() -> const std::map<std::string, Effect>& {
  static const std::map<std::string, Effect> kEffects = {
      {"transmission_viscous",
       [](const World& w, Draw& d) { return Signal(-by_direction(w, 1.0, d.between(1.3, 2.0)) * w.speed); }},
      {"pretension_offset", [](const World& w, Draw&) { return w.sign; }},
      {"reversal_memory",
       [](const World& w, Draw& d) { return Signal(by_direction(w, 1.0, d.between(0.6, 1.4)) * w.tau_turned); }},
      {"slip_propagation", slip},
      {"play", [](const World& w, Draw& d) { return Signal(play(w.q, d.ratio_between(0.008, 0.05)) - w.q); }},
      {"presliding", [](const World& w, Draw& d) { return Signal(-bristle(w.q, d.ratio_between(0.03, 0.2))); }},
      {"gravity", [](const World& w, Draw& d) { return Signal((w.joint + d.between(0.0, 2.0 * kPi)).sin()); }},
      {"axis_coupling", [](const World& w, Draw& d) { return Signal(w.other_q + d.between(0.0, 2.0) * w.other_tau); }},
      {"viscoelastic_creep",
       [](const World& w, Draw& d) { return Signal(-low_passed(w.tau, d.ratio_between(0.4, 4.0))); }},
      {"thermal_drift",
       [](const World& w, Draw& d) {
         return d.one_of(2) == 0 ? Signal(1.0 - (-w.time / (d.between(0.2, 0.8) * w.duration)).exp())
                                 : Signal(w.temperature - w.temperature[0]);
       }},
      {"angle_periodic",
       [](const World& w, Draw& d) {
         constexpr std::array<double, 5> kOrders = {3.0, 5.0, 8.0, 14.0, 24.0};
         return Signal((kOrders[static_cast<std::size_t>(d.one_of(5))] * w.q + d.between(0.0, 6.0)).sin());
       }},
      {"transport_delay", [](const World& w, Draw&) { return Signal(late(w.joint, 0.004) - w.joint); }},
      {"stiffness_hardening",
       [](const World& w, Draw& d) {
         return Signal(by_direction(w, 1.0, d.between(0.7, 1.3)) *
                       (d.one_of(2) == 0 ? Signal(w.tau * w.tau.abs()) : Signal(w.tau.cube())));
       }},
      {"load_inertia", [](const World& w, Draw&) { return Signal(-w.acceleration); }},
  };
  return kEffects;
}

auto unlisted() -> const std::map<std::string, Effect>& {
  static const std::map<std::string, Effect> kEffects = {
      {"torque_ripple",
       [](const World& w, Draw& d) { return Signal(w.tau * (5.0 * w.q + d.between(0.0, 6.0)).sin()); }},
      {"sticky_spot",
       [](const World& w, Draw& d) {
         return Signal(-w.sign * (-((w.q - d.between(-0.4, 0.4)) / 0.15).square()).exp());
       }},
      {"rate_ripple", [](const World& w, Draw&) { return Signal((3.0 * w.q).sin() * w.speed); }},
      {"wear", [](const World& w, Draw&) { return Signal(w.tau * (w.time / w.duration - 0.5)); }},
      {"knock",
       [](const World& w, Draw& d) { return Signal((w.time > d.between(0.3, 0.7) * w.duration).cast<double>()); }},
      {"root_drag", [](const World& w, Draw&) { return Signal(-w.sign * w.speed.abs().sqrt()); }},
      {"coupled_stiffness", [](const World& w, Draw&) { return Signal(w.other_q * w.tau); }},
      {"bent_drum", [](const World& w, Draw&) { return Signal((w.q - 0.2).max(0.0)); }},
  };
  return kEffects;
}

auto effect_of(const std::string& name) -> const Effect& {
  const auto& named = listed();
  const auto found = named.find(name);
  return found != named.end() ? found->second : unlisted().at(name);
}

/// What is left of an effect when ratio, offset and both elongations have taken what they can.
auto outside_base(const World& w, const Signal& effect) -> Signal {
  Eigen::MatrixXd base(w.q.size(), 4);
  base << w.q, Signal::Ones(w.q.size()), w.tau * (w.sign > 0.0).cast<double>(), w.tau * (w.sign < 0.0).cast<double>();
  const Eigen::VectorXd theta = (base.transpose() * base).ldlt().solve(base.transpose() * effect.matrix());
  return effect - (base * theta).array();
}

auto world_of(const Case& c, Draw& draw) -> World {
  World w;
  const double cycle_s = draw.between(18.0, 30.0);
  w.duration = 4.0 * cycle_s;
  const auto steps = static_cast<Eigen::Index>(w.duration / kStep);
  w.time = Signal::LinSpaced(steps, 0.0, static_cast<double>(steps - 1) * kStep);
  const double repeated_s = c.repeats ? cycle_s : w.duration;
  w.q = motor_motion(c, w.time, repeated_s, c.repeats ? 1 : 4, draw);
  w.q *= draw.between(0.8, 1.6);
  w.speed = slope_of(w.q);
  w.acceleration = low_passed(slope_of(w.speed), 0.005);
  w.other_q = sines(w.time, repeated_s, {3, 7, 11}, -0.3, draw) * 0.5;
  w.other_tau = 0.05 * w.other_q + 0.02 * (slope_of(w.other_q) / 0.05).tanh();
  const Signal load = draw.between(0.01, 0.03) * sines(w.time, repeated_s, {3, 7}, 0.0, draw);
  w.tau = draw.between(0.02, 0.05) * w.q + draw.between(0.015, 0.03) / 0.01 * bristle(w.q, 0.01) +
          draw.between(0.002, 0.005) * w.speed + load;
  w.temperature = 22.0 + draw.between(5.0, 15.0) * (1.0 - (-w.time / (draw.between(0.3, 1.0) * w.duration)).exp());
  remember_turns(w);
  w.beta = draw.between(0.8, 1.3);
  w.joint = w.beta * w.q + draw.between(-0.1, 0.1) +
            by_direction(w, -draw.between(0.6, 1.0), -draw.between(0.4, 0.8)) * w.tau;
  w.tau_span = w.tau.maxCoeff() - w.tau.minCoeff();
  w.q_span = w.q.maxCoeff() - w.q.minCoeff();
  return w;
}

/// Of the torque's span.
auto torque_noise_of(const Case& drawn) -> double {
  return Draw(drawn.seed + 78).between(0.0, 0.006);
}

}  // namespace

auto motion_name(Motion motion) -> const char* {
  constexpr std::array<const char*, 4> kNames = {"sine", "multisine", "ladder", "triangles"};
  return kNames[static_cast<std::size_t>(motion)];
}

auto listed_effects() -> const std::vector<std::string>& {
  static const std::vector<std::string> kNames = [] {
    std::vector<std::string> names;
    for (const auto& entry : listed()) {
      names.push_back(entry.first);
    }
    return names;
  }();
  return kNames;
}

auto unlisted_effects() -> const std::vector<std::string>& {
  static const std::vector<std::string> kNames = [] {
    std::vector<std::string> names;
    for (const auto& entry : unlisted()) {
      names.push_back(entry.first);
    }
    return names;
  }();
  return kNames;
}

auto noise_of(const Case& drawn) -> double {
  return Draw(drawn.seed + 77).ratio_between(0.0004, 0.002);
}

auto floor_of(const Case& drawn, const AxisLog& log) -> double {
  constexpr double kTypicalElongation = 0.7;  // rad/Nm: noise of the torque comes through the best law of all
  return std::hypot(noise_of(drawn),
                    kTypicalElongation * torque_noise_of(drawn) * (log.tau_nm.maxCoeff() - log.tau_nm.minCoeff()));
}

auto blind_log(const Case& c) -> AxisLog {
  Draw draw(c.seed);
  World w = world_of(c, draw);
  const double noise = noise_of(c);
  Signal joint = w.joint;
  for (const auto& name : c.truths) {
    const Signal effect = effect_of(name)(w, draw);
    const Signal seen = outside_base(w, effect);
    joint += effect * (c.strength * noise / std::sqrt(seen.square().mean()));
  }
  constexpr std::array<int, 4> kEvery = {1, 2, 5, 10};
  const int every = kEvery[static_cast<std::size_t>(draw.one_of(4))];
  const double step = 2.0 * kPi / draw.ratio_between(8192.0, 160000.0);
  const double torque_noise = torque_noise_of(c) * w.tau_span;
  const double memory = std::exp(-kStep * every / draw.ratio_between(0.01, 0.15));
  const double coloured_share = draw.between(0.0, 0.8);
  AxisLog log;
  log.name = "blind";
  log.target = "axis0/q2_rad";
  log.period_s = kStep * every;
  log.has_torque = true;
  const Eigen::Index rows = w.q.size() / every;
  for (Eigen::VectorXd* signal : {&log.time_s, &log.q1_rad, &log.tau_nm, &log.q2_rad}) {
    signal->resize(rows);
  }
  OtherAxis other{1, Eigen::VectorXd(rows), Eigen::VectorXd(rows)};
  log.temperature_c.resize(rows);
  double coloured = draw.normal();
  for (Eigen::Index i = 0; i < rows; ++i) {
    const Eigen::Index at = i * every;
    coloured = memory * coloured + std::sqrt(1.0 - memory * memory) * draw.normal();
    log.time_s[i] = w.time[at];
    log.q1_rad[i] = std::round(w.q[at] / step) * step;
    log.tau_nm[i] = w.tau[at] + torque_noise * draw.normal();
    log.q2_rad[i] =
        joint[at] + noise * (std::sqrt(coloured_share) * coloured + std::sqrt(1.0 - coloured_share) * draw.normal());
    other.q1_rad[i] = std::round(w.other_q[at] / step) * step;
    other.tau_nm[i] = w.other_tau[at];
    log.temperature_c[i] = w.temperature[at] + 0.05 * draw.normal();
  }
  log.side = {{"temperature_C", log.temperature_c}, {"axis1/q1_rad", other.q1_rad}, {"axis1/tau_Nm", other.tau_nm}};
  log.other = std::move(other);
  return log;
}

}  // namespace capstan::tools::blind
