// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "capstan/firmware/loop/axis.hpp"
#include "capstan/firmware/safety/supervisor.hpp"

namespace capstan {

/// What is asked of the machine in one cycle: the requests of its joints in their order, and those of the machine.
template <std::size_t Axes>
struct Command {
  bool arm = false;
  bool disarm = false;
  bool rest = false;          ///< torque off, and a fault stays
  bool experiment = false;    ///< the commands to the joints come from an experiment
  std::uint8_t cautious = 0;  ///< with `arm`, a bit a joint, as a Request has it
  std::array<Request, Axes> axis{};
};

/// Where an experiment is.
enum class ExperimentPhase : std::uint8_t {
  kIdle,         ///< there was none since start
  kApproaching,  ///< to its offset, and waiting there for a moment
  kRunning,
  kDone,
  kEnded,  ///< before its end: torque went away, somebody else took the joint, or it left its limits
};

/// The machine as a whole, after a cycle.
struct MachineTelemetry {
  std::uint32_t tick = 0;
  State state = State::kBoot;
  Fault first_fault = Fault::kNone;
  FaultSet conditions = 0;  ///< faults present now; while disarmed they are what blocks arming
  std::uint32_t overruns = 0;
  Q24 temperature_c = ScalarTraits<Q24>::missing();     ///< the last one measured; missing: never
  ExperimentPhase experiment = ExperimentPhase::kIdle;  ///< set by whoever runs one
  WarningSet warnings = 0;                              ///< of the machine; those of a joint are in its telemetry
};

/// Cycles that may begin late within a second before torque is taken away: one is noise, three are a pattern.
inline constexpr std::size_t kOverrunsPerSecond = 3;

/// Remembers how long ago the last overruns were, in cycles that ran.
class OverrunMonitor {
 public:
  /// @param total  overruns since start, as the board counts them; wraps
  /// @returns kOverrun while the last kOverrunsPerSecond of them lie within a second
  auto rt_step(std::uint32_t total) -> FaultSet {
    for (std::int32_t& age : ages_) {
      age = std::min(age + 1, kCycleRateHz);
    }
    const std::uint32_t fresh = std::min<std::uint32_t>(total - total_, kOverrunsPerSecond);
    for (std::uint32_t i = 0; i < fresh; ++i) {
      ages_[oldest_] = 0;
      oldest_ = (oldest_ + 1) % kOverrunsPerSecond;
    }
    total_ = total;
    return ages_[oldest_] < kCycleRateHz ? bit(Fault::kOverrun) : 0;
  }
  [[nodiscard]] auto total() const -> std::uint32_t { return total_; }

 private:
  std::array<std::int32_t, kOverrunsPerSecond> ages_ = {kCycleRateHz, kCycleRateHz, kCycleRateHz};
  std::size_t oldest_ = 0;
  std::uint32_t total_ = 0;
};

/// Everything the cycle remembers.
template <std::size_t Axes>
struct CycleState {
  explicit CycleState(const Config<Axes>& config)
      : axis([&config]<std::size_t... I>(std::index_sequence<I...>) {
          return std::array<Axis, Axes>{Axis(config[I])...};
        }(std::make_index_sequence<Axes>{})) {}

