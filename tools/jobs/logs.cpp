// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/jobs/logs.hpp"

#include <algorithm>
#include <iterator>

#include "capstan/tools/identify/force_catalogue.hpp"
#include "capstan/tools/identify/identify.hpp"
#include "capstan/tools/joint_file/effort_file.hpp"
#include "capstan/tools/log/recordings.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/first_repeat.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {

void refuse_repeats(const std::vector<std::string>& paths) {
  if (const auto path = first_repeat(paths, same_file); path != paths.end()) {
    throw BadInput(*path + " is given twice, and its rows would count as evidence twice; name it once");
  }
}

auto read_logs(const std::vector<std::string>& paths, const std::vector<std::string>& maps) -> std::vector<CsvLog> {
  const auto mappings = parse_mappings(maps);
  refuse_repeats(paths);
  std::vector<CsvLog> logs;
  for (const auto& path : paths) {
    logs.push_back(CsvLog::read(path, mappings));
  }
  return logs;
}

auto read_axes(const JobLogs& logs, const AxisRequest& request, const Say& warn) -> std::vector<AxisLog> {
  if (std::find(logs.coupled_to.begin(), logs.coupled_to.end(), logs.axis) != logs.coupled_to.end()) {
    throw BadInput("--coupled-to " + std::to_string(logs.axis) + " is the axis itself; name another axis of the log");
  }
  AxisRequest wanted = request;
  wanted.axis = logs.axis;
  wanted.other_axes = logs.coupled_to;
  std::vector<AxisLog> axes;
  for (const auto& file : logs.files) {
    axes.push_back(read_axis(file, wanted));
    for (const auto& warning : axes.back().warnings) {
      warn(warning);
    }
  }
  return axes;
}

auto read_recordings(const JobLogs& logs, const AxisRequest& request, const Say& warn) -> std::vector<AxisLog> {
  std::vector<AxisLog> all;
  for (auto& file : read_axes(logs, request, warn)) {
    const std::size_t said = file.warnings.size();
    auto recordings = recordings_in(std::move(file));
    for (std::size_t i = said; i < recordings.front().warnings.size(); ++i) {
      warn(recordings.front().warnings[i]);
    }
    std::move(recordings.begin(), recordings.end(), std::back_inserter(all));
  }
  return all;
}

auto read_start_law(const std::string& path) -> JointFile {
  if (is_effort_file(path)) {
    throw BadInput(path + ": no fit starts from the file of an effort's law; give the name of one instead, " +
                   "rigid_dynamics or inertia, or of a torque behind a gear pull_push or preisach");
  }
  return read_joint_file(path);
}

void request_target(const std::string& target, const std::string& model, AxisRequest& request) {
  if (target.ends_with("_A") || target.ends_with("_V")) {
    throw Refusal("the target " + target + " is a current or a voltage; turn it into a torque with " +
                  "--map \"axis0/tau_Nm=" + target + "*FACTOR\" --target axis0/tau_Nm");
  }
  if (target.ends_with("/q1_rad") || target.ends_with("/q1_m")) {
    throw BadInput("the target " + target + " is the motor's, by which a law explains the joint; name the joint's, " +
                   target.substr(0, target.find('/')) + "/q2_rad");
  }
  request.target = target;
  request.force = is_force_model(model);
  request.effort =
      !request.force && (is_effort_column(target) || (is_effort_model(model) && !target.ends_with("_rad")));
}

}  // namespace capstan::tools
