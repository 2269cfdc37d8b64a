// SPDX-License-Identifier: Apache-2.0
#include "capstan/hal/cia402/drive_setup.hpp"

#include <array>
#include <cstdio>

namespace capstan::cia402 {
namespace {

using Action = SetupStep::Action;

constexpr std::uint32_t kNotValid = 0x80000000;  // of a PDO, in its COB-ID
constexpr std::uint32_t kNoRemote = 0x40000000;  // drives may keep it or not
constexpr std::size_t kPdosOfMostDrives = 4;
constexpr std::int32_t kMostRatedMa = 127'000;  // what the firmware's numbers hold

auto hex(std::uint32_t value, int digits) -> std::string {
  std::array<char, 16> text{};
  static_cast<void>(std::snprintf(text.data(), text.size(), "%0*X", digits, value));
  return text.data();
}

auto value_text(std::uint32_t value) -> std::string {
  return std::to_string(value) + " (" + hex(value, 4) + "h)";
}

// The order is the standard's: not valid, no objects, objects, their number, how it is triggered, valid (CiA
// 301 7.5.2.36).
void add_pdo(std::vector<SetupStep>& steps, const PdoMap& map, std::uint16_t communication, std::uint16_t mapping,
             std::uint32_t flags, std::size_t number) {
  const auto com = static_cast<std::uint16_t>(communication + number);
  const auto list = static_cast<std::uint16_t>(mapping + number);
  const Object id{com, 1, 4, "PDO identifier"};
  steps.push_back({Action::kWrite, id, map.id | flags | kNotValid, ~kNoRemote});
  steps.push_back({Action::kWrite, {list, 0, 1, "number of mapped objects"}, 0});
  for (std::size_t i = 0; i < map.count; ++i) {
    steps.push_back({Action::kWrite, {list, static_cast<std::uint8_t>(i + 1), 4, "mapped object"}, map.word(i)});
  }
  steps.push_back({Action::kWrite, {list, 0, 1, "number of mapped objects"}, map.count});
  steps.push_back({Action::kWrite, {com, 2, 1, "PDO transmission type"}, map.transmission});
  steps.push_back({Action::kWrite, id, map.id | flags, ~kNoRemote});
}

// What the drive's maker or somebody before us left switched on would load the bus or move the motor.
void silence_pdos(std::vector<SetupStep>& steps, std::uint16_t communication, std::size_t from) {
  for (std::size_t i = from; i < kPdosOfMostDrives; ++i) {
    steps.push_back({Action::kWriteIfAny,
                     {static_cast<std::uint16_t>(communication + i), 1, 4, "PDO identifier"},
                     kNotValid,
                     kNotValid});
  }
}

}  // namespace

auto setup_steps(const DriveMaps& maps) -> std::vector<SetupStep> {
  constexpr std::uint32_t kTorqueMode = 10;
  const auto timeout_ms = static_cast<std::uint32_t>(kHeartbeatTimeout.count());
  std::vector<SetupStep> steps = {
      {Action::kExpect, {0x1000, 0, 4, "device type (a drive, 402)"}, 402, 0xFFFF},
      {Action::kExpect, {0x6502, 0, 4, "supported modes (cyclic synchronous torque, bit 9)"}, 0x200, 0x200},
      {Action::kLearn, {0x6075, 0, 4, "motor rated current"}},
      {Action::kWrite, {0x1016, 1, 4, "consumer heartbeat time"}, std::uint32_t{kMasterNode} << 16U | timeout_ms},
      {Action::kWrite, {0x1017, 0, 2, "producer heartbeat time"}, static_cast<std::uint32_t>(kHeartbeatPeriod.count())},
      {Action::kWrite, {0x6007, 0, 2, "abort connection option code"}, 1},  // fault
      {Action::kWrite, {0x605A, 0, 2, "quick stop option code"}, 0},        // torque off
      {Action::kWrite, {0x605E, 0, 2, "fault reaction option code"}, 0},    // torque off
      {Action::kWrite, {0x6060, 0, 1, "mode of operation"}, kTorqueMode},
      {Action::kWrite, {0x60C2, 1, 1, "interpolation time"}, 1},  // 1 x 10^-3 s
      {Action::kWrite, {0x60C2, 2, 1, "interpolation time exponent"}, 0xFD},
  };
  add_pdo(steps, maps.torque, 0x1400, 0x1600, 0, 0);
  const bool two = maps.controlword.count != 0;
  if (two) {
    add_pdo(steps, maps.controlword, 0x1400, 0x1600, 0, 1);
  }
  silence_pdos(steps, 0x1400, two ? 2 : 1);
  add_pdo(steps, maps.status, 0x1800, 0x1A00, kNoRemote, 0);
  silence_pdos(steps, 0x1800, 1);
  steps.push_back({Action::kExpect, {0x6061, 0, 1, "mode of operation display"}, kTorqueMode});
  return steps;
}

DriveSetup::DriveSetup(std::uint8_t node, const DriveMaps& maps, Journal& journal, std::size_t source)
    : node_(node), maps_(maps), steps_(setup_steps(maps)), sdo_(node, journal, source) {}

void DriveSetup::fail(const std::string& problem) {
  problem_ = "Drive " + std::to_string(node_) + ' ' + problem;
  phase_ = Phase::kFailed;
}

void DriveSetup::fail_object(const Object& object, const std::string& what, const std::string& cure) {
  fail(what + " object " + hex(object.index, 4) + ':' + hex(object.subindex, 2) + ", " + object.name + "; " + cure);
}

auto DriveSetup::next(Time now) -> std::optional<Frame> {
  if (!since_ && phase_ == Phase::kRestarting) {
    since_ = now;
    return nmt_frame(NmtCommand::kResetCommunication, node_);
  }
  if (phase_ == Phase::kRestarting && booted_) {
    booted_ = false;
    ready_ = now + kSettling;
  }
  if (phase_ == Phase::kRestarting && ready_ && now >= *ready_) {
    phase_ = Phase::kConfiguring;
  }
  if (!since_ && phase_ == Phase::kStarting) {
    since_ = now;
    return nmt_frame(NmtCommand::kStart, node_);
  }
  if (phase_ == Phase::kConfiguring) {
    return next_request(now);
  }
  if (phase_ == Phase::kRestarting && now - *since_ > kPatience) {
    fail("did not start; check its supply, node number, bit rate and cable");
  }
  if (phase_ == Phase::kStarting && now - *since_ > kPatience) {
    fail("did not become operational; check its manual for what keeps it from that");
  }
  return std::nullopt;
}

auto DriveSetup::next_request(Time now) -> std::optional<Frame> {
  switch (sdo_.poll(now)) {
    case SdoClient::State::kWaiting:
      return std::nullopt;
    case SdoClient::State::kIdle:
      return begin(now);
    case SdoClient::State::kTimedOut:
      fail_object(steps_[step_].object, "did not answer a request about", "check its supply and cable");
      return std::nullopt;
    default:
      break;
  }
  finish_request();
  if (phase_ != Phase::kConfiguring) {
    return phase_ == Phase::kStarting ? next(now) : std::nullopt;
  }
  return begin(now);
}

auto DriveSetup::begin(Time now) -> Frame {
  const SetupStep& step = steps_[step_];
  const bool reads = reading_back_ || step.action == Action::kExpect || step.action == Action::kLearn;
  return reads ? sdo_.read(step.object, now) : sdo_.write(step.object, step.value, now);
}

void DriveSetup::finish_request() {
  const SetupStep& step = steps_[step_];
  constexpr std::uint32_t kNoObject = 0x06020000;
  constexpr std::uint32_t kNoSubindex = 0x06090011;
  const bool aborted = sdo_.state() == SdoClient::State::kAborted;
  const bool absent = aborted && (sdo_.abort_code() == kNoObject || sdo_.abort_code() == kNoSubindex);
  const bool writes = step.action == Action::kWrite || step.action == Action::kWriteIfAny;
  if (aborted && !(absent && step.action == Action::kWriteIfAny)) {
    fail_object(step.object, std::string("refused (") + abort_text(sdo_.abort_code()) + ") a request about",
                "use a drive that has it, with firmware that lets it be set");
    return;
  }
  if (writes && !aborted && !reading_back_) {
    reading_back_ = true;
    return;
  }
  if (!aborted) {
    check(sdo_.value());
  }
  reading_back_ = false;
  if (phase_ == Phase::kConfiguring && ++step_ == steps_.size()) {
    phase_ = Phase::kStarting;
    since_.reset();
  }
}

void DriveSetup::check(std::uint32_t value) {
  const SetupStep& step = steps_[step_];
  if (step.action == Action::kLearn) {
    if (value == 0 || value > kMostRatedMa) {
      fail_object(step.object, "has " + std::to_string(value) + " mA in", "set the motor's data in the drive first");
    }
    rated_current_ma_ = static_cast<std::int32_t>(value);
  } else if ((value & step.mask) != (step.value & step.mask) && step.action == Action::kExpect) {
    fail_object(step.object, "has " + value_text(value) + " in", "use a drive for this profile and mode");
  } else if ((value & step.mask) != (step.value & step.mask)) {
    fail_object(step.object, "took " + value_text(step.value) + " but says " + value_text(value) + " in",
                "it would not be safe to enable it; set this object with the maker's tool, or use another drive");
  }
}

void DriveSetup::receive(const Frame& frame) {
  if (frame.extended || frame.remote) {
    return;
  }
  if (frame.id == cob::kSdoAnswer + node_) {
    sdo_.receive(frame);
  } else if (frame.id == cob::kHeartbeat + node_ && frame.size == 1) {
    const auto state = static_cast<NmtState>(frame.data[0]);
    if (state == NmtState::kBootUp && phase_ == Phase::kRestarting) {
      booted_ = since_.has_value();
    } else if (state == NmtState::kBootUp) {
      fail("started anew while it was set up; check its supply");
    } else if (state == NmtState::kOperational && phase_ == Phase::kStarting && since_) {
      phase_ = Phase::kDone;
    }
  }
}

}  // namespace capstan::cia402
