// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <array>
#include <cstddef>

#include "capstan/hal/sim/parameters.hpp"
#include "capstan/tools/identify/force_fit.hpp"

namespace capstan::tools {

inline constexpr std::size_t kMostLevels = kMostPreisachLevels;
using ForceSurface = PreisachTable;

// 0.06228 N m of figure 2.10 are the 2 V of chapter 4's signals: 5 V are the 0.155 N m that make a tendon slack.
inline constexpr double kTorquePerVolt = 0.06228 / 2.0;
inline constexpr double kSaturationV = 5.0;

/// What chapter 4 does not print of its forceps; by default what chapter 2 measured of the grasper.
struct ForcepsNumbers {
  double friction = 1.0;  ///< eta over the grasper's
  double pretension_n = sim::PlantParameters{}.pretension_n;
  double saturates_at_v = 1e3;  ///< its drive
};

/// A motion of the input voltage on the forceps with a locked tip, from the lower saturation on, every 10 ms.
struct ForceRun {
  Eigen::VectorXd time_s, input_v, torque_nm;  ///< torque_nm: of the joint, as its force sensor shows
  Eigen::VectorXd q1_rad;
};

/// u1, u2, u3 of chapter 4.
auto run_of_chapter_4(std::size_t signal, const ForcepsNumbers& forceps = {}) -> ForceRun;
/// First-order reversal values measured as chapter 4 does: one peak per level, read at every level on the way down.
/// @param levels  2 to kMostLevels over +-5 V
auto measured_surface(std::size_t levels, const ForcepsNumbers& forceps = {}) -> ForceSurface;
/// Up to every level in turn, the highest first, and down to the lower saturation each time.
auto reversal_run(std::size_t levels) -> ForceRun;
/// The surface that `capstan identify` finds in such a run, in volts.
auto fitted_surface(const ForceRun& run, const PreisachGrid& grid) -> ForceSurface;
/// Root mean square of an estimate's error over the run's largest torque, %.
auto share_of(const Eigen::VectorXd& estimate_nm, const ForceRun& run) -> double;
/// What the classical Preisach model makes of a run, N m.
auto preisach_estimate(const ForceSurface& surface, const ForceRun& run) -> Eigen::VectorXd;

}  // namespace capstan::tools
