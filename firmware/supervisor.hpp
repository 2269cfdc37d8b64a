// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "firmware/faults.hpp"

namespace capstan {

/// What the machine may do. The joint has torque in kArmed, kHolding and kExperiment only. Numbers are append-only:
/// they are in logs.
enum class State : std::uint8_t {
  kDisarmed,    ///< bridge off; safe state of start-up and of every refusal
  kArmed,       ///< bridge on, a joint is moving or following references
  kHolding,     ///< bridge on, every joint stands at its reference
  kFaulted,     ///< bridge off after a fault, until the operator disarms
  kExperiment,  ///< bridge on, a recipe moves a joint
};
inline constexpr std::array<const char*, 5> kStateNames = {"disarmed", "armed", "holding", "faulted", "experiment"};
constexpr auto name(State state) -> const char* {
  return kStateNames[static_cast<std::size_t>(state)];
}
constexpr auto energised(State state) -> bool {
  return state == State::kArmed || state == State::kHolding || state == State::kExperiment;
}

/// What can change the state.
enum class Trigger : std::uint8_t { kFault, kDisarm, kArm, kExperimentRuns, kMotionBegins, kMotionEnds };

struct Transition {
  State from;
  Trigger trigger;
  State to;
};

/// Every change of state there is; whatever is not listed changes nothing.
inline constexpr std::array<Transition, 13> kTransitions = {{
    {State::kDisarmed, Trigger::kArm, State::kHolding},
    {State::kHolding, Trigger::kMotionBegins, State::kArmed},
    {State::kArmed, Trigger::kMotionEnds, State::kHolding},
    {State::kHolding, Trigger::kDisarm, State::kDisarmed},
    {State::kArmed, Trigger::kDisarm, State::kDisarmed},
    {State::kFaulted, Trigger::kDisarm, State::kDisarmed},
    {State::kHolding, Trigger::kFault, State::kFaulted},
    {State::kArmed, Trigger::kFault, State::kFaulted},
    {State::kHolding, Trigger::kExperimentRuns, State::kExperiment},
    {State::kExperiment, Trigger::kMotionBegins, State::kArmed},
    {State::kExperiment, Trigger::kMotionEnds, State::kHolding},
    {State::kExperiment, Trigger::kDisarm, State::kDisarmed},
    {State::kExperiment, Trigger::kFault, State::kFaulted},
}};

/// What the supervisor is told in one cycle.
struct SupervisorInput {
  FaultSet faults = 0;      ///< conditions present now, of all axes and of the board
  bool arm = false;         ///< the operator asks for torque
  bool disarm = false;      ///< the operator asks for rest; also acknowledges a fault
  bool experiment = false;  ///< a recipe runs
  bool in_motion = false;   ///< some joint's reference is moving
};

/// Gate of the torque: one table of states. The first fault is kept until the operator disarms.
class Supervisor {
 public:
  auto rt_step(const SupervisorInput& input) -> State;
  [[nodiscard]] auto state() const -> State { return state_; }
  [[nodiscard]] auto first_fault() const -> Fault { return first_fault_; }

 private:
  State state_ = State::kDisarmed;
  Fault first_fault_ = Fault::kNone;
};

}  // namespace capstan
