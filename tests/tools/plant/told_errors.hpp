// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/tools/joint_file/joint_file.hpp"
#include "capstan/tools/log/axis_log.hpp"

namespace capstan::tools::plant {

/// What a board's error bars are worth.
struct ToldErrors {
  double told = 0.0;       ///< share of samples that have one
  double held = 0.0;       ///< share of those whose measured joint angle is within it
  double width_rad = 0.0;  ///< half of it, their mean
  double error_rad = 0.0;  ///< rms of the law's error where it has one
};

/// The law of a board, sample by sample over a log that it was not made of, in the firmware's numbers.
auto told_errors(const JointFile& law, const AxisLog& log) -> ToldErrors;

/// Prints what error bars of laws made in one motion are worth in the others, on joints drawn by these seeds.
void ask_error_bars(std::uint64_t first, int joints);

}  // namespace capstan::tools::plant
