// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/tools/log/csv_log.hpp"
#include "capstan/tools/select/effort_law.hpp"

namespace capstan::tools {

/// The name of the estimate's column: "axis0/tau_est_Nm" of "axis0/tau_Nm".
auto estimate_column(const std::string& target) -> std::string;

/// Runs an effort's law over a log, the motion being given, and returns the log with the estimate appended.
/// @param axis  the log's axis; the law's own, with another number, is meant
auto replay_effort(const CsvLog& csv, int axis, const EffortLaw& law) -> std::string;

}  // namespace capstan::tools
