// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/jobs/replay_job.hpp"

#include "capstan/tools/jobs/law_request.hpp"
#include "capstan/tools/support/errors.hpp"

namespace capstan::tools {

auto replay_angle(const CsvLog& log, int axis, const JointFile& joint, Arithmetic arithmetic, const Say& warn)
    -> AngleReplay {
  AxisRequest request = columns_of_law(joint, axis);
  request.needs_target = false;
  request.every_row = true;
  std::vector<std::string> notes;
  AngleReplay done{.csv = common_rows_of(log, request, notes), .log = {}, .estimates = {}};
  done.log = read_axis(done.csv, request);
  done.log.warnings.insert(done.log.warnings.end(), notes.begin(), notes.end());
  for (const auto& warning : done.log.warnings) {
    warn(warning);
  }
  done.estimates = replay(done.log, motion_parameters(joint), arithmetic);
  return done;
}

auto replay_torque(const CsvLog& log, int axis, const BoardForceLaw& law, Arithmetic arithmetic, const Say& warn)
    -> Eigen::VectorXd {
  ReplayedForce force = replay_force(log.column(axis_column(axis, "tau_Nm")), law, arithmetic);
  if (force.unknown > 0) {
    warn("the past of the joint is taken as demagnetised in the first " + std::to_string(force.unknown) +
         " samples; a log that begins with a full swing to one side does not need that");
  }
  if (force.beyond > 0) {
    warn(std::to_string(force.beyond) +
         " samples lie beyond the torques of the force law, which ends there; identify the law with more torque");
  }
  return std::move(force.torque_nm);
}

void refuse_saturated(long samples, const std::string& law) {
  if (samples > 0) {
    throw Refusal(std::to_string(samples) + " samples reached the end of the range of numbers (+-128); " +
                  "check the units of the log and of " + law);
  }
}

}  // namespace capstan::tools
