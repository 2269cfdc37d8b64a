// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/jobs/diagnose_job.hpp"

#include <algorithm>
#include <cmath>

#include "capstan/tools/diagnose/compare.hpp"
#include "capstan/tools/identify/force_section.hpp"
#include "capstan/tools/identify/preisach_rows.hpp"
#include "capstan/tools/identify/tendon_fit.hpp"
#include "capstan/tools/jobs/law_request.hpp"
#include "capstan/tools/joint_file/effort_file.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

constexpr const char* kReversalTable = "preisach";

/// What the file of an effort's law takes beside its numbers, where too few rows were there to choose a law by.
void make_runnable(const std::vector<AxisLog>& logs, Diagnosis& d) {
  if (d.effort_law || d.law.terms.empty()) {
    return;
  }
  if (logs.front().motion_alone()) {
    d.effort_law = runnable_law(d.law, logs);
  } else if (d.law.has(kReversalTable) && d.law.terms.size() > 1) {
    d.warnings.emplace_back("a file holds the reversal table alone, without the effects that were added to it");
  }
}

/// The [force] section of a law that is a reversal table.
auto reversal_table_text(const JointFile& law) -> std::string {
  const CatalogueTerm& term = law.catalogue->term(kReversalTable);
  const double* ends = &law.parameters.shapes[term.first_shape];
  PreisachTable levels;
  levels.levels = kPreisachLevels;
  const Levels inputs = even_levels(ends[0], ends[1], kPreisachLevels);
  std::copy(inputs.begin(), inputs.end(), levels.inputs.begin());
  PreisachFit fit;
  fit.table =
      with_weights(levels, Eigen::Map<const Eigen::VectorXd>(&law.parameters.coefficients[term.first_coefficient],
                                                             static_cast<Eigen::Index>(term.coefficients.size())));
  fit.half_intervals.assign(PreisachTable::index(kPreisachLevels, 0), std::nan(""));  // nobody knows those of the table
  if (law.fit) {
    fit.rmse_nm = law.fit->rmse;
    fit.samples = law.fit->samples;
  }
  return with_force_section("", force_section(fit));
}

}  // namespace

auto diagnose(const DiagnoseJob& job, const Say& warn) -> Diagnosis {
  LawRequest asked = request_for(job.base, job.target, job.logs);
  add_moving_axes(job.logs.files, asked.columns);
  need_torque_of_all(job.logs.files, job.tests, asked.columns);
  const auto axes = read_recordings(job.logs.files, asked.columns, warn);
  DiagnoseOptions wanted;
  wanted.test_logs = read_recordings(job.tests, asked.columns, warn);
  wanted.base_law = asked.law;
  wanted.base_model = job.base;
  wanted.drawing = job.drawing;
  wanted.progress = job.progress;
  Diagnosis diagnosis = diagnose(axes, wanted);
  make_runnable(axes, diagnosis);
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
  } else if (diagnosis.law.has(kReversalTable)) {
    write_text_file(path, reversal_table_text(diagnosis.law));
    status = word_of(diagnosis.law.status);
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
