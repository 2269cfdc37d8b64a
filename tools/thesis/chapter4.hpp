// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <array>
#include <cstddef>

#include "capstan/model/reversal_table.hpp"

namespace capstan::tools {

inline constexpr std::size_t kMostLevels = 41;
using ForceSurface = ReversalTable<double, kMostLevels>;

/// A motion of the input voltage on the forceps with a locked tip, from the lower saturation on, every 10 ms.
struct ForceRun {
  Eigen::VectorXd time_s, input_v, torque_nm;  ///< torque_nm: of the joint, as its force sensor shows
};

/// u1, u2, u3 of chapter 4.
auto run_of_chapter_4(std::size_t signal) -> ForceRun;
/// First-order reversal values measured as chapter 4 does: one peak per level, read at every level on the way down.
/// @param levels  2 to kMostLevels over +-5 V
auto measured_surface(std::size_t levels) -> ForceSurface;
/// What the classical Preisach model makes of a run, N m.
auto preisach_estimate(const ForceSurface& surface, const ForceRun& run) -> Eigen::VectorXd;

}  // namespace capstan::tools
