// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/hal/cia402/journal.hpp"
#include "capstan/hal/cia402/pdo_map.hpp"

namespace capstan::cia402 {

/// Reads and writes objects of up to four bytes in one drive, one at a time (CiA 301, expedited SDO). No clock, no
/// socket: frames and moments are handed in.
class SdoClient {
 public:
  enum class State : std::uint8_t { kIdle, kWaiting, kDone, kAborted, kTimedOut };
  static constexpr std::chrono::milliseconds kTimeout{200};

  /// @param source  the drive's number in the journal
  SdoClient(std::uint8_t node, Journal& journal, std::size_t source)
      : node_(node), journal_(journal), source_(source) {}

  /// The request to send. @pre not waiting
  auto read(const Object& object, Time now) -> Frame;
  auto write(const Object& object, std::uint32_t value, Time now) -> Frame;

  /// A frame with this drive's answer identifier. What does not answer the request is counted and ignored.
  void receive(const Frame& frame);
  auto poll(Time now) -> State;

  [[nodiscard]] auto state() const -> State { return state_; }
  /// What was read, once done.
  [[nodiscard]] auto value() const -> std::uint32_t { return value_; }
  /// Why it was aborted, by the drive or by us.
  [[nodiscard]] auto abort_code() const -> std::uint32_t { return abort_code_; }

 private:
  auto request(std::uint8_t command, const Object& object, Time now) -> Frame;
  void receive_data(const Frame& frame);

  std::uint8_t node_;
  Journal& journal_;
  std::size_t source_;
  State state_ = State::kIdle;
  Object object_;
  bool writing_ = false;
  Time since_{};
  std::uint32_t value_ = 0;
  std::uint32_t abort_code_ = 0;
};

}  // namespace capstan::cia402