  std::array<Axis, Axes> axis;
  Supervisor supervisor;
  MachineTelemetry telemetry;
  OverrunMonitor overruns;
  FaultSet model_faults = 0;  ///< set by whoever loads parameters
  FaultSet drive_faults = 0;  ///< set by whoever writes the drive, about the last cycle
  FaultSet board_faults = 0;  ///< set by whoever knows the board, since start
};

/// What the law of axis `i` is given: its own motor and those that pull at the joint beside it, by its parameters; none
/// in most machines.
template <std::size_t Axes>
auto rt_law_input(const std::array<Axis, Axes>& axes, const std::array<const MotorState*, Axes>& motors, std::size_t i,
                  Q24 temperature_c) -> LawInput {
  FaultSet faults = motors[i]->faults;
  const auto pulls_at = [&](std::int32_t coupled_to) -> OtherMotor<Q24> {
    const auto other = static_cast<std::size_t>(coupled_to);
    if (other >= Axes || other == i) {
      return {};
    }
    faults |= motors[other]->faults;
    return {motors[other]->q1_rad, motors[other]->tau_nm, axes[other].goes_forward()};
  };
  const auto& [first, second, third] = axes[i].config().coupled_to;
  LawInput input{.measured = {.q1 = motors[i]->q1_rad,
                              .tau = motors[i]->tau_nm,
                              .others = {pulls_at(first), pulls_at(second), pulls_at(third)},
                              .temperature = temperature_c}};
  input.faults = faults;
  return input;
}

/// The joint that axis `i` turns on as a wrist's jaw; nullptr if it is none.
template <std::size_t Axes>
auto rt_pitch_of(const AxisConfig& jaw, const std::array<const JointEstimate*, Axes>& joints, std::size_t i)
    -> const JointEstimate* {
  const auto pitch = static_cast<std::size_t>(jaw.tip.pitch);
  return pitch < Axes && pitch != i ? joints[pitch] : nullptr;
}

/// The law keeps the last temperature: a thermometer that is not there, or no longer, stops nothing.
inline void rt_update_temperature(MachineTelemetry& machine, Quality quality, Q24 temperature_c) {
  if (quality == Quality::kOk) {
    machine.temperature_c = temperature_c;
  }
  const bool lost = quality != Quality::kOk && !ScalarTraits<Q24>::is_missing(machine.temperature_c);
  machine.warnings = lost ? bit(Warning::kThermometerLost) : WarningSet{0};
}

/// One cycle: estimate, supervise, control, limit; reading and writing are the caller's first and last step. What the
/// sensors say becomes a state, the state a reference, the reference a drive, each handed on to the next stage. A pure
/// function of its arguments: no clock, no I/O, no globals, so a recorded run replays bit for bit on every target.
/// Longer than a function else is: the loop is to be read as one, and it fits on a screen.
template <std::size_t Axes>
auto cycle(CycleState<Axes>& state, const Sensed<Axes>& sensed, const Command<Axes>& command) -> Drive<Axes> {
  const bool had_torque = energised(state.supervisor.state());
  std::array<const MotorState*, Axes> motor;
  std::array<const JointEstimate*, Axes> joint;
  std::array<FaultSet, Axes> joint_faults;
  bool waits = false;
  rt_update_temperature(state.telemetry, sensed.temperature, sensed.temperature_c);

  for (std::size_t i = 0; i < Axes; ++i) {
    if (!had_torque && command.axis[i].kind == Request::Kind::kZero) {
      state.axis[i].rt_zero(command.axis[i].position_rad);
    }
    motor[i] = &state.axis[i].rt_sense(sensed.axis[i]);
    waits |= state.axis[i].fitted() && !motor[i]->follows;
  }

  // What is asked of joints that are not taken over yet would be forgotten.
  const bool listens = had_torque && !(waits && state.supervisor.state() == State::kArmed);
  SupervisorInput machine{.faults = state.model_faults | state.drive_faults | state.board_faults |
                                    state.overruns.rt_step(sensed.overruns) |
                                    (sensed.estop ? bit(Fault::kEmergencyStop) : 0),
                          .arm = command.arm,
                          .waits = waits,
                          .disarm = command.disarm,
                          .experiment = command.experiment,
                          .braking = true,
                          .rest = command.rest};
  bool stops = false;
  for (std::size_t i = 0; i < Axes; ++i) {
    Axis& axis = state.axis[i];
    joint[i] = &axis.rt_estimate(*motor[i], rt_law_input(state.axis, motor, i, state.telemetry.temperature_c));
    if (listens) {
      static_cast<void>(axis.rt_command(*motor[i], *joint[i], command.axis[i]));
    }
    joint_faults[i] = axis.rt_faults(*motor[i], *joint[i], had_torque);
    machine.faults |= joint_faults[i];
    machine.in_motion |= axis.in_motion();
    machine.braking &= !axis.in_motion() || axis.braking();
    stops |= command.axis[i].kind == Request::Kind::kStop;
  }
  if (!stops) {  // a stop costs two long divisions, and the law can wait for its next turn
    state.axis[state.telemetry.tick % Axes].rt_judge_law();
  }

  const State now = state.supervisor.rt_step(machine);

  Drive<Axes> drive;
  for (std::size_t i = 0; i < Axes; ++i) {
    Axis& axis = state.axis[i];
    if (energised(now) && !had_torque) {
      axis.rt_arm(*joint[i], ((command.cautious >> i) & 1U) != 0);
    }
    const JointReference& reference = axis.rt_reference(*motor[i], *joint[i], energised(now));
    drive.axis[i] = axis.rt_drive(*motor[i], reference.torque_nm, energised(now));
    axis.rt_report(*motor[i], *joint[i], rt_pitch_of(axis.config(), joint, i), joint_faults[i]);
  }

  ++state.telemetry.tick;
  state.telemetry.state = now;
  state.telemetry.first_fault = state.supervisor.first_fault();
  state.telemetry.conditions = machine.faults;
  state.telemetry.overruns = state.overruns.total();
  return drive;
}

}  // namespace capstan
