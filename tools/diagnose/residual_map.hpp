// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <string>
#include <vector>

namespace capstan::tools {

/// A stretch of one signal in one direction of motion, and what a law leaves there.
struct MapCell {
  std::string signal;  ///< "angle", "speed", "load" or "time_since_reversal"
  bool forward = true;
  double from = 0.0, to = 0.0;  ///< of the signal, in its own unit
  double mean = 0.0;            ///< of the residual there, in the target's unit
  Eigen::Index rows = 0;
  Eigen::Index visits = 0;  ///< how often the motion came there
  double p_value = 1.0;     ///< that the mean is nothing, for this cell alone
  bool found = false;       ///< it is not, where of all such cells at most one in twenty is wrong
};

/// Where the residual of a law lies. Cells overlap: each signal is a way of its own through the same rows.
struct ResidualMap {
  std::vector<MapCell> cells;
  std::string sentence;  ///< which cells stand out, for people
};

/// Signals of logs, one below the other; where time goes back the next one begins.
struct MapSignals {
  Eigen::VectorXd time_s, q1;
  Eigen::VectorXd load;  ///< the motor's torque; empty where it is no input of the law
};

/// Cuts every signal, each direction for itself, into eight cells of equally many rows and asks of each whether the
/// mean residual differs from nothing: by Student's t over the visits, for neighbouring rows err alike, and so that of
/// all the cells that are found one in twenty is wrong at most (Benjamini and Yekutieli 2001, for cells that depend on
/// each other in any way). Cells of fewer than four visits say nothing.
auto residual_map(const MapSignals& all, const Eigen::VectorXd& of_all) -> ResidualMap;

}  // namespace capstan::tools
