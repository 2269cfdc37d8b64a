// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/jobs/compare_job.hpp"

#include "capstan/tools/jobs/law_request.hpp"

namespace capstan::tools {

auto compare(const CompareJob& job, const Say& warn) -> Comparison {
  LawRequest asked = request_for(job.base, job.target, job.healthy);
  add_moving_axes(job.healthy.files, asked.columns);
  need_torque_of_all(job.healthy.files, job.now, asked.columns);
  need_torque_of_all(job.now, job.healthy.files, asked.columns);
  const auto healthy = read_recordings(job.healthy.files, asked.columns, warn);
  add_moving_axes(job.now, asked.columns);  // behind those of the healthy joint's law
  const auto now = read_recordings(job.now, asked.columns, warn);
  DiagnoseOptions wanted;
  wanted.base_model = job.base;
  wanted.base_law = asked.law;
  wanted.drawing = job.drawing;
  wanted.progress = job.progress;
  return compare(healthy, now, wanted);
}

}  // namespace capstan::tools
