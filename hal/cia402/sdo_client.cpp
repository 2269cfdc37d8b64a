// SPDX-License-Identifier: Apache-2.0
#include "capstan/hal/cia402/sdo_client.hpp"

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
constexpr std::uint32_t kWrongLength = 0x06070010;
constexpr std::size_t kBytes = 8;

}  // namespace

auto SdoClient::request(std::uint8_t command, const Object& object, Time now) -> Frame {
  object_ = object;
  since_ = now;
  state_ = State::kWaiting;
  abort_code_ = 0;
  Frame frame{.id = cob::kSdoRequest + node_, .size = kBytes};
  frame.data[0] = command;
  put_bytes(frame, 1, 2, object.index);
  frame.data[3] = object.subindex;
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
  if (get_bytes(frame, 1, 2) != object_.index || frame.data[3] != object_.subindex) {
    journal_.note(Anomaly::kSdoOtherObject, source_, get_bytes(frame, 1, 2));
    return;
  }
  const std::uint8_t specifier = frame.data[0] & kSpecifier;
  if (specifier == kAbort) {
    abort_code_ = get_bytes(frame, 4, 4);
    journal_.note(Anomaly::kSdoAborted, source_, abort_code_);
    state_ = State::kAborted;
  } else if (writing_ && specifier == kWriteAnswer) {
    state_ = State::kDone;
  } else if (!writing_ && specifier == kReadAnswer) {
    receive_data(frame);
  } else {
    journal_.note(Anomaly::kSdoCommand, source_, frame.data[0]);
  }
}

void SdoClient::receive_data(const Frame& frame) {
  const std::uint8_t command = frame.data[0];
  const std::size_t given = 4U - (command >> 2U & 3U);
  if ((command & kExpedited) == 0 || ((command & kSizeGiven) != 0 && given != object_.bytes)) {
    journal_.note(Anomaly::kSdoSize, source_, object_.index);
    abort_code_ = kWrongLength;
    state_ = State::kAborted;
    return;
  }
  value_ = get_bytes(frame, 4, object_.bytes);
  state_ = State::kDone;
}

auto SdoClient::poll(Time now) -> State {
  if (state_ == State::kWaiting && now - since_ > kTimeout) {
    journal_.note(Anomaly::kSdoTimeout, source_, object_.index);
    state_ = State::kTimedOut;
  }
  return state_;
}

}  // namespace capstan::cia402
