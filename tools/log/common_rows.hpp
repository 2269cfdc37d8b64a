// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "capstan/tools/log/csv_log.hpp"

namespace capstan::tools {

/// A log whose channels have different rates has empty cells. Keeps the rows at which the slowest of `main` was really
/// measured, and puts the faster ones there on a straight line in time between their neighbours; what is said of that
/// is added to `notes`. A log without empty cells in `main` and `others` comes back as it is. Columns that the log has
/// not are passed over.
auto with_common_rows(const CsvLog& log, const std::vector<std::string>& main, const std::vector<std::string>& others,
                      std::vector<std::string>& notes) -> CsvLog;

}  // namespace capstan::tools
