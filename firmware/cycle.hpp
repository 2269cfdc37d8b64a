// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "firmware/axis.hpp"
#include "firmware/supervisor.hpp"

namespace capstan {

/// What the operator or the host asks of the machine in one cycle.
template <std::size_t Axes>
struct Command {
  bool arm = false;
  bool disarm = false;
  bool experiment = false;  ///< the commands to the joints come from an experiment
  std::array<AxisCommand, Axes> axis{};
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

/// The axis whose motor pulls at axis `i`, by its parameters; nullptr if there is none.
template <std::size_t Axes>
auto coupled_axis(const std::array<Axis, Axes>& axes, std::size_t i) -> const Axis* {
  const auto other = static_cast<std::size_t>(axes[i].config().coupled_to);
  return other < Axes && other != i ? &axes[other] : nullptr;
}

/// The law keeps the last temperature: a thermometer that is not there, or no longer, stops nothing.
inline void rt_feel(MachineTelemetry& machine, Quality quality, Q24 temperature_c) {
  if (quality == Quality::kOk) {
    machine.temperature_c = temperature_c;
  }
  const bool lost = quality != Quality::kOk && !ScalarTraits<Q24>::is_missing(machine.temperature_c);
  machine.warnings = lost ? bit(Warning::kThermometerLost) : WarningSet{0};
}

/// One cycle: estimate, supervise, control, limit; reading and writing are the caller's first and last step. A pure
/// function of its arguments: no clock, no I/O, no globals, so a recorded run replays bit for bit on every target.
template <std::size_t Axes>
auto cycle(CycleState<Axes>& state, const Sensed<Axes>& sensed, const Command<Axes>& command) -> Drive<Axes> {
  const bool had_torque = energised(state.supervisor.state());
  FaultSet faults =
      state.model_faults | state.drive_faults | state.board_faults | state.overruns.rt_step(sensed.overruns);
  faults |= sensed.estop ? bit(Fault::kEmergencyStop) : 0;
  bool in_motion = false;
  bool goes_on = false;
  bool stops = false;
  rt_feel(state.telemetry, sensed.temperature, sensed.temperature_c);

  for (std::size_t i = 0; i < Axes; ++i) {
    if (!had_torque && command.axis[i].kind == AxisCommand::Kind::kZero) {
      state.axis[i].rt_zero(command.axis[i].position_rad);
    }
    state.axis[i].rt_sense(sensed.axis[i]);
  }
  for (std::size_t i = 0; i < Axes; ++i) {
    state.axis[i].rt_estimate(coupled_axis(state.axis, i), state.telemetry.temperature_c);
    if (had_torque) {
      static_cast<void>(state.axis[i].rt_command(command.axis[i]));
    }
    faults |= state.axis[i].rt_faults(had_torque);
    in_motion |= state.axis[i].in_motion();
    stops |= command.axis[i].kind == AxisCommand::Kind::kStop;
    goes_on |= state.axis[i].in_motion() && !state.axis[i].braking();
  }

  if (!stops) {  // a stop costs two long divisions, and the law can wait for its next turn
    state.axis[state.telemetry.tick % Axes].rt_judge_law();
  }

  const State now =
      state.supervisor.rt_step({faults, command.arm, command.disarm, command.experiment, in_motion, !goes_on});

  Drive<Axes> drive;
  for (std::size_t i = 0; i < Axes; ++i) {
    Axis& axis = state.axis[i];
    if (energised(now) && !had_torque) {
      axis.rt_arm();
    }
    const Q24 torque = energised(now) ? axis.rt_control() : Q24{};
    drive.axis[i] = axis.rt_limit(torque, energised(now));
  }

  ++state.telemetry.tick;
  state.telemetry.state = now;
  state.telemetry.first_fault = state.supervisor.first_fault();
  state.telemetry.conditions = faults;
  state.telemetry.overruns = state.overruns.total();
  return drive;
}

}  // namespace capstan
