// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/tools/diagnose/compare.hpp"
#include "capstan/tools/jobs/logs.hpp"

namespace capstan::tools {

struct CompareJob {
  JobLogs healthy;
  std::vector<CsvLog> now;     ///< the same axis
  std::string base;            ///< as for a diagnosis
  std::string target;          ///< column to explain; empty: the base law's own
  TendonDrawing drawing = {};  ///< of a joint with tendons
  Say progress = [](const std::string&) {};
};

/// Throws BadInput and Refusal.
auto compare(const CompareJob& job, const Say& warn) -> Comparison;

}  // namespace capstan::tools
