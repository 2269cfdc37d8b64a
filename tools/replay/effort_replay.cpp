// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/replay/effort_replay.hpp"

namespace capstan::tools {

auto estimate_column(const std::string& target) -> std::string {
  const auto unit = target.find_last_of('_');
  return unit == std::string::npos ? target + "_est" : target.substr(0, unit) + "_est" + target.substr(unit);
}

auto replay_effort(const CsvLog& csv, int axis, const EffortLaw& law) -> std::string {
  const auto slash = law.target.find('/');
  const std::string quantity = slash == std::string::npos ? law.target : law.target.substr(slash + 1);
  AxisRequest request;
  request.axis = axis;
  request.effort = !law.of_gear();
  request.force = law.of_gear();
  request.target = axis_column(axis, quantity);
  const AxisLog log = read_axis(csv, request);
  return csv.text_with({estimate_column(request.target)}, {run_effort_law({log}, law)});
}

}  // namespace capstan::tools
