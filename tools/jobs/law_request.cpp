// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/jobs/law_request.hpp"

#include <algorithm>

#include "capstan/tools/identify/force_catalogue.hpp"
#include "capstan/tools/identify/identify.hpp"
#include "capstan/tools/identify/reads_torque.hpp"
#include "capstan/tools/joint_file/effort_file.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

/// A file's law that a fit starts from.
auto read_start_law(const std::string& path) -> JointFile {
  if (is_effort_file(path)) {
    throw BadInput(path + ": no fit starts from the file of an effort's law; give the name of one instead, " +
                   "rigid_dynamics or inertia, or of a torque behind a gear pull_push or preisach");
  }
  return read_joint_file(path);
}

void check_target(const std::string& target) {
  if (target.ends_with("_A") || target.ends_with("_V")) {
    throw Refusal("the target " + target + " is a current or a voltage; turn it into a torque with " +
                  "--map \"axis0/tau_Nm=" + target + "*FACTOR\" --target axis0/tau_Nm");
  }
  if (target.ends_with("/q1_rad") || target.ends_with("/q1_m")) {
    throw BadInput("the target " + target + " is the motor's, by which a law explains the joint; name the joint's, " +
                   target.substr(0, target.find('/')) + "/q2_rad");
  }
}

/// A law's coefficients belong to the joints that it names, in its order.
void check_coupling(const JointFile& law, const std::string& file, const std::vector<int>& asked) {
  if (asked.empty() || law.coupled_to.empty() || asked == law.coupled_to) {
    return;
  }
  std::vector<std::string> axes;
  for (const int axis : law.coupled_to) {
    axes.push_back(std::to_string(axis));
  }
  throw BadInput("the law of " + file + " is coupled to axis " + joined(axes) + "; leave --coupled-to out");
}

auto is_law_with_torque(const std::string& name) -> bool {
  LawForm form;
  form.terms = terms_of_model(name);
  return reads_torque(form);
}

}  // namespace

auto columns_of_law(const JointFile& law, int axis) -> AxisRequest {
  return {.axis = axis, .needs_torque = reads_torque(form_of(law)), .other_axes = law.coupled_to};
}

auto request_for(const std::string& law, const std::string& target, const JobLogs& logs) -> LawRequest {
  if (std::find(logs.coupled_to.begin(), logs.coupled_to.end(), logs.axis) != logs.coupled_to.end()) {
    throw BadInput("--coupled-to " + std::to_string(logs.axis) + " is the axis itself; name another axis of the log");
  }
  check_target(target);
  const bool force = is_force_model(law);
  const bool effort = !force && (is_effort_column(target) || (is_effort_model(law) && !target.ends_with("_rad")));
  LawRequest asked;
  if (law.ends_with(".toml")) {
    asked.law = read_start_law(law);
    check_coupling(*asked.law, law, logs.coupled_to);
    if (effort) {
      throw BadInput("the law of " + law + " explains a joint angle, and " + target +
                     " is an effort; leave --target out, or give the name of a law instead, rigid_dynamics or " +
                     "inertia, or of a torque behind a gear pull_push or preisach");
    }
    asked.columns = columns_of_law(*asked.law, logs.axis);
  } else {
    asked.columns.axis = logs.axis;
    const bool of_angle = !law.empty() && !force && !is_effort_model(law);
    asked.columns.needs_torque = of_angle && !effort && is_law_with_torque(law);
  }
  if (asked.columns.other_axes.empty()) {
    asked.columns.other_axes = logs.coupled_to;
  }
  asked.columns.target = target;
  asked.columns.force = force;
  asked.columns.effort = effort;
  return asked;
}

void add_moving_axes(const std::vector<CsvLog>& logs, AxisRequest& request) {
  std::vector<int> moving = request.moving_axes.value_or(std::vector<int>{});
  const auto known = static_cast<std::ptrdiff_t>(moving.size());
  for (const auto& log : logs) {
    for (const int other : moving_axes(log, request.axis)) {
      if (std::find(moving.begin(), moving.end(), other) == moving.end()) {
        moving.push_back(other);
      }
    }
  }
  std::sort(moving.begin() + known, moving.end());
  request.moving_axes = std::move(moving);
}

void need_torque_of_all(const std::vector<CsvLog>& logs, const std::vector<CsvLog>& others, AxisRequest& request) {
  if (request.effort || request.force) {
    return;  // it is explained, or read in any case
  }
  std::vector<int> axes = request.moving_axes.value_or(std::vector<int>{});
  axes.insert(axes.end(), request.other_axes.begin(), request.other_axes.end());
  axes.push_back(request.axis);
  for (const int axis : axes) {
    const std::string tau = axis_column(axis, "tau_Nm");
    const auto has = [&tau](const CsvLog& log) { return log.has(tau); };
    if (std::none_of(logs.begin(), logs.end(), has)) {
      continue;
    }
    request.needs_torque = request.needs_torque || axis == request.axis;
    for (const auto* part : {&logs, &others}) {
      if (const auto without = std::find_if_not(part->begin(), part->end(), has); without != part->end()) {
        throw BadInput(place(without->name(), 1) + "there is no column " + tau +
                       ", which other logs have, and no law can take it for nothing in one of them; name it with " +
                       "--map " + tau + "=COLUMN, or give only logs that have it");
      }
    }
  }
}

}  // namespace capstan::tools
