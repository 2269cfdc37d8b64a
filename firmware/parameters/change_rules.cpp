// SPDX-License-Identifier: Apache-2.0
// Who may change what, and when.
#include "capstan/firmware/parameters/parameters.hpp"
#include "capstan/firmware/safety/motor_observer.hpp"

namespace capstan {
namespace {

/// With another scale the observer's values and the limits of the motor's angle are no longer those that somebody
/// vouched for. Until there are such values nobody gets torque outside maintenance.
auto is_safety_limit(const ParameterInfo& parameter, const AxisConfig& now) -> bool {
  const bool scale =
      parameter.offset == offsetof(AxisConfig, motor) + offsetof(MotorConfig, encoder_counts_per_turn) ||
      parameter.offset == offsetof(AxisConfig, motor) + offsetof(MotorConfig, encoder_sign) ||
      parameter.offset == offsetof(AxisConfig, motor) + offsetof(MotorConfig, torque_per_current_nm_per_a);
  return parameter.change == ParameterChange::kMaintenance || (scale && MotorObserver::commissioned(now.observer));
}

}  // namespace

auto needs_rest(const AxisConfig& now, const AxisConfig& next) -> bool {
  for (const ParameterInfo& parameter : parameters()) {
    if (parameter.change != ParameterChange::kAnyTime && raw_value(now, parameter) != raw_value(next, parameter)) {
      return true;
    }
  }
  return false;
}

auto changed_safety_limit(const AxisConfig& now, const AxisConfig& next) -> const ParameterInfo* {
  for (const ParameterInfo& parameter : parameters()) {
    if (raw_value(now, parameter) != raw_value(next, parameter) && is_safety_limit(parameter, now)) {
      return &parameter;
    }
  }
  return nullptr;
}

auto judge_change(const AxisConfig& now, const AxisConfig& next, Rights rights, bool live) -> SetAnswer {
  using Refusal = SetAnswer::Refusal;
  if (live && needs_rest(now, next)) {
    return {.refusal = Refusal::kNeedsRest};
  }
  const ParameterInfo* limit = changed_safety_limit(now, next);
  if (limit != nullptr && rights != Rights::kMaintenance) {
    return {.refusal = Refusal::kSafetyLimit, .limit = limit};
  }
  const char* reason = check(next);
  return reason == nullptr ? SetAnswer{}
                           : SetAnswer{.refusal = Refusal::kInconsistent, .reason = reason, .grid = check_grid(next)};
}

}  // namespace capstan
