// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "capstan/tools/joint_file/joint_file.hpp"
#include "capstan/tools/log/axis_log.hpp"

namespace capstan::tools {

/// Of the firmware's cycle: its laws in fixed point exist at this rate only.
inline constexpr std::int32_t kFirmwareRateHz = 1000;

enum class Arithmetic { kFixed, kDouble };

struct Replayed {
  Eigen::VectorXd q2;        ///< joint angle, what the firmware acts on
  Eigen::VectorXd reported;  ///< what the joint's sensor would report under the law
  long saturated = 0;        ///< samples at which a number met the end of its range
};

/// Runs the law over a log as the firmware does. kFixed is the firmware's arithmetic, bit for bit; it exists at 1 kHz
/// only and throws Refusal for other rates. Throws BadInput for inputs outside the firmware's range of numbers.
auto replay(const AxisLog& log, const LawParameters<double>& law, Arithmetic arithmetic) -> Replayed;

/// Columns to append to a log.
struct LogColumns {
  std::vector<std::string> names;
  std::vector<Eigen::VectorXd> values;
  void add(const std::string& name, const Eigen::VectorXd& column) {
    names.push_back(name);
    values.push_back(column);
  }
};
auto columns_of(int axis, const Replayed& replayed) -> LogColumns;

}  // namespace capstan::tools
