// SPDX-License-Identifier: Apache-2.0
#include "capstan/tests/tools/blind/blind_effects.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace capstan::tools::blind {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr const char* kDelay = "transport_delay";
constexpr double kUnitDelayS = 0.004;

auto play(const Signal& input, double half_width) -> Signal {
  Signal output(input.size());
  double p = input[0];
  for (Eigen::Index i = 0; i < input.size(); ++i) {
    p = std::clamp(p, input[i] - half_width, input[i] + half_width);
    output[i] = p;
  }
  return output;
}

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

/// How far a mass on a spring stays away from where it is pulled.
auto swing(const Signal& pulled, double frequency_hz, double damping) -> Signal {
  const double w = 2.0 * kPi * frequency_hz;
  Signal away(pulled.size());
  double place = pulled[0];
  double speed = 0.0;
  for (Eigen::Index i = 0; i < pulled.size(); ++i) {
    speed += kStep * w * (w * (pulled[i] - place) - 2.0 * damping * speed);
    place += kStep * speed;
    away[i] = place - pulled[i];
  }
  return away;
}

/// Steps up or down at times that nobody knows.
auto lost_counts(const World& w, Draw& draw) -> Signal {
  Signal steps = Signal::Zero(w.time.size());
  for (int k = 0; k < 4; ++k) {
    const double at = draw.between(0.05, 0.95) * w.duration;
    const double sign = draw.one_of(3) == 0 ? -1.0 : 1.0;
    steps += sign * (w.time > at).cast<double>();
  }
  return steps;
}

}  // namespace

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
      {kDelay, [](const World& w, Draw&) { return Signal(late(w.joint, kUnitDelayS) - w.joint); }},
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
      {"speed_squared", [](const World& w, Draw&) { return Signal(w.speed.square()); }},
      {"one_sided_gap",
       [](const World& w, Draw& d) { return Signal((w.tau - d.between(0.1, 0.5) * w.tau.abs().maxCoeff()).max(0.0)); }},
      {"swing", [](const World& w, Draw& d) { return swing(w.joint, d.between(2.5, 8.0), d.between(0.1, 0.4)); }},
      {"lost_counts", lost_counts},
      {"slanted_friction", [](const World& w, Draw&) { return Signal(w.sign * w.q); }},
  };
  return kEffects;
}

auto sized(const std::string& name, const World& w, const Signal& unit, double size) -> Signal {
  return name == kDelay ? Signal(late(w.joint, size * kUnitDelayS) - w.joint) : Signal(size * unit);
}

auto effect_of(const std::string& name) -> const Effect& {
  const auto& named = listed();
  const auto found = named.find(name);
  return found != named.end() ? found->second : unlisted().at(name);
}

}  // namespace capstan::tools::blind
