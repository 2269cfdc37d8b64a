// SPDX-License-Identifier: Apache-2.0
#include "capstan/firmware/safety/supervisor.hpp"

namespace capstan {
namespace {

auto trigger_of(State state, const SupervisorInput& input) -> Trigger {
  if (input.faults != 0) {
    return input.disarm ? Trigger::kDisarm : Trigger::kFault;  // both end without torque; the operator's word is final
  }
  if (input.disarm || (input.rest && state != State::kFaulted)) {
    return Trigger::kDisarm;
  }
  if (input.arm || (input.waits && state == State::kArmed)) {
    return Trigger::kArm;  // an arm that is not done goes on
  }
  if (input.experiment) {
    return Trigger::kExperimentRuns;
  }
  if (input.in_motion) {
    return input.braking ? Trigger::kMotionBrakes : Trigger::kMotionBegins;
  }
  return Trigger::kMotionEnds;
}

/// The table by state and trigger, so that no cycle searches it.
constexpr auto kNext = [] {
  std::array<std::array<State, kTriggerCount>, kStateNames.size()> next{};
  for (std::size_t state = 0; state < next.size(); ++state) {
    next[state].fill(static_cast<State>(state));
  }
  for (const Transition& row : kTransitions) {
    next[static_cast<std::size_t>(row.from)][static_cast<std::size_t>(row.trigger)] = row.to;
  }
  return next;
}();

}  // namespace

auto Supervisor::rt_step(const SupervisorInput& input) -> State {
  const Trigger trigger = state_ == State::kBoot ? Trigger::kStarted : trigger_of(state_, input);
  const State next = kNext[static_cast<std::size_t>(state_)][static_cast<std::size_t>(trigger)];
  if (next == state_) {
    return state_;
  }
  state_ = next;
  if (next == State::kFaulted) {
    first_fault_ = lowest(input.faults);
  } else if (next == State::kDisarmed) {
    first_fault_ = Fault::kNone;
  }
  return state_;
}

}  // namespace capstan
