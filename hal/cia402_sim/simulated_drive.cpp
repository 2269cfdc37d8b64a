// SPDX-License-Identifier: Apache-2.0
#include "capstan/hal/cia402_sim/simulated_drive.hpp"

#include <algorithm>
#include <cmath>

namespace capstan::drive_sim {
namespace {

constexpr std::uint32_t kNotValid = 0x80000000;
constexpr std::uint32_t kIdBits = 0x7FF;
constexpr std::uint8_t kLastSynchronous = 240;
constexpr std::uint32_t kRatedMa = 1500;
constexpr std::size_t kOldCycles = 20;
constexpr std::chrono::milliseconds kSlowAnswer{250};
constexpr std::chrono::milliseconds kSlowBoot{4000};
constexpr std::uint16_t kMissedHeartbeat = 0x8130;
constexpr std::uint16_t kWrongPdoLength = 0x8210;

auto signed16(std::uint32_t value) -> std::int16_t {
  return static_cast<std::int16_t>(static_cast<std::uint16_t>(value));
}

void put32(Frame& frame, std::uint32_t value) {
  for (std::size_t i = 0; i < 4; ++i) {
    frame.data[4 + i] = static_cast<std::uint8_t>(value >> (8 * i));
  }
}

auto emergency(std::uint8_t node, std::uint16_t code, std::uint8_t error_register) -> Frame {
  Frame frame{.id = 0x080U + node, .size = 8};
  frame.data[0] = static_cast<std::uint8_t>(code);
  frame.data[1] = static_cast<std::uint8_t>(code >> 8U);
  frame.data[2] = error_register;
  return frame;
}

}  // namespace

SimulatedDrive::SimulatedDrive(std::uint8_t node, const sim::PlantParameters& axis, std::uint64_t seed,
                               Peculiarities peculiarities)
    : node_(node),
      peculiarities_(std::move(peculiarities)),
      objects_(dictionary_of(peculiarities_, node)),
      plant_(axis, seed) {
  restart();
}

auto SimulatedDrive::value_or(std::uint16_t index, std::uint8_t subindex, std::uint32_t otherwise) const
    -> std::uint32_t {
  const ObjectDictionary::Entry* const entry = objects_.find(index, subindex);
  return entry == nullptr ? otherwise : entry->value;
}

auto SimulatedDrive::statusword() const -> std::uint16_t {
  // State bits of CiA 402-2; bit 4 voltage is there, bit 9 remote, bit 12 the drive follows its set value.
  static constexpr std::array<std::uint16_t, 5> kBits = {0x0250, 0x0231, 0x0233, 0x1237, 0x0218};
  return kBits[static_cast<std::size_t>(state_)];
}

// CiA 402-2: in this mode the torque offset is added to the target, and 6072 limits the sum.
auto SimulatedDrive::current_a() const -> double {
  constexpr double kPermilleMa = 1e-6;
  const int most = static_cast<int>(objects_.get(0x6072));
  const int wanted = signed16(objects_.get(0x6071)) + signed16(objects_.get(0x60B2));
  return enabled() ? std::clamp(wanted, -most, most) * static_cast<double>(value_or(0x6075, 0, kRatedMa)) * kPermilleMa
                   : 0.0;
}

void SimulatedDrive::receive(const Frame& frame, Time now, std::vector<Frame>& out) {
  if (frame.extended || frame.remote) {
    return;
  }
  const std::uint32_t master = value_or(0x1016, 1, 0) >> 16U;
  if (frame.id == 0x000) {
    receive_nmt(frame);
  } else if (frame.id == 0x700 + master && master != 0) {
    last_master_ = now;
  } else if (frame.id == 0x600U + node_ && (nmt_ == Nmt::kPreOperational || operational())) {
    receive_sdo(frame, now, out);
  } else if (operational() && frame.id == 0x080) {
    receive_sync(out);
  } else if (operational()) {
    for (std::size_t i = 0; i < latched_.size(); ++i) {
      const std::uint32_t id = objects_.get(static_cast<std::uint16_t>(0x1400 + i), 1);
      if ((id & kNotValid) == 0 && (id & kIdBits) == frame.id) {
        receive_rpdo(i, frame, out);
      }
    }
  }
}

void SimulatedDrive::receive_nmt(const Frame& frame) {
  if (frame.size != 2 || (frame.data[1] != 0 && frame.data[1] != node_)) {
    return;
  }
  switch (frame.data[0]) {
    case 1:
      nmt_ = Nmt::kOperational;
      break;
    case 2:
      leave_operational(Nmt::kStopped);
      break;
    case 128:
      leave_operational(Nmt::kPreOperational);
      break;
    case 129:
    case 130:
      restart();
      break;
    default:
      break;
  }
}

void SimulatedDrive::restart() {
  objects_ = dictionary_of(peculiarities_, node_);
  objects_.set_mode_follows(!has(Peculiarity::kModeWhenEnabled) && !has(Peculiarity::kWrongMode));
  boots_at_.reset();
  answers_.clear();
  rest_.reset();
  nmt_ = Nmt::kStarting;
  state_ = State::kSwitchOnDisabled;
  last_controlword_ = 0;
  latched_ = {};
  next_heartbeat_.reset();
  last_master_.reset();
}

// CiA 402-2, 6007: 0 is no action at all, and the motor turns on; 1 is a fault, whose reaction here is torque off. A
// drive without the object does what its maker chose, here as with 2, voltage off.
void SimulatedDrive::leave_operational(Nmt next) {
  constexpr std::uint32_t kDisableVoltage = 2;
  const std::uint32_t option = has(Peculiarity::kGoesOn) ? 0 : value_or(0x6007, 0, kDisableVoltage);
  const bool powered = enabled() || state_ == State::kSwitchedOn;
  if (operational() && powered && option != 0) {
    state_ = option == 1 ? State::kFault : State::kSwitchOnDisabled;
  }
  nmt_ = next;
}

void SimulatedDrive::tick(Time now, std::vector<Frame>& out) {
  boots_at_ = boots_at_.value_or(now + (has(Peculiarity::kSlowBoot) ? Time(kSlowBoot) : Time{}));
  if (nmt_ == Nmt::kStarting && now >= *boots_at_) {
    nmt_ = Nmt::kPreOperational;
    out.push_back({.id = 0x700U + node_, .size = 1});
  }
  if (nmt_ == Nmt::kStarting) {
    return;
  }
  for (; !answers_.empty() && answers_.front().due <= now; answers_.pop_front()) {
    out.push_back(answers_.front().frame);
  }
  const auto period = std::chrono::milliseconds(objects_.get(0x1017));
  if (period.count() == 0) {
    next_heartbeat_.reset();
  } else if (!next_heartbeat_ || now >= *next_heartbeat_) {
    Frame frame{.id = 0x700U + node_, .size = 1};
    frame.data[0] = static_cast<std::uint8_t>(nmt_);
    out.push_back(frame);
    next_heartbeat_ = now + period;
  }
  const auto patience = std::chrono::milliseconds(value_or(0x1016, 1, 0) & 0xFFFFU);
  if (last_master_ && patience.count() != 0 && now - *last_master_ > patience) {
    last_master_.reset();
    const bool stays = value_or(0x1029, 1, 0) == 1;
    if (operational() && !stays) {
      leave_operational(Nmt::kPreOperational);
      out.push_back(emergency(node_, kMissedHeartbeat, 0x11));
    }
  }
}

void SimulatedDrive::fail(std::uint16_t code, std::vector<Frame>& out) {
  state_ = State::kFault;
  out.push_back(emergency(node_, code, 0x01));
}

// Reads into `answer` or writes from `request`. @returns the abort code, if it is refused
auto SimulatedDrive::answer_sdo(const Frame& request, Frame& answer) -> std::optional<std::uint32_t> {
  const std::uint8_t command = request.data[0];
  if (command == 0x40) {
    return answer_read(static_cast<std::uint16_t>(request.data[1] | request.data[2] << 8), request.data[3], answer);
  }
  if ((command & 0xEFU) == 0x60 && rest_) {  // the next segment; one is enough for four bytes
    answer.data.fill(0);
    answer.data[0] = static_cast<std::uint8_t>((command & 0x10U) | (7U - rest_bytes_) << 1U | 1U);
    for (std::size_t i = 0; i < 4; ++i) {
      answer.data[1 + i] = static_cast<std::uint8_t>(*rest_ >> (8 * i));
    }
    rest_.reset();
    return std::nullopt;
  }
  return (command & 0xE3U) == 0x23 ? answer_write(request, answer) : std::optional<std::uint32_t>(0x05040001);
}

auto SimulatedDrive::answer_read(std::uint16_t index, std::uint8_t subindex, Frame& answer)
    -> std::optional<std::uint32_t> {
  objects_.set(0x6041, statusword());
  const ObjectDictionary::Entry* const entry = objects_.find(index, subindex);
  if (entry == nullptr) {
    return objects_.find(index, 0) != nullptr || objects_.find(index, 1) != nullptr ? 0x06090011 : 0x06020000;
  }
  if (has(Peculiarity::kSegmentedSdo)) {
    rest_ = entry->value;
    rest_bytes_ = entry->bytes;
    answer.data[0] = 0x41;
    put32(answer, entry->bytes);
    return std::nullopt;
  }
  answer.data[0] = static_cast<std::uint8_t>(0x43 | (4 - entry->bytes) << 2);
  put32(answer, entry->value);
  return std::nullopt;
}

auto SimulatedDrive::answer_write(const Frame& request, Frame& answer) -> std::optional<std::uint32_t> {
  const auto index = static_cast<std::uint16_t>(request.data[1] | request.data[2] << 8);
  const auto bytes = static_cast<std::uint8_t>(4 - (request.data[0] >> 2 & 3));
  std::uint32_t value = 0;
  for (std::uint8_t i = 0; i < bytes; ++i) {
    value |= static_cast<std::uint32_t>(request.data[4U + i]) << (8U * i);
  }
  answer.data[0] = 0x60;
  put32(answer, 0);
  const auto refused = objects_.write(index, request.data[3], bytes, value);
  if (index == 0x6040 && !refused) {
    obey_controlword();
  }
  return refused;
}

void SimulatedDrive::receive_sdo(const Frame& frame, Time now, std::vector<Frame>& out) {
  if (frame.size != 8 || frame.data[0] == 0x80) {
    return;
  }
  Frame answer = frame;
  answer.id = 0x580U + node_;
  if (const auto refused = answer_sdo(frame, answer)) {
    answer.data[0] = 0x80;
    put32(answer, *refused);
  }
  if (has(Peculiarity::kSlowSdo)) {
    answers_.push_back({now + kSlowAnswer, answer});
  } else {
    out.push_back(answer);
  }
}

auto SimulatedDrive::mapped_bytes(std::uint16_t index) const -> std::size_t {
  std::size_t bits = 0;
  for (std::uint8_t i = 1; i <= objects_.get(index, 0); ++i) {
    bits += objects_.get(index, i) & 0xFFU;
  }
  return bits / 8;
}

void SimulatedDrive::receive_rpdo(std::size_t number, const Frame& frame, std::vector<Frame>& out) {
  if (frame.size < mapped_bytes(static_cast<std::uint16_t>(0x1600 + number))) {
    out.push_back(emergency(node_, kWrongPdoLength, 0x11));
    return;
  }
  if (objects_.get(static_cast<std::uint16_t>(0x1400 + number), 2) <= kLastSynchronous) {
    latched_[number] = frame;
  } else {
    unpack(number, frame);
    obey_controlword();
  }
}

void SimulatedDrive::unpack(std::size_t number, const Frame& frame) {
  const auto index = static_cast<std::uint16_t>(0x1600 + number);
  std::size_t at = 0;
  for (std::uint8_t i = 1; i <= objects_.get(index, 0); ++i) {
    const std::uint32_t word = objects_.get(index, i);
    const std::size_t bytes = (word & 0xFFU) / 8;
    std::uint32_t value = 0;
    for (std::size_t b = 0; b < bytes; ++b) {
      value |= static_cast<std::uint32_t>(frame.data[at + b]) << (8 * b);
    }
    at += bytes;
    if (word >> 16U > 7) {  // 1 to 7 are dummies
      objects_.set(static_cast<std::uint16_t>(word >> 16U), value, static_cast<std::uint8_t>(word >> 8U));
    }
  }
}

auto SimulatedDrive::pack(std::size_t number) const -> Frame {
  const auto index = static_cast<std::uint16_t>(0x1A00 + number);
  Frame frame{.id = objects_.get(static_cast<std::uint16_t>(0x1800 + number), 1) & kIdBits};
  for (std::uint8_t i = 1; i <= objects_.get(index, 0); ++i) {
    const std::uint32_t word = objects_.get(index, i);
    const std::uint32_t value =
        objects_.get(static_cast<std::uint16_t>(word >> 16U), static_cast<std::uint8_t>(word >> 8U));
    for (std::size_t b = 0; b < (word & 0xFFU) / 8; ++b) {
      frame.data[frame.size++] = static_cast<std::uint8_t>(value >> (8 * b));
    }
  }
  return frame;
}

// What is sent after SYNC: of now, or of a while ago.
void SimulatedDrive::sample() {
  const bool reversed = (value_or(0x607E, 0, 0) & 0x80U) != 0;
  const std::int32_t counts = plant_.readings().encoder_counts;
  samples_.push_back({statusword(), static_cast<std::uint32_t>(reversed ? -counts : counts)});
  if (samples_.size() > kOldCycles + 1) {
    samples_.pop_front();
  }
  const bool old_status = has(Peculiarity::kOldStatus);
  objects_.set(0x6041, old_status ? samples_.front().statusword : samples_.back().statusword);
  const bool old_position = old_status || has(Peculiarity::kOldPositions);
  objects_.set(0x6064, old_position ? samples_.front().position : samples_.back().position);
  const double permille = plant_.readings().current_a * 1e6 / value_or(0x6075, 0, kRatedMa);
  objects_.set(0x6077, static_cast<std::uint16_t>(
                           static_cast<std::int16_t>(std::lround(std::clamp(permille, -32768.0, 32767.0)))));
  const bool shown = objects_.find(0x6061, 0) != nullptr;
  if (shown && (has(Peculiarity::kModeWhenEnabled) || has(Peculiarity::kWrongMode))) {
    constexpr std::uint32_t kPositionMode = 8;
    objects_.set(0x6061, !enabled() ? 0 : has(Peculiarity::kWrongMode) ? kPositionMode : objects_.get(0x6060));
  }
}

void SimulatedDrive::receive_sync(std::vector<Frame>& out) {
  for (std::size_t i = 0; i < latched_.size(); ++i) {
    if (latched_[i]) {
      unpack(i, *latched_[i]);
      latched_[i].reset();
    }
  }
  obey_controlword();
  sample();
  for (std::size_t i = 0; i < 4; ++i) {
    const auto communication = static_cast<std::uint16_t>(0x1800 + i);
    if ((objects_.get(communication, 1) & kNotValid) == 0 && objects_.get(communication, 2) == 1) {
      out.push_back(pack(i));
    }
  }
  plant_.step(current_a(), enabled());
}

void SimulatedDrive::obey_controlword() {
  const auto word = static_cast<std::uint16_t>(objects_.get(0x6040));
  const bool reset_edge = (word & 0x80U) != 0 && (last_controlword_ & 0x80U) == 0;
  last_controlword_ = word;
  if (state_ == State::kFault) {
    state_ = reset_edge ? State::kSwitchOnDisabled : State::kFault;
    return;
  }
  // CiA 402-2 table "command coding"; a quick stop (bit 2 low) ends in switch on disabled, because 605A is 0 or 2.
  if ((word & 0x06U) != 0x06) {
    state_ = State::kSwitchOnDisabled;
  } else if ((word & 0x01U) == 0) {
    state_ = State::kReadyToSwitchOn;
  } else if (state_ == State::kReadyToSwitchOn) {
    state_ = State::kSwitchedOn;
  } else if (state_ != State::kSwitchOnDisabled) {
    state_ = (word & 0x08U) != 0 ? State::kOperationEnabled : State::kSwitchedOn;
  }
}

}  // namespace capstan::drive_sim
