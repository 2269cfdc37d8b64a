// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <stdexcept>
#include <vector>

namespace capstan::sim {

/// A rotating idler on a tendon's way.
struct PulleyParameters {
  double radius_m = 8e-3;
  double wrap_rad = 1.5707963267948966;
  double inertia_kgm2 = 1.6e-7;   ///< 5 g of steel at 8 mm
  double surface_friction = 0.2;  ///< between tendon and pulley
  double bearing_friction = 0.2;  ///< in the bore, under the resultant of both tensions
  double bore_radius_m = 3e-3;
  bool locked = false;  ///< held: a surface
};

/// One tendon from a driven drum over idlers to a load drum.
struct PulleyLineParameters {
  double axial_stiffness_n = 5000.0;  ///< E A
  double mass_kg_per_m = 2e-3;
  double damping_s = 2e-7;  ///< tension is E A (strain + damping_s * strain rate)
  double preload_n = 10.0;  ///< at rest, and the load's constant pull
  std::vector<double> spans_m = {0.15, 0.15};
  std::vector<PulleyParameters> pulleys = {{}};
  int nodes_per_pulley = 8;
  bool load_held = false;      ///< the load drum stands still
  double load_mass_kg = 0.05;  ///< at the drum's rim
  double load_stiffness_n_per_m = 0.0;
  double load_damping_ns_per_m = 0.0;
};

/// Where the work of the driven drum has gone since the start, J.
struct PulleyLineEnergy {
  double supplied = 0.0;   ///< by the driven drum
  double elastic = 0.0;    ///< in the tendon, above that at rest
  double kinetic = 0.0;    ///< tendon, idlers, load
  double load = 0.0;       ///< lifted against its pull and spring
  double convected = 0.0;  ///< elastic energy that left with the tendon, onto the drums
  double slip = 0.0;       ///< tendon on idlers
  double bearings = 0.0;
  double damping = 0.0;  ///< in the tendon and at the load
  /// What the balance misses: numerical loss. Above 0: lost.
  [[nodiscard]] auto missing() const -> double {
    return supplied - elastic - kinetic - load - convected - slip - bearings - damping;
  }
};

/// A tendon over rotating idlers, for transients: stop and go, reversals. No law of friction but Coulomb's, at points
/// of the pulleys' surfaces and in their bearings; slip, stick and the capstan equation come out. Points are fixed in
/// space, the tendon flows past them and carries its strain along (creep). A symplectic step with exact stick: all
/// points of a pulley, its rotation and its bearing are solved together. Speeds count toward the driven drum.
/// Left out: centrifugal tension (mass times speed squared, 5e-6 N at 50 mm/s), bending stiffness, weight.
class PulleyLine {
 public:
  /// Throws std::invalid_argument with a sentence that names the range if a number makes no sense.
  explicit PulleyLine(PulleyLineParameters parameters);

  /// Length of a step, s: from the stiffest point of the tendon.
  [[nodiscard]] auto step_s() const -> double { return step_s_; }
  /// One step, the driven drum's rim at a speed, m/s.
  void step(double input_speed_m_per_s);
  /// As many steps as come nearest to a duration.
  void run(double seconds, double input_speed_m_per_s);

  [[nodiscard]] auto time_s() const -> double { return time_s_; }
  [[nodiscard]] auto input_travel_m() const -> double { return input_travel_m_; }
  [[nodiscard]] auto output_travel_m() const -> double { return output_travel_m_; }
  [[nodiscard]] auto input_tension_n() const -> double { return tension_[0]; }
  [[nodiscard]] auto output_tension_n() const -> double { return tension_.back(); }
  /// Of the span before a pulley; pulleys() for the last span.
  [[nodiscard]] auto span_tension_n(std::size_t span) const -> double { return tension_[span_cell_[span]]; }
  /// Tensions between the points of a pulley, from the span before it to the span behind it, N.
  [[nodiscard]] auto tensions_on(std::size_t pulley) const -> std::vector<double>;
  [[nodiscard]] auto pulleys() const -> std::size_t { return parameters_.pulleys.size(); }
  [[nodiscard]] auto pulley_angle_rad(std::size_t pulley) const -> double { return state_[pulley].angle_rad; }
  [[nodiscard]] auto pulley_speed_rad_per_s(std::size_t pulley) const -> double {
    return state_[pulley].speed_rad_per_s;
  }
  /// Share of a pulley's points on which the tendon slides.
  [[nodiscard]] auto slipping_share(std::size_t pulley) const -> double { return state_[pulley].slipping; }
  [[nodiscard]] auto energy() const -> PulleyLineEnergy;
  [[nodiscard]] auto parameters() const -> const PulleyLineParameters& { return parameters_; }

 private:
  struct PulleyState {
    double angle_rad = 0.0, speed_rad_per_s = 0.0, slipping = 0.0;
    std::size_t first = 0;   ///< its first point
    double bend_cosine = 0;  ///< of the wrap
  };
  void lay_out();
  void flow(double input_speed);
  void turn(std::size_t pulley);
  [[nodiscard]] auto rim_speed(std::size_t pulley, double limit_nms) -> double;
  [[nodiscard]] auto stored() const -> double;
  [[nodiscard]] auto moving() const -> double;

  PulleyLineParameters parameters_;
  std::vector<double> length_m_, strain_, tension_;  ///< of cells, from the driven drum on
  std::vector<double> mass_kg_, speed_, grip_ns_;    ///< of points; cell j ends at point j
  std::vector<std::size_t> span_cell_;
  std::vector<PulleyState> state_;
  PulleyLineEnergy energy_;
  double step_s_ = 0.0, time_s_ = 0.0;
  double input_travel_m_ = 0.0, output_travel_m_ = 0.0, output_speed_ = 0.0;
  double stored_at_rest_ = 0.0;
};

}  // namespace capstan::sim
