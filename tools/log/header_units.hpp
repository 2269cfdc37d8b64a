// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "capstan/tools/log/column_map.hpp"

namespace capstan::tools {

/// Mappings for columns that are the contract's under another spelling or in another unit: "Time [s]" is time_s,
/// "axis0/q1 [deg]" and axis0/q1_deg are axis0/q1_rad. A column that the log has under the contract's name, that
/// `given` maps, or that two columns could be, is left alone. What was found is said in `notes`.
auto mappings_by_unit(const std::vector<std::string>& names, const std::vector<ColumnMapping>& given,
                      const std::string& log, std::vector<std::string>& notes) -> std::vector<ColumnMapping>;

/// A mapping to a column as it is, whose name has a unit of the same quantity as what is wanted ("axis0/tau_Nm=Torque
/// [mNm]"), gets the factor between them. A note in `notes` says so, and how to read the numbers as they are.
/// @param names  columns of the log
void read_by_unit(ColumnMapping& mapping, const std::vector<std::string>& names, const std::string& log,
                  std::vector<std::string>& notes);

}  // namespace capstan::tools
