// SPDX-License-Identifier: Apache-2.0
#include "capstan/hal/sim/pulley_line.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>

namespace capstan::sim {
namespace {

constexpr double kPi = 3.14159265358979323846;
// Of the largest step that is stable: symplectic Euler's own error in frequency is then below 1 % for the stiffest
// mode.
constexpr double kStepShare = 0.5;
constexpr double kMostStepsPerSecond = 2e7;
constexpr int kRounds = 60;

auto text_of(double value) -> std::string {
  char text[32];
  std::snprintf(text, sizeof(text), "%.6g", value);
  return text;
}

void require(double value, const char* name, double low, double high) {
  if (!(value >= low && value <= high)) {
    throw std::invalid_argument(std::string(name) + " = " + text_of(value) + " is out of range; it must be from " +
                                text_of(low) + " to " + text_of(high));
  }
}

void check(const PulleyLineParameters& p) {
  require(p.axial_stiffness_n, "axial_stiffness_n", 10.0, 1e7);
  require(p.mass_kg_per_m, "mass_kg_per_m", 1e-5, 10.0);
  require(p.damping_s, "damping_s", 0.0, 1e-3);
  require(p.preload_n, "preload_n", 0.0, 0.02 * p.axial_stiffness_n);
  require(p.nodes_per_pulley, "nodes_per_pulley", 2, 256);
  require(p.load_mass_kg, "load_mass_kg", 1e-4, 1e3);
  require(p.load_stiffness_n_per_m, "load_stiffness_n_per_m", 0.0, 1e7);
  require(p.load_damping_ns_per_m, "load_damping_ns_per_m", 0.0, 1e5);
  require(static_cast<double>(p.pulleys.size()), "the number of pulleys", 1, 32);
  if (p.spans_m.size() != p.pulleys.size() + 1) {
    throw std::invalid_argument("spans_m has " + std::to_string(p.spans_m.size()) + " lengths; " +
                                std::to_string(p.pulleys.size()) + " pulleys have " +
                                std::to_string(p.pulleys.size() + 1) + " spans before, between and behind them");
  }
  for (const double span : p.spans_m) {
    require(span, "a span in m", 1e-3, 10.0);
  }
  for (const PulleyParameters& pulley : p.pulleys) {
    require(pulley.radius_m, "radius_m", 1e-4, 1.0);
    require(pulley.wrap_rad, "wrap_rad", 0.01, kPi);
    require(pulley.inertia_kgm2, "inertia_kgm2", 1e-13, 1.0);
    require(pulley.surface_friction, "surface_friction", 0.0, 2.0);
    require(pulley.bearing_friction, "bearing_friction", 0.0, 2.0);
    require(pulley.bore_radius_m, "bore_radius_m", 0.0, pulley.radius_m);
  }
}

}  // namespace

PulleyLine::PulleyLine(PulleyLineParameters parameters) : parameters_(std::move(parameters)) {
  check(parameters_);
  lay_out();
  strain_.assign(length_m_.size(), parameters_.preload_n / parameters_.axial_stiffness_n);
  tension_.assign(length_m_.size(), parameters_.preload_n);
  speed_.assign(mass_kg_.size(), 0.0);
  grip_ns_.assign(mass_kg_.size(), 0.0);
  double most = 0.0;  // Gershgorin's bound of the squared frequency
  for (std::size_t i = 0; i < mass_kg_.size(); ++i) {
    most = std::max(most,
                    2.0 * parameters_.axial_stiffness_n * (1.0 / length_m_[i] + 1.0 / length_m_[i + 1]) / mass_kg_[i]);
  }
  most = std::max(most, 2.0 * (parameters_.axial_stiffness_n / length_m_.back() + parameters_.load_stiffness_n_per_m) /
                            parameters_.load_mass_kg);
  const double frequency = std::sqrt(most);
  const double damped = 0.5 * parameters_.damping_s * frequency;
  step_s_ = kStepShare * 2.0 * (std::sqrt(1.0 + damped * damped) - damped) / frequency;
  if (step_s_ * kMostStepsPerSecond < 1.0) {
    throw std::invalid_argument("this tendon needs a step of " + text_of(step_s_) + " s; it must be from " +
                                text_of(1.0 / kMostStepsPerSecond) +
                                " s up: take fewer nodes_per_pulley, or more mass_kg_per_m");
  }
  stored_at_rest_ = stored();
}

/// Cells and points: a span with half an arc step at each end is one cell.
void PulleyLine::lay_out() {
  state_.resize(pulleys());
  double open = parameters_.spans_m[0];
  span_cell_.push_back(0);
  for (std::size_t k = 0; k < pulleys(); ++k) {
    const PulleyParameters& pulley = parameters_.pulleys[k];
    const double arc = pulley.radius_m * pulley.wrap_rad / parameters_.nodes_per_pulley;
    state_[k].first = length_m_.size();
    state_[k].bend_cosine = std::cos(pulley.wrap_rad);
    length_m_.push_back(open + 0.5 * arc);
    length_m_.insert(length_m_.end(), static_cast<std::size_t>(parameters_.nodes_per_pulley) - 1, arc);
    open = 0.5 * arc + parameters_.spans_m[k + 1];
    span_cell_.push_back(length_m_.size());
  }
  length_m_.push_back(open);
  for (std::size_t i = 0; i + 1 < length_m_.size(); ++i) {
    mass_kg_.push_back(0.5 * parameters_.mass_kg_per_m * (length_m_[i] + length_m_[i + 1]));
  }
}

/// Strain: what the ends of a cell pull apart, and what the tendon that flows in and out carries along.
void PulleyLine::flow(double input_speed) {
  const std::size_t cells = length_m_.size();
  double near_speed = input_speed;
  // Nothing is known of the tendon on a drum but that it went there under the tension beside it.
  double near_flow = near_speed * strain_[0];
  energy_.convected += 0.5 * parameters_.axial_stiffness_n * strain_[0] * near_flow * step_s_;
  for (std::size_t j = 0; j < cells; ++j) {
    const bool last = j + 1 == cells;
    const double far_speed = last ? output_speed_ : speed_[j];
    const double upwind = last || far_speed < 0.0 ? strain_[j] : strain_[j + 1];
    const double far_flow = far_speed * upwind;
    const double rate = (near_speed - far_speed) / length_m_[j];
    strain_[j] += step_s_ * (rate + (far_flow - near_flow) / length_m_[j]);
    const double elastic = parameters_.axial_stiffness_n * strain_[j];
    tension_[j] = std::max(0.0, elastic + parameters_.axial_stiffness_n * parameters_.damping_s * rate);
    energy_.damping += (tension_[j] - std::max(0.0, elastic)) * rate * length_m_[j] * step_s_;
    near_speed = far_speed;
    near_flow = far_flow;
  }
  energy_.convected -= 0.5 * parameters_.axial_stiffness_n * strain_[cells - 1] * near_flow * step_s_;
}

/// The speed of a pulley's rim after this step: that at which the friction of its points (each sticks, or slides at its
/// limit), the bearing and its inertia agree. What it is asked for falls with the speed without jumps, so Newton with a
/// bracket finds it. @param limit_nms  the bearing's largest angular impulse
auto PulleyLine::rim_speed(std::size_t k, double limit_nms) -> double {
  const PulleyParameters& pulley = parameters_.pulleys[k];
  const std::size_t first = state_[k].first;
  const std::size_t end = first + static_cast<std::size_t>(parameters_.nodes_per_pulley);
  const double mass = pulley.inertia_kgm2 / (pulley.radius_m * pulley.radius_m);
  const double start = mass * state_[k].speed_rad_per_s * pulley.radius_m;
  struct Impulse {
    double sum, slope;
  };
  const auto impulse_at = [&](double rim) {
    Impulse impulse{start - mass * rim, -mass};
    for (std::size_t i = first; i < end; ++i) {
      const double sticking = mass_kg_[i] * (speed_[i] - rim);
      const bool sticks = std::fabs(sticking) <= grip_ns_[i];
      impulse.sum += sticks ? sticking : std::copysign(grip_ns_[i], sticking);
      impulse.slope -= sticks ? mass_kg_[i] : 0.0;
    }
    return impulse;
  };
  const double at_rest = impulse_at(0.0).sum;
  const double bearing = limit_nms / pulley.radius_m;
  if (pulley.locked || std::fabs(at_rest) <= bearing) {
    return 0.0;
  }
  const double held_back = std::copysign(bearing, at_rest);
  double low = at_rest > 0.0 ? 0.0 : (at_rest - held_back) / mass;
  double high = at_rest > 0.0 ? (at_rest - held_back) / mass : 0.0;
  double rim = std::clamp(state_[k].speed_rad_per_s * pulley.radius_m, low, high);
  for (int round = 0; round < kRounds; ++round) {
    const Impulse impulse = impulse_at(rim);
    const double excess = impulse.sum - held_back;
    (excess > 0.0 ? low : high) = rim;
    double next = rim - excess / impulse.slope;
    if (!(next > low && next < high)) {
      next = 0.5 * (low + high);
    }
    if (std::fabs(next - rim) <= 1e-13 * (std::fabs(next) + std::fabs(rim))) {
      break;
    }
    rim = next;
  }
  return rim;
}

void PulleyLine::turn(std::size_t k) {
  const PulleyParameters& pulley = parameters_.pulleys[k];
  PulleyState& state = state_[k];
  const double near = span_tension_n(k);
  const double far = span_tension_n(k + 1);
  const double resultant = std::sqrt(std::max(0.0, near * near + far * far - 2.0 * near * far * state.bend_cosine));
  const double bearing = pulley.bearing_friction * pulley.bore_radius_m * resultant;
  const double rim = rim_speed(k, bearing * step_s_);
  const std::size_t end = state.first + static_cast<std::size_t>(parameters_.nodes_per_pulley);
  int slipping = 0;
  for (std::size_t i = state.first; i < end; ++i) {
    const double sticking = mass_kg_[i] * (speed_[i] - rim);
    const bool sticks = std::fabs(sticking) <= grip_ns_[i];
    slipping += sticks ? 0 : 1;
    const double before = speed_[i];
    speed_[i] = sticks ? rim : speed_[i] - std::copysign(grip_ns_[i], sticking) / mass_kg_[i];
    energy_.slip += mass_kg_[i] * (before - speed_[i]) * (speed_[i] - rim);
  }
  state.slipping = static_cast<double>(slipping) / parameters_.nodes_per_pulley;
  state.speed_rad_per_s = rim / pulley.radius_m;
  state.angle_rad += step_s_ * state.speed_rad_per_s;
  energy_.bearings += bearing * std::fabs(state.speed_rad_per_s) * step_s_;
}

void PulleyLine::step(double input_speed) {
  flow(input_speed);
  for (std::size_t i = 0; i < speed_.size(); ++i) {
    speed_[i] += step_s_ * (tension_[i] - tension_[i + 1]) / mass_kg_[i];
  }
  for (std::size_t k = 0; k < pulleys(); ++k) {
    const double turn_per_point = parameters_.pulleys[k].wrap_rad / parameters_.nodes_per_pulley;
    const std::size_t first = state_[k].first;
    for (std::size_t i = first; i < first + static_cast<std::size_t>(parameters_.nodes_per_pulley); ++i) {
      const double normal = 0.5 * (tension_[i] + tension_[i + 1]) * turn_per_point;
      grip_ns_[i] = parameters_.pulleys[k].surface_friction * normal * step_s_;
    }
    turn(k);
  }
  if (!parameters_.load_held) {
    const double pull = parameters_.preload_n + parameters_.load_stiffness_n_per_m * output_travel_m_;
    const double damped = parameters_.load_damping_ns_per_m * output_speed_;
    output_speed_ += step_s_ * (tension_.back() - pull - damped) / parameters_.load_mass_kg;
    energy_.damping += damped * output_speed_ * step_s_;
    energy_.load += pull * output_speed_ * step_s_;
    output_travel_m_ += step_s_ * output_speed_;
  }
  energy_.supplied += tension_[0] * input_speed * step_s_;
  input_travel_m_ += step_s_ * input_speed;
  time_s_ += step_s_;
}

void PulleyLine::run(double seconds, double input_speed) {
  const auto steps = static_cast<long>(seconds / step_s_ + 0.5);
  for (long i = 0; i < steps; ++i) {
    step(input_speed);
  }
}

auto PulleyLine::tensions_on(std::size_t pulley) const -> std::vector<double> {
  const auto first = tension_.begin() + static_cast<std::ptrdiff_t>(state_[pulley].first);
  return {first, first + parameters_.nodes_per_pulley + 1};
}

auto PulleyLine::stored() const -> double {
  double sum = 0.0;
  for (std::size_t j = 0; j < length_m_.size(); ++j) {
    sum += 0.5 * parameters_.axial_stiffness_n * strain_[j] * strain_[j] * length_m_[j];
  }
  return sum;
}

auto PulleyLine::moving() const -> double {
  double sum = 0.5 * parameters_.load_mass_kg * output_speed_ * output_speed_;
  for (std::size_t i = 0; i < speed_.size(); ++i) {
    sum += 0.5 * mass_kg_[i] * speed_[i] * speed_[i];
  }
  for (std::size_t k = 0; k < pulleys(); ++k) {
    sum += 0.5 * parameters_.pulleys[k].inertia_kgm2 * state_[k].speed_rad_per_s * state_[k].speed_rad_per_s;
  }
  return sum;
}

auto PulleyLine::energy() const -> PulleyLineEnergy {
  PulleyLineEnergy energy = energy_;
  energy.elastic = stored() - stored_at_rest_;
  energy.kinetic = moving();
  return energy;
}

}  // namespace capstan::sim
