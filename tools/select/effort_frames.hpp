// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/tools/select/effort_law.hpp"

namespace capstan::tools {

/// A law without terms, and its logs as it sees them.
struct Frame {
  EffortLaw law;
  EffortDesign design;
};

/// Of the error: what another view of a log must bring; as much as a part must to be kept.
inline constexpr double kWorthAnotherView = 0.01;

auto axis_kind(const std::vector<AxisLog>& logs) -> AxisKind;

/// How the logs of an effort, or of a gear, may be looked at: as is usual, a gear's motor late or early as a plain law
/// says, and, where the log shows that its motor rests otherwise, that way too.
auto frames_for(const std::vector<AxisLog>& logs) -> std::vector<Frame>;

}  // namespace capstan::tools
