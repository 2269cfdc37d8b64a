// SPDX-License-Identifier: Apache-2.0
#include "capstan/hal/cia402/drive_link.hpp"

#include <algorithm>

namespace capstan::cia402 {
namespace {

constexpr std::uint32_t kCyclesToEnable = 200;
// A drive whose slow loop looks at the controlword every few ms must see the edge; and one reset has to be enough to
// tell whether the cause is gone.
constexpr std::uint32_t kCyclesBetweenResets = 500;
constexpr std::uint32_t kCyclesOfReset = 10;
constexpr std::uint32_t kCyclesOfCalm = 100;  // without a contradiction, before a drive is believed again
constexpr std::int64_t kPermilleMaPerA = 1'000'000;

auto signed16(std::uint32_t value) -> std::int16_t {
  return static_cast<std::int16_t>(static_cast<std::uint16_t>(value));
}

}  // namespace

DriveLink::DriveLink(const DriveSetting& setting, Journal& journal, std::size_t source)
    : setting_(setting), journal_(journal), source_(source) {}

void DriveLink::rt_lose(Anomaly why, std::uint32_t detail) {
  journal_.note(why, source_, detail);
  lost_ = true;
}

void DriveLink::rt_status(const Frame& frame, Time arrived, Time sync) {
  if (frame.size != setting_.maps.status.bytes()) {
    journal_.note(Anomaly::kStatusLength, source_, frame.size);
    return;
  }
  if (arrived < sync) {
    journal_.note(Anomaly::kStatusLate, source_);
    return;
  }
  if (fresh_) {
    const bool same = frame.data == status_.data;
    journal_.note(same ? Anomaly::kStatusRepeated : Anomaly::kStatusContradicts, source_);
    contradicted_ |= !same;
    return;
  }
  status_ = frame;
  fresh_ = true;
}

void DriveLink::rt_heartbeat(const Frame& frame, Time arrived) {
  if (frame.size != 1) {
    journal_.note(Anomaly::kHeartbeatLength, source_, frame.size);
    return;
  }
  switch (static_cast<NmtState>(frame.data[0])) {
    case NmtState::kOperational:
      last_heartbeat_ = arrived;
      heard_ = true;
      return;
    case NmtState::kBootUp:
      rt_lose(Anomaly::kRestarted, 0);
      return;
    case NmtState::kStopped:
    case NmtState::kPreOperational:
      rt_lose(Anomaly::kNotOperational, frame.data[0]);
      return;
  }
  journal_.note(Anomaly::kHeartbeatState, source_, frame.data[0]);
}

void DriveLink::rt_emergency(const Frame& frame) {
  if (frame.size != 8) {
    journal_.note(Anomaly::kEmergencyLength, source_, frame.size);
    return;
  }
  journal_.note(Emergency{static_cast<std::uint16_t>(get_bytes(frame, 0, 2)), frame.data[2]}, source_);
}

void DriveLink::rt_enter(std::uint16_t statusword) {
  const DriveState before = state_;
  state_ = drive_state(statusword);
  if (state_ != before && state_ == DriveState::kUnknown) {
    journal_.note(Anomaly::kStatusUnknown, source_, statusword);
  }
  if (state_ != before && state_ == DriveState::kFault) {
    journal_.note(Anomaly::kDriveFault, source_, statusword);
  }
}

auto DriveLink::rt_sense(Time now, bool answer_due) -> AxisSensed {
  if (!heard_) {
    last_heartbeat_ = now;  // it was operational when it was set up
    heard_ = true;
  }
  if (!lost_ && now - last_heartbeat_ > kHeartbeatTimeout) {
    rt_lose(Anomaly::kHeartbeatLost, 0);
  }
  cycles_of_doubt_ -= cycles_of_doubt_ > 0 ? 1 : 0;
  AxisSensed sensed;
  if (!fresh_) {
    if (answer_due) {
      journal_.note(Anomaly::kStatusMissing, source_);
    }
    return sensed;
  }
  fresh_ = false;
  if (contradicted_) {
    contradicted_ = false;
    cycles_of_doubt_ = kCyclesOfCalm;
    sensed.encoder = Quality::kInvalid;
    sensed.current = Quality::kInvalid;
    return sensed;
  }
  // The layout is drive_maps()'s: statusword, position, torque.
  rt_enter(static_cast<std::uint16_t>(get_bytes(status_, 0, 2)));
  sensed.encoder_counts = static_cast<std::int32_t>(get_bytes(status_, 2, 4));
  const std::int64_t permille = signed16(get_bytes(status_, 6, 2));
  const std::int64_t scaled = permille * setting_.rated_current_ma * (std::int64_t{1} << Q24::kFrac);
  sensed.current_a = Q24::from_wide(scaled / kPermilleMaPerA);
  sensed.encoder = Quality::kOk;
  sensed.current = Quality::kOk;
  return sensed;
}

auto DriveLink::rt_rest() -> Command {
  cycles_waiting_ = 0;
  reached_ = false;
  dropped_ = false;
  if (state_ != DriveState::kFault || lost_) {
    cycles_in_fault_ = 0;
    return {};
  }
  const std::uint32_t phase = ++cycles_in_fault_ % kCyclesBetweenResets;
  return {.controlword =
              phase >= kCyclesBetweenResets - kCyclesOfReset ? controlword::kFaultReset : controlword::kDisableVoltage,
          .torque_permille = 0};
}

auto DriveLink::rt_command(const AxisDrive& drive) -> Command {
  if (!drive.enabled) {
    return rt_rest();
  }
  if (state_ == DriveState::kOperationEnabled) {
    reached_ = true;
  } else if (rt_sound() && (reached_ || ++cycles_waiting_ > kCyclesToEnable)) {
    journal_.note(reached_ ? Anomaly::kDroppedOut : Anomaly::kNotEnabled, source_, get_bytes(status_, 0, 2));
    dropped_ = true;
  }
  if (!rt_sound()) {
    return {};
  }
  Command command{.controlword = towards_torque(state_), .torque_permille = 0};
  if (reached_) {
    const std::int64_t scaled = std::int64_t{drive.current_a.raw()} * kPermilleMaPerA / setting_.rated_current_ma;
    const std::int64_t permille = shift_right_rounded<Q24::kFrac>(scaled);
    command.torque_permille = static_cast<std::int16_t>(std::clamp<std::int64_t>(permille, INT16_MIN, INT16_MAX));
  }
  return command;
}

}  // namespace capstan::cia402
