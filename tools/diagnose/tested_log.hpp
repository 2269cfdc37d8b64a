// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/tools/diagnose/diagnosis.hpp"

namespace capstan::tools {

/// Errors of base and delivered law on a log that took no part, each as its file runs: that of an effort through its
/// view, a pull-push law as a board runs it. A joint's angle may have begun elsewhere: its zero is taken off.
/// @param log  without its long rests, as those that were fitted
/// @param fitted  logs that the laws were fitted to
auto tested_log(const AxisLog& log, const std::vector<AxisLog>& fitted, const Diagnosis& d) -> TestedLog;

}  // namespace capstan::tools
