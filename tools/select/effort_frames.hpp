// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

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

/// Every way in which the logs of an effort, or of a gear, may be looked at, the usual one first: how slow a motor
/// stands, how soon the dry friction of its last motion lets go then, and a gear's motor late or early as a plain law
/// says.
auto all_frames(const std::vector<AxisLog>& logs) -> std::vector<Frame>;

/// The frame of least error, the first unless another has less by kWorthAnotherView.
auto best_frame(const std::vector<Frame>& frames, const std::function<double(const Frame&)>& error) -> std::size_t;

/// The usual frame and, where the log shows another to a plain law, that too.
auto frames_for(const std::vector<AxisLog>& logs) -> std::vector<Frame>;

}  // namespace capstan::tools
