// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "capstan/tools/identify/conditioning.hpp"
#include "capstan/tools/identify/force_fit.hpp"
#include "capstan/tools/support/errors.hpp"

namespace capstan::tools {

auto read_force_log(const CsvLog& log, int axis) -> AxisLog {
  for (const char* quantity : {"tau_out_Nm", "tau_Nm"}) {
    const std::string name = axis_column(axis, quantity);
    const Eigen::VectorXd torque = log.column(name);
    if (torque.size() < kFewestForceSamples) {
      throw BadInput(log.name() + ": " + std::to_string(torque.size()) + " samples are too few to fit a force law; " +
                     "record at least one slow cycle of torque");
    }
    if (torque.maxCoeff() == torque.minCoeff()) {
      throw BadInput(log.name() + ": " + name +
                     " does not change; check the sensor, or that the tip is held while the motor pulls");
    }
  }
  return read_axis(log, {.axis = axis, .force = true});
}

auto averaging_stretch(Eigen::Index rows, Eigen::Index most_rows, double period_s) -> Eigen::Index {
  constexpr double kLongestRowS = 0.04;
  const auto longest = std::max<Eigen::Index>(1, static_cast<Eigen::Index>(kLongestRowS / period_s));
  return std::clamp<Eigen::Index>((rows + most_rows - 1) / most_rows, 1, longest);
}

auto averaged_over(AxisLog log, Eigen::Index stretch) -> AxisLog {
  log.period_s *= static_cast<double>(stretch);
  for_each_signal(log, [stretch](auto& signal) { signal = Eigen::VectorXd(decimated(signal, stretch)); });
  return log;
}

}  // namespace capstan::tools
