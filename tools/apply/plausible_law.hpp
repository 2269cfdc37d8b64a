// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "capstan/tools/joint_file/joint_file.hpp"

namespace capstan::tools {

/// Why no joint should run under this law, in a sentence without a cure; empty: nothing speaks against it. The law
/// itself is swept slowly over the motor's range of the logs it was fitted to, under its steady torque: a joint that
/// runs against its motor for more than a tenth of its way (behind the law's lost motion), or ten times as far as it
/// went in the logs, or is as far away from its zero, is none. A file without [fit] is swept over a radian either way,
/// and only asked for the direction. A ratio whose own interval lies on the other side of zero was turned round.
auto implausible(const JointFile& joint) -> std::string;

}  // namespace capstan::tools
