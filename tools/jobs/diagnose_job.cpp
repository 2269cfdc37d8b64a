// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/jobs/diagnose_job.hpp"

#include "capstan/tools/diagnose/compare.hpp"
#include "capstan/tools/identify/identify.hpp"
#include "capstan/tools/identify/tendon_fit.hpp"
#include "capstan/tools/joint_file/effort_file.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

/// A law's coefficients belong to the joints that it names, in its order.
void couple_as(const JointFile& base, const std::string& file, JobLogs& logs) {
  if (base.coupled_to.empty()) {
    return;
  }
  if (!logs.coupled_to.empty() && logs.coupled_to != base.coupled_to) {
    std::vector<std::string> axes;
    for (const int axis : base.coupled_to) {
      axes.push_back(std::to_string(axis));
    }
    throw BadInput("the law of " + file + " is coupled to axis " + joined(axes) + "; leave --coupled-to out");
  }
  logs.coupled_to = base.coupled_to;
}

}  // namespace

auto diagnose(const DiagnoseJob& job, const Say& warn) -> Diagnosis {
  AxisRequest request;
  request_target(job.target, job.base, request);
  DiagnoseOptions wanted;
  JobLogs logs = job.logs;
  if (job.base.ends_with(".toml")) {
    const JointFile base = read_start_law(job.base);
    wanted.base_law = base;
    couple_as(base, job.base, logs);
    if (request.effort || request.force) {
      throw BadInput("the law of " + job.base + " explains a joint angle, and " + job.target +
                     " is an effort; leave --target out, or choose --base rigid_dynamics, pull_push or preisach");
    }
  }
  request.needs_torque = wanted.base_law
                             ? wanted.base_law->has("tendon_elongation") || wanted.base_law->has(kTendonModel)
                             : job.base == kDefaultModel;
  const auto axes = read_recordings(logs, request, warn);
  logs.files = job.tests;
  wanted.test_logs = read_recordings(logs, request, warn);
  wanted.base_model = job.base;
  wanted.drawing = job.drawing;
  wanted.progress = job.progress;
  Diagnosis diagnosis = diagnose(axes, wanted);
  if (wanted.base_law && !wanted.base_law->has(kTendonModel)) {  // what tendons have come to is asked of their loop
    for (const MovedParameter& one : moved_between(*wanted.base_law, diagnosis.base)) {
      diagnosis.sizes.push_back(moved_sentence(one));
    }
  }
  return diagnosis;
}

auto write_law(Diagnosis& diagnosis, const std::string& path) -> std::string {
  std::string status;
  if (diagnosis.effort_law) {
    write_effort_file(path, *diagnosis.effort_law);
    status = diagnosis.effort_law->status;
  } else if (!diagnosis.law.terms.empty()) {
    write_joint_file(path, diagnosis.law);
    status = word_of(diagnosis.law.status);
  }
  if (!status.empty()) {
    diagnosis.law_file = path;
  }
  return status;
}

}  // namespace capstan::tools
