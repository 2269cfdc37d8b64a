// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/jobs/diagnose_job.hpp"

#include "capstan/tools/diagnose/compare.hpp"
#include "capstan/tools/identify/force_section.hpp"
#include "capstan/tools/identify/tendon_fit.hpp"
#include "capstan/tools/jobs/law_file.hpp"
#include "capstan/tools/jobs/law_request.hpp"
#include "capstan/tools/joint_file/effort_file.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

/// The same logs as if no other joint's motion had been logged.
void leave_alone(std::vector<AxisLog>& logs) {
  for (AxisLog& log : logs) {
    log.others.clear();
    std::erase_if(log.side, [](const SideSignal& side) { return side.name.starts_with("axis"); });
  }
}

}  // namespace

auto diagnose(const DiagnoseJob& job, const Say& warn) -> Diagnosis {
  LawRequest asked = request_for(job.base, job.target, job.logs);
  add_moving_axes(job.logs.files, asked.columns);
  need_torque_of_all(job.logs.files, job.tests, asked.columns);
  auto axes = read_recordings(job.logs.files, asked.columns, warn);
  DiagnoseOptions wanted;
  wanted.test_logs = read_recordings(job.tests, asked.columns, warn);
  if (job.alone) {
    leave_alone(axes);
    leave_alone(wanted.test_logs);
  }
  wanted.base_law = asked.law;
  wanted.base_model = job.base;
  wanted.drawing = job.drawing;
  wanted.progress = job.progress;
  Diagnosis diagnosis = diagnose(axes, wanted);
  warn_of_left_out(diagnosis);
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
  } else if (diagnosis.pull_push) {
    write_text_file(path, with_force_section("", force_section(*diagnosis.pull_push)));
    status = word_of(diagnosis.law.status);
  } else if (is_reversal_table(diagnosis.law)) {
    status = write_reversal_table(diagnosis.law, path);
  } else if (!diagnosis.law.terms.empty() && diagnosis.law.catalogue->target() != TargetKind::kForce) {
    write_joint_file(path, diagnosis.law);
    status = word_of(diagnosis.law.status);
  }
  if (!status.empty()) {
    diagnosis.law_file = path;
  }
  return status;
}

}  // namespace capstan::tools
