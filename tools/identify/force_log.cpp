// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/identify/force_fit.hpp"
#include "capstan/tools/log/axis_log.hpp"
#include "capstan/tools/support/errors.hpp"

namespace capstan::tools {

auto read_motor_side(const CsvLog& log, int axis) -> ForceLog {
  ForceLog result;
  result.name = log.name();
  result.time_s = log.time();
  result.q1_rad = log.column(axis_column(axis, "q1_rad"));
  result.tau_nm = log.column(axis_column(axis, "tau_Nm"));
  result.tau_out_nm = Eigen::VectorXd::Zero(result.samples());
  return result;
}

auto read_force_log(const CsvLog& log, int axis) -> ForceLog {
  ForceLog result = read_motor_side(log, axis);
  result.tau_out_nm = log.column(axis_column(axis, "tau_out_Nm"));
  if (result.samples() < kFewestForceSamples) {
    throw BadInput(log.name() + ": " + std::to_string(result.samples()) + " samples are too few to fit a force law; " +
                   "record at least one slow cycle of torque");
  }
  for (const auto& [values, name] :
       {std::pair{&result.tau_nm, "tau_Nm"}, std::pair{&result.tau_out_nm, "tau_out_Nm"}}) {
    if (values->maxCoeff() == values->minCoeff()) {
      throw BadInput(log.name() + ": " + axis_column(axis, name) +
                     " does not change; check the sensor, or that the tip " + "is held while the motor pulls");
    }
  }
  return result;
}

}  // namespace capstan::tools
