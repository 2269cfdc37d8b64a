// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/tools/diagnose/diagnosis.hpp"
#include "capstan/tools/jobs/logs.hpp"

namespace capstan::tools {

struct DiagnoseJob {
  JobLogs logs;
  std::vector<CsvLog> tests;   ///< take no part in fit or choice
  std::string base;            ///< a name, or the path of a joint file; empty: by what is logged
  std::string target;          ///< column to explain; empty: the base law's own
  TendonDrawing drawing = {};  ///< of a joint with tendons
  bool alone = false;          ///< leaves out what other joints' channels would explain, as a board does
  Say progress = [](const std::string&) {};
};

/// Throws BadInput and Refusal.
auto diagnose(const DiagnoseJob& job, const Say& warn) -> Diagnosis;

/// Writes the delivered law, if there is one, and notes the file in the diagnosis. Returns its status, or nothing.
auto write_law(Diagnosis& diagnosis, const std::string& path) -> std::string;

}  // namespace capstan::tools
