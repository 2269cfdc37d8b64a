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

/// Of a law of these logs: of an effort, or of the torque behind a gear.
auto catalogue_for(const std::vector<AxisLog>& logs) -> const Catalogue&;

/// How the logs of an effort, or of a gear, may be looked at: as is usual, and, where the error is less by
/// kWorthAnotherView, with another standstill, at which dry friction lets go sooner or later. A gear's motor is late or
/// early as a plain law says.
auto frames_by(const std::vector<AxisLog>& logs, const std::function<double(const Frame&)>& error)
    -> std::vector<Frame>;

/// By the error of a plain law.
auto frames_for(const std::vector<AxisLog>& logs) -> std::vector<Frame>;

}  // namespace capstan::tools
