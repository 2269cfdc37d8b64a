// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "capstan/firmware/safety/faults.hpp"

namespace capstan {

/// What the machine may do. The joint has torque in kArmed, kHolding, kMoving, kStopping and kExperiment only. Numbers
/// are append-only: they are in logs.
enum class State : std::uint8_t {
  kDisarmed,    ///< bridge off; safe state of start-up and of every refusal
  kArmed,       ///< bridge on, every joint is taken over where it stands; until every amplifier follows
  kHolding,     ///< bridge on, every joint stands at its reference
  kFaulted,     ///< bridge off after a fault, until the operator disarms
  kExperiment,  ///< bridge on, a recipe moves a joint
  kBoot,        ///< bridge off, before the first cycle
  kMoving,      ///< bridge on, a joint is moving or following references
  kStopping,    ///< bridge on, whatever still moves brakes
};
inline constexpr std::array<const char*, 8> kStateNames = {"disarmed",   "armed", "holding", "faulted",
                                                           "experiment", "boot",  "moving",  "stopping"};
constexpr auto name(State state) -> const char* {
  return kStateNames[static_cast<std::size_t>(state)];
}
constexpr auto energised(State state) -> bool {
  return state != State::kDisarmed && state != State::kFaulted && state != State::kBoot;
}

/// What can change the state.
enum class Trigger : std::uint8_t {
  kStarted,  ///< the first cycle
  kFault,
  kDisarm,
  kArm,
  kExperimentRuns,
  kMotionBegins,
  kMotionBrakes,
  kMotionEnds,
};
inline constexpr std::size_t kTriggerCount = 8;

struct Transition {
  State from;
  Trigger trigger;
  State to;
};

/// Every change of state there is; whatever is not listed changes nothing.
inline constexpr std::array<Transition, 24> kTransitions = {{
    {State::kBoot, Trigger::kStarted, State::kDisarmed},
    {State::kDisarmed, Trigger::kArm, State::kArmed},
    {State::kArmed, Trigger::kMotionBegins, State::kMoving},
    {State::kArmed, Trigger::kMotionEnds, State::kHolding},
    {State::kArmed, Trigger::kDisarm, State::kDisarmed},
    {State::kArmed, Trigger::kFault, State::kFaulted},
    {State::kHolding, Trigger::kMotionBegins, State::kMoving},
    {State::kHolding, Trigger::kExperimentRuns, State::kExperiment},
    {State::kHolding, Trigger::kDisarm, State::kDisarmed},
    {State::kHolding, Trigger::kFault, State::kFaulted},
    {State::kMoving, Trigger::kMotionBrakes, State::kStopping},
    {State::kMoving, Trigger::kMotionEnds, State::kHolding},
    {State::kMoving, Trigger::kDisarm, State::kDisarmed},
    {State::kMoving, Trigger::kFault, State::kFaulted},
    {State::kStopping, Trigger::kMotionBegins, State::kMoving},
    {State::kStopping, Trigger::kMotionEnds, State::kHolding},
    {State::kStopping, Trigger::kDisarm, State::kDisarmed},
    {State::kStopping, Trigger::kFault, State::kFaulted},
    {State::kExperiment, Trigger::kMotionBegins, State::kMoving},
    {State::kExperiment, Trigger::kMotionBrakes, State::kStopping},
    {State::kExperiment, Trigger::kMotionEnds, State::kHolding},
    {State::kExperiment, Trigger::kDisarm, State::kDisarmed},
    {State::kExperiment, Trigger::kFault, State::kFaulted},
    {State::kFaulted, Trigger::kDisarm, State::kDisarmed},
}};

/// What the supervisor is told in one cycle.
struct SupervisorInput {
  FaultSet faults = 0;      ///< conditions present now, of all axes and of the board
  bool arm = false;         ///< the operator asks for torque
  bool waits = false;       ///< some amplifier that was enabled does not follow its set value yet
  bool disarm = false;      ///< the operator asks for rest; also acknowledges a fault
  bool experiment = false;  ///< a recipe runs
  bool in_motion = false;   ///< some joint's reference is moving
  bool braking = false;     ///< and whatever moves was told to stop
  bool rest = false;        ///< something else than the operator asks for rest: a fault stays, or is latched
};

/// Gate of the torque: one table of states. The first fault is kept until the operator disarms.
class Supervisor {
 public:
  auto rt_step(const SupervisorInput& input) -> State;
  [[nodiscard]] auto state() const -> State { return state_; }
  [[nodiscard]] auto first_fault() const -> Fault { return first_fault_; }

 private:
  State state_ = State::kBoot;
  Fault first_fault_ = Fault::kNone;
};

}  // namespace capstan
