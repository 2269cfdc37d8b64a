// SPDX-License-Identifier: Apache-2.0
#include "capstan/hal/cia402/sdo_client.hpp"

#include <utility>

namespace capstan::cia402 {
namespace {

// Command specifiers of CiA 301 7.2.4.3, in the upper three bits; in the lower ones e (expedited), s (size given) and n
// (bytes without data).
constexpr std::uint8_t kReadRequest = 0x40;
constexpr std::uint8_t kWriteRequest = 0x23;
constexpr std::uint8_t kWriteAnswer = 0x60;
constexpr std::uint8_t kReadAnswer = 0x40;
constexpr std::uint8_t kAbort = 0x80;
constexpr std::uint8_t kSpecifier = 0xE0;
constexpr std::uint8_t kExpedited = 0x02;
constexpr std::uint8_t kSizeGiven = 0x01;
constexpr std::uint8_t kSegmentRequest = 0x60;
constexpr std::uint8_t kSegmentAnswer = 0x00;
constexpr std::uint8_t kToggle = 0x10;
constexpr std::uint8_t kLastSegment = 0x01;
constexpr std::size_t kBytesOfSegment = 7;
constexpr std::uint32_t kWrongLength = 0x06070010;
constexpr std::uint32_t kToggleNotAlternated = 0x05030000;
constexpr std::size_t kBytes = 8;

}  // namespace

auto SdoClient::read_request(std::uint8_t node, const Object& object) -> Frame {
  Frame frame{.id = cob::kSdoRequest + node, .size = kBytes};
  frame.data[0] = kReadRequest;
  put_bytes(frame, 1, 2, object.index);
  frame.data[3] = object.subindex;
  return frame;
}

auto SdoClient::request(std::uint8_t command, const Object& object, Time now) -> Frame {
  object_ = object;
  since_ = now;
  state_ = State::kWaiting;
  abort_code_ = 0;
  value_ = 0;
  segmented_ = false;
  reply_.reset();
  Frame frame = read_request(node_, object);
  frame.data[0] = command;
  return frame;
}

auto SdoClient::read(const Object& object, Time now) -> Frame {
  writing_ = false;
  return request(kReadRequest, object, now);
}

auto SdoClient::write(const Object& object, std::uint32_t value, Time now) -> Frame {
  writing_ = true;
  Frame frame = request(static_cast<std::uint8_t>(kWriteRequest | (4U - object.bytes) << 2U), object, now);
  put_bytes(frame, 4, object.bytes, value);
  return frame;
}

void SdoClient::receive(const Frame& frame) {
  if (frame.size != kBytes) {
    journal_.note(Anomaly::kSdoLength, source_, frame.size);
    return;
  }
  if (state_ != State::kWaiting) {
    journal_.note(Anomaly::kSdoUnexpected, source_);
    return;
  }
  const std::uint8_t specifier = frame.data[0] & kSpecifier;
  if (segmented_ && specifier == kSegmentAnswer) {  // which does not say whose segment it is
    receive_segment(frame);
    return;
  }
  if (get_bytes(frame, 1, 2) != object_.index || frame.data[3] != object_.subindex) {
    journal_.note(Anomaly::kSdoOtherObject, source_, get_bytes(frame, 1, 2));
    return;
  }
  if (specifier == kAbort) {
    abort_code_ = get_bytes(frame, 4, 4);
    state_ = State::kAborted;
  } else if (writing_ && specifier == kWriteAnswer) {
    state_ = State::kDone;
  } else if (!writing_ && !segmented_ && specifier == kReadAnswer) {
    receive_data(frame);
  } else {
    journal_.note(Anomaly::kSdoCommand, source_, frame.data[0]);
  }
}

void SdoClient::receive_data(const Frame& frame) {
  const std::uint8_t command = frame.data[0];
  const bool expedited = (command & kExpedited) != 0;
  const std::size_t given = expedited ? 4U - (command >> 2U & 3U) : get_bytes(frame, 4, 4);
  if ((command & kSizeGiven) != 0 && given != object_.bytes) {
    refuse_size();
  } else if (expedited) {
    value_ = get_bytes(frame, 4, object_.bytes);
    state_ = State::kDone;
  } else {
    segmented_ = true;
    toggle_ = false;
    gathered_ = 0;
    ask_for_segment();
  }
}

void SdoClient::ask_for_segment() {
  reply_ = Frame{.id = cob::kSdoRequest + node_, .size = kBytes};
  reply_->data[0] = static_cast<std::uint8_t>(kSegmentRequest | (toggle_ ? kToggle : 0));
}

void SdoClient::receive_segment(const Frame& frame) {
  const std::uint8_t command = frame.data[0];
  if (((command & kToggle) != 0) != toggle_) {
    journal_.note(Anomaly::kSdoCommand, source_, command);
    abort_code_ = kToggleNotAlternated;
    state_ = State::kAborted;
    return;
  }
  const std::size_t count = kBytesOfSegment - (command >> 1U & kBytesOfSegment);
  const bool last = (command & kLastSegment) != 0;
  if (gathered_ + count > object_.bytes || (last && gathered_ + count != object_.bytes)) {
    refuse_size();
    return;
  }
  for (std::size_t i = 0; i < count; ++i, ++gathered_) {
    value_ |= static_cast<std::uint32_t>(frame.data[1 + i]) << (8 * gathered_);
  }
  if (last) {
    state_ = State::kDone;
    return;
  }
  toggle_ = !toggle_;
  ask_for_segment();
}

// The drive is told, or it would wait for the next request of this transfer.
void SdoClient::refuse_size() {
  journal_.note(Anomaly::kSdoSize, source_, object_.index);
  abort_code_ = kWrongLength;
  state_ = State::kAborted;
  reply_ = Frame{.id = cob::kSdoRequest + node_, .size = kBytes};
  reply_->data[0] = kAbort;
  put_bytes(*reply_, 1, 2, object_.index);
  reply_->data[3] = object_.subindex;
  put_bytes(*reply_, 4, 4, kWrongLength);
}

auto SdoClient::follow_up(Time now) -> std::optional<Frame> {
  if (reply_) {
    since_ = now;
  }
  return std::exchange(reply_, std::nullopt);
}

auto SdoClient::poll(Time now) -> State {
  if (state_ == State::kWaiting && now - since_ > timeout_) {
    journal_.note(Anomaly::kSdoTimeout, source_, object_.index);
    state_ = State::kTimedOut;
  }
  return state_;
}

}  // namespace capstan::cia402
