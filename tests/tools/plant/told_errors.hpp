// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "capstan/tools/joint_file/joint_file.hpp"
#include "capstan/tools/log/axis_log.hpp"

namespace capstan::tools::plant {

/// What a board's error bars are worth: of the joint's angle, rad, or of its torque, N m.
struct ToldErrors {
  double told = 0.0;   ///< share of samples that have one
  double held = 0.0;   ///< share of those whose measured value is within it
  double width = 0.0;  ///< half of it, their mean
  double error = 0.0;  ///< rms of the law's error where it has one
};

/// Counts them sample by sample.
class ToldCount {
 public:
  /// @param width  half of the bar; negative: none
  void add(double error, double width);
  [[nodiscard]] auto result() const -> ToldErrors;

 private:
  double all_ = 0.0, told_ = 0.0, held_ = 0.0, widths_ = 0.0, squares_ = 0.0;
};

/// Prints median and least of the shares that were held.
void print_held(std::vector<double> held);

/// The law of a board, sample by sample over a log that it was not made of, in the firmware's numbers.
auto told_errors(const JointFile& law, const AxisLog& log) -> ToldErrors;

/// Prints what error bars of laws made in one motion are worth in the others, on joints drawn by these seeds.
void ask_error_bars(std::uint64_t first, int joints);

}  // namespace capstan::tools::plant
