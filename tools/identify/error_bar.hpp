// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "capstan/tools/identify/least_squares.hpp"
#include "capstan/tools/identify/term_catalogue.hpp"
#include "capstan/tools/joint_file/error_bar_numbers.hpp"

namespace capstan::tools {

/// Half the width that 95 of 100 errors keep within, and the quantile's own score, summed: least where the width is the
/// quantile (Koenker, Bassett 1978).
struct HeldWidth {
  double half = 0.0;
  double loss = 0.0;
};
/// @param sizes  magnitudes of errors; nothing of fewer than 100, five of which are beyond the quantile
auto held_width(const std::vector<double>& sizes) -> std::optional<HeldWidth>;

/// How far from the joint a law was in its logs, 95 of 100 times: near a reversal and beyond, as a board tells it.
/// Where no turn leaves enough samples on either side of it, both are that of all samples.
/// @param samples    of each log, as the law runs over them
/// @param error_rad  measured joint angle less the law's, all logs, one below the other
/// @param settled    rows that tell of the law: a board does not tell before, either
/// @returns nothing where too few samples are left
auto error_bar(const std::vector<Samples>& samples, const Eigen::VectorXd& error_rad, const Blocks& settled)
    -> std::optional<ErrorBarNumbers>;

}  // namespace capstan::tools
