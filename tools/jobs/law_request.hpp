// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "capstan/tools/jobs/logs.hpp"
#include "capstan/tools/joint_file/joint_file.hpp"

namespace capstan::tools {

/// What a job asks of every log, by the law that it starts from and the column that the law is to explain.
struct LawRequest {
  std::optional<JointFile> law = {};  ///< of a file that was given in place of a name
  AxisRequest columns;
};

/// What the law of a joint angle reads of an axis: its torque where a term does, and the axes that it is coupled to.
auto columns_of_law(const JointFile& law, int axis) -> AxisRequest;

/// @param law     its name, or the path of a joint file; empty: by what is logged
/// @param target  column to explain; empty: the law's own
/// Throws BadInput where a law is given that does not explain the target or is coupled to other axes than those asked
/// for, and Refusal for a current or a voltage, which is no effort yet.
auto request_for(const std::string& law, const std::string& target, const JobLogs& logs) -> LawRequest;

/// For logs that are taken together: an axis that moves in any of them takes the same slot in all. What is in the
/// request already keeps its slot.
void add_moving_axes(const std::vector<CsvLog>& logs, AxisRequest& request);

/// For a search of effects, which may read the torque of this axis and of those beside it: if one of the logs has it,
/// they need it all, and so do the others that are judged by their law. It would count as none there. Throws BadInput
/// with the file that lacks it.
void need_torque_of_all(const std::vector<CsvLog>& logs, const std::vector<CsvLog>& others, AxisRequest& request);

}  // namespace capstan::tools
