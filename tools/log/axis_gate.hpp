// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "capstan/tools/log/axis_log.hpp"

namespace capstan::tools {

/// Every channel of an axis is looked at, and what is wrong is said in its warnings. A straight line takes the place of
/// wild values. Of a log that repeats its rows, and of a joint's channel that is held among faster ones, as a camera's
/// is, only the rows with new values stay, and all of them where no target is needed. Where the request asks for every
/// row, all stays.
/// @param q1  the motor angle's column
void pass_gate(const CsvLog& csv, const AxisRequest& request, const std::string& q1, AxisLog& axis);

}  // namespace capstan::tools
