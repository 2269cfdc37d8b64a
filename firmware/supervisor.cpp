// SPDX-License-Identifier: Apache-2.0
#include "firmware/supervisor.hpp"

namespace capstan {
namespace {

auto trigger_of(const SupervisorInput& input) -> Trigger {
  if (input.faults != 0) {
    return input.disarm ? Trigger::kDisarm : Trigger::kFault;  // both end without torque; the operator's word is final
  }
  if (input.disarm) {
    return Trigger::kDisarm;
  }
  if (input.arm) {
    return Trigger::kArm;
  }
  if (input.experiment) {
    return Trigger::kExperimentRuns;
  }
  return input.in_motion ? Trigger::kMotionBegins : Trigger::kMotionEnds;
}

auto lowest(FaultSet faults) -> Fault {
  for (const FaultInfo& entry : kFaultTable) {
    if ((faults & bit(entry.fault)) != 0) {
      return entry.fault;
    }
  }
  return Fault::kNone;
}

}  // namespace

auto Supervisor::rt_step(const SupervisorInput& input) -> State {
  const Trigger trigger = trigger_of(input);
  for (const Transition& row : kTransitions) {
    if (row.from == state_ && row.trigger == trigger) {
      if (row.to == State::kFaulted) {
        first_fault_ = lowest(input.faults);
      } else if (row.to == State::kDisarmed) {
        first_fault_ = Fault::kNone;
      }
      state_ = row.to;
      break;
    }
  }
  return state_;
}

}  // namespace capstan
