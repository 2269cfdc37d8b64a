// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "capstan/hal/cia402/journal.hpp"
#include "capstan/hal/cia402/pdo_map.hpp"

namespace capstan::cia402 {

/// Reads and writes objects of up to four bytes in one drive, one at a time (CiA 301). Writes are expedited, answers to
/// reads may come in segments. No clock, no socket: frames and moments are handed in.
class SdoClient {
 public:
  enum class State : std::uint8_t { kIdle, kWaiting, kDone, kAborted, kTimedOut };
  /// For each message of the drive. Drives that look after their flash or their motor answer after 250 ms and more.
  static constexpr std::chrono::milliseconds kTimeout{1000};

  /// @param source  the drive's number in the journal
  SdoClient(std::uint8_t node, Journal& journal, std::size_t source)
      : node_(node), journal_(journal), source_(source) {}

  static auto read_request(std::uint8_t node, const Object& object) -> Frame;

  void set_timeout(std::chrono::milliseconds timeout) { timeout_ = timeout; }
  /// The request to send. @pre not waiting
  auto read(const Object& object, Time now) -> Frame;
  auto write(const Object& object, std::uint32_t value, Time now) -> Frame;

  /// A frame with this drive's answer identifier. What does not answer the request is counted and ignored.
  void receive(const Frame& frame);
  auto poll(Time now) -> State;
  /// What has to be sent for a transfer in segments to go on or to end, once.
  auto follow_up(Time now) -> std::optional<Frame>;

  [[nodiscard]] auto state() const -> State { return state_; }
  /// What was read, once done.
  [[nodiscard]] auto value() const -> std::uint32_t { return value_; }
  /// Why it was aborted, by the drive or by us.
  [[nodiscard]] auto abort_code() const -> std::uint32_t { return abort_code_; }

 private:
  auto request(std::uint8_t command, const Object& object, Time now) -> Frame;
  void receive_data(const Frame& frame);
  void receive_segment(const Frame& frame);
  void ask_for_segment();
  void refuse_size();

  std::uint8_t node_;
  Journal& journal_;
  std::size_t source_;
  std::chrono::milliseconds timeout_ = kTimeout;
  State state_ = State::kIdle;
  Object object_;
  bool writing_ = false;
  Time since_{};
  std::uint32_t value_ = 0;
  std::uint32_t abort_code_ = 0;
  bool segmented_ = false;
  bool toggle_ = false;         // of the segment that is waited for
  std::size_t gathered_ = 0;    // bytes
  std::optional<Frame> reply_;  // to be sent
};

}  // namespace capstan::cia402
