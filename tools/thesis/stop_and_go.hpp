// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <string>
#include <vector>

#include "capstan/hal/sim/pulley_line.hpp"

namespace capstan::tools {

/// The drum's motion of the study of 8.2.3: go, stop, go, stop, back, stop, back, stop, go, stop.
struct StopAndGo {
  double speed_m_per_s = 0.05;
  double ramp_s = 0.005;  ///< from stop to speed and back, raised cosine
  [[nodiscard]] auto speed_at(double time_s) const -> double;
  /// When a leg begins, s: even ones move, odd ones stop.
  static auto leg_start_s(std::size_t leg) -> double;
  static constexpr std::size_t kLegs = 10;
};

/// What the plant did, every half millisecond.
struct PulleyRun {
  Eigen::VectorXd time_s, drum_m, load_m, rim_m;  ///< rim: the first idler's turning at its radius
  Eigen::VectorXd in_n, out_n;
  sim::PulleyLineEnergy energy;
  [[nodiscard]] auto ratio() const -> Eigen::VectorXd { return out_n.cwiseQuotient(in_n); }
  [[nodiscard]] auto row_at(double time_s) const -> Eigen::Index;
};
auto run_stop_and_go(const sim::PulleyLineParameters& line, const StopAndGo& motion, double until_s) -> PulleyRun;

/// An idler on a damped load, and two.
auto one_idler() -> sim::PulleyLineParameters;
auto two_idlers() -> sim::PulleyLineParameters;
/// Two surfaces that stand still and lose as much as the idlers: what 5.2.1 puts in their place.
auto two_surfaces() -> sim::PulleyLineParameters;
/// Output over input tension of a line that moves, by (5.1) and (5.7).
auto closed_form_ratio(const sim::PulleyLineParameters& line) -> double;

/// What is read off a run.
struct StopAndGoFigures {
  double moving;               ///< output over input tension, second go
  double kept_percent;         ///< of the loss, while stopped
  double reversal_mm;          ///< drum travel from the first turning back until 95 % of the other ratio
  double start_error_percent;  ///< largest error of the moving ratio during the second go, of the output's tension
  double slip_percent;         ///< of the friction's work, that is done by sliding
  double missing_percent;      ///< of it, that the balance of energy misses
};
auto figures_of(const PulleyRun& run) -> StopAndGoFigures;
/// The same of a run that ends with the second go.
auto start_error_percent(const PulleyRun& run) -> double;

}  // namespace capstan::tools
