// SPDX-License-Identifier: Apache-2.0
#include "capstan/hal/cia402/drive_link.hpp"

#include <algorithm>

namespace capstan::cia402 {
namespace {

constexpr std::uint32_t kCyclesToEnable = 200;
constexpr std::uint32_t kCyclesToShowMode = 1200;  // SDO answers may take more than 250 ms
constexpr std::uint32_t kTimesToAsk = 5;           // a mode may show a little later than the state
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

void DriveLink::rt_status(const Frame& frame, Time arrived, Time sync, std::size_t part) {
  if (frame.size != setting_.maps.status[part].bytes()) {
    journal_.note(Anomaly::kStatusLength, source_, frame.size);
    return;
  }
  if (arrived < sync) {
    journal_.note(Anomaly::kStatusLate, source_);
    return;
  }
  if (fresh_[part]) {
    const bool same = frame.data == status_[part].data;
    journal_.note(same ? Anomaly::kStatusRepeated : Anomaly::kStatusContradicts, source_);
    contradicted_ |= !same;
    return;
  }
  status_[part] = frame;
  fresh_[part] = true;
}

auto DriveLink::rt_value(const Object& object) const -> std::uint32_t {
  for (std::size_t part = 0; part < kMostStatusParts; ++part) {
    if (const auto at = setting_.maps.status[part].offset(object)) {
      return get_bytes(status_[part], *at, object.bytes);
    }
  }
  return 0;
}

void DriveLink::rt_heartbeat(const Frame& frame, Time arrived) {
  if (frame.size != 1) {
    journal_.note(Anomaly::kHeartbeatLength, source_, frame.size);
    return;
  }
  switch (static_cast<NmtState>(frame.data[0])) {
    case NmtState::kOperational:
      last_heartbeat_ = std::max(last_heartbeat_, arrived);  // a clock that was set makes one that waited look old
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
  if (state_ != before) {
    if (cycles_unanswered_ != 0) {
      fastest_answer_ = std::min(fastest_answer_, cycles_unanswered_);
    }
    cycles_unanswered_ = 0;
  }
  if (state_ != before && state_ == DriveState::kUnknown) {
    journal_.note(Anomaly::kStatusUnknown, source_, statusword);
  }
  if (state_ != before && state_ == DriveState::kFault) {
    journal_.note(Anomaly::kDriveFault, source_, statusword);
  }
}

auto DriveLink::rt_sense(Time now, bool answer_due) -> AxisSensed {
  if (!looked_) {
    last_heartbeat_ = now;  // it was operational when it was set up, however long ago that is
    looked_ = true;
  }
  if (!lost_ && now - last_heartbeat_ > kHeartbeatTimeout) {
    rt_lose(Anomaly::kHeartbeatLost, 0);
  }
  cycles_of_doubt_ -= cycles_of_doubt_ > 0 ? 1 : 0;
  const bool complete = fresh_[0] && (fresh_[1] || setting_.maps.status[1].count == 0);
  fresh_.fill(false);  // one half of this cycle and one of the next are no whole
  AxisSensed sensed;
  sensed.follows = rt_follows();
  if (contradicted_) {
    contradicted_ = false;
    cycles_of_doubt_ = kCyclesOfCalm;
    sensed.encoder = Quality::kInvalid;
    sensed.current = Quality::kInvalid;
    return sensed;
  }
  if (!complete) {
    if (answer_due) {
      journal_.note(Anomaly::kStatusMissing, source_);
    }
    return sensed;
  }
  rt_enter(static_cast<std::uint16_t>(rt_value(object::kStatusword)));
  sensed.encoder_counts = static_cast<std::int32_t>(rt_value(object::kPosition));
  const std::int64_t permille = signed16(rt_value(object::kTorque));
  const std::int64_t scaled = permille * setting_.rated_current_ma * (std::int64_t{1} << Q24::kFrac);
  sensed.current_a = Q24::from_wide(scaled / kPermilleMaPerA);
  sensed.encoder = Quality::kOk;
  sensed.current = Quality::kOk;
  sensed.follows = rt_follows();
  return sensed;
}

auto DriveLink::rt_follows() const -> bool {
  return state_ == DriveState::kOperationEnabled && (!setting_.asks_mode || mode_ == Mode::kRight);
}

auto DriveLink::rt_rest() -> Command {
  cycles_waiting_ = 0;
  cycles_unanswered_ = 0;
  fastest_answer_ = UINT32_MAX;
  reached_ = false;
  dropped_ = false;
  mode_ = Mode::kUnknown;
  times_asked_ = 0;
  if (state_ != DriveState::kFault || lost_) {
    cycles_in_fault_ = 0;
    return {};
  }
  const std::uint32_t phase = ++cycles_in_fault_ % kCyclesBetweenResets;
  return {.controlword =
              phase >= kCyclesBetweenResets - kCyclesOfReset ? controlword::kFaultReset : controlword::kDisableVoltage,
          .torque_permille = 0};
}

void DriveLink::rt_drop(Anomaly why) {
  journal_.note(why, source_, rt_value(object::kStatusword));
  dropped_ = true;
}

// Towards operation enabled, and that it stays so.
void DriveLink::rt_await() {
  ++cycles_unanswered_;
  if (state_ != DriveState::kOperationEnabled) {
    if (rt_sound() && (reached_ || ++cycles_waiting_ > kCyclesToEnable)) {
      rt_drop(reached_ ? Anomaly::kDroppedOut : Anomaly::kNotEnabled);
    }
    return;
  }
  if (!reached_ && rt_sound() && fastest_answer_ > setting_.most_cycles_to_answer) {
    rt_drop(Anomaly::kAnswersLate);
  }
  reached_ = true;
}

// Not before a drive that shows its mode only now has shown the right one.
auto DriveLink::rt_gives_torque() -> bool {
  if (!reached_ || !setting_.asks_mode || mode_ == Mode::kRight) {
    return reached_;
  }
  if (mode_ == Mode::kUnknown) {
    mode_ = Mode::kToAsk;
    cycles_waiting_ = 0;
  } else if (++cycles_waiting_ > kCyclesToShowMode && rt_sound()) {
    rt_drop(Anomaly::kModeUnknown);
  }
  return false;
}

auto DriveLink::rt_asks_mode() -> bool {
  const bool now = mode_ == Mode::kToAsk && rt_sound();
  mode_ = now ? Mode::kAsked : mode_;
  return now;
}

void DriveLink::rt_mode(const Frame& frame) {
  constexpr std::uint8_t kReadAnswer = 0x40;
  constexpr std::uint8_t kExpedited = 0x02;
  constexpr std::uint8_t kKind = 0xE2;
  if (mode_ != Mode::kAsked || frame.size != 8 || get_bytes(frame, 1, 2) != object::kModeDisplay.index) {
    journal_.note(Anomaly::kSdoUnexpected, source_);
    return;
  }
  if ((frame.data[0] & kKind) == (kReadAnswer | kExpedited) && frame.data[4] == kTorqueMode) {
    mode_ = Mode::kRight;
  } else if (++times_asked_ < kTimesToAsk) {
    mode_ = Mode::kToAsk;
  } else {
    rt_lose(Anomaly::kWrongMode, frame.data[4]);
  }
}

auto DriveLink::rt_command(const AxisDrive& drive) -> Command {
  if (!drive.enabled) {
    return rt_rest();
  }
  rt_await();
  const bool torque = rt_gives_torque();
  if (!rt_sound()) {
    return {};
  }
  Command command{.controlword = towards_torque(state_), .torque_permille = 0};
  if (torque) {
    const std::int64_t scaled = std::int64_t{drive.current_a.raw()} * kPermilleMaPerA / setting_.rated_current_ma;
    const std::int64_t permille = shift_right_rounded<Q24::kFrac>(scaled);
    const std::int64_t most = setting_.max_torque_permille;
    command.torque_permille = static_cast<std::int16_t>(std::clamp<std::int64_t>(permille, -most, most));
  }
  return command;
}

}  // namespace capstan::cia402
