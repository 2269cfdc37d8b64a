// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "capstan/boards/stm32f405/can_protocol.hpp"
#include "capstan/firmware/loop/axis.hpp"

namespace capstan::stm32f405 {

/// Makes references for the cycle of setpoints from the bus. A setpoint is used once, in the cycle it comes, and only
/// if it is whole, newer than the last one, and not alone: the first one after kSilentCycles only says where a stream's
/// sequence begins, so that a stray or replayed frame moves nothing. What happens when a stream stops is the axis'
/// business (fault link_lost). For the cycle's context.
template <std::size_t Axes>
class CanSetpoints {
 public:
  using Streamed = std::array<Request, Axes>;
  static constexpr std::uint32_t kSilentCycles = 100;

  CanSetpoints(std::uint8_t node, CanTroubleCounters& troubles) : node_(node), troubles_(troubles) {}

  /// The identifiers it wants to hear; with fewer than four axes the last one is repeated.
  [[nodiscard]] auto identifiers() const -> std::array<std::uint16_t, 4> {
    std::array<std::uint16_t, 4> ids{};
    for (std::size_t i = 0; i < ids.size(); ++i) {
      ids[i] = identifier(kCanSetpoint, node_, std::min(i, Axes - 1));
    }
    return ids;
  }

  void rt_begin_cycle() {
    streamed_ = {};
    for (Stream& stream : streams_) {
      stream.silent_cycles = std::min(stream.silent_cycles + 1, kSilentCycles);
    }
  }

  void rt_take(const stm32f4::CanFrame& frame) {
    for (std::size_t axis = 0; axis < Axes; ++axis) {
      if (frame.id == identifier(kCanSetpoint, node_, axis)) {
        rt_take(axis, frame);
        return;
      }
    }
    troubles_.rt_add(CanTrouble::kUnexpected);
  }

  [[nodiscard]] auto rt_streamed() const -> const Streamed& { return streamed_; }

 private:
  struct Stream {
    std::uint32_t silent_cycles = kSilentCycles;
    std::uint8_t last = 0;  ///< sequence
    bool running = false;   ///< two setpoints in a row have come
  };

  void rt_take(std::size_t axis, const stm32f4::CanFrame& frame) {
    if (frame.size != frame.data.size()) {
      troubles_.rt_add(CanTrouble::kSetpointLength);
    } else if (take<can_setpoint::kChecksum>(frame) != setpoint_checksum(frame)) {
      troubles_.rt_add(CanTrouble::kSetpointChecksum);
    } else if (take<can_setpoint::kKind>(frame) != kFollowAngle) {
      troubles_.rt_add(CanTrouble::kSetpointKind);
    } else if (in_turn(streams_[axis], static_cast<std::uint8_t>(take<can_setpoint::kSequence>(frame)))) {
      if (streamed_[axis].kind != Request::Kind::kNone) {
        troubles_.rt_add(CanTrouble::kSetpointCrowded);
      }
      const auto raw = static_cast<std::int32_t>(take<can_setpoint::kAngle>(frame));
      streamed_[axis].kind = Request::Kind::kFollow;
      streamed_[axis].position_rad = Q24::from_raw(raw);
    }
  }

  /// Whether a setpoint with this sequence number is the next of its stream.
  auto in_turn(Stream& stream, std::uint8_t sequence) -> bool {
    const auto ahead = static_cast<std::uint8_t>(sequence - stream.last);
    const bool begins = stream.silent_cycles >= kSilentCycles;
    if (begins || (!stream.running && ahead != 1 && ahead != 0)) {
      stream = {.silent_cycles = 0, .last = sequence, .running = false};
      troubles_.rt_add(CanTrouble::kSetpointAlone);
      return false;
    }
    if (ahead == 0 || ahead >= 128) {  // half of the numbers are older: nothing to follow
      troubles_.rt_add(ahead == 0 ? CanTrouble::kSetpointDuplicate : CanTrouble::kSetpointLate);
      return false;
    }
    troubles_.rt_add(CanTrouble::kSetpointLost, ahead - 1U);
    stream = {.silent_cycles = 0, .last = sequence, .running = true};
    return true;
  }

  std::uint8_t node_;
  CanTroubleCounters& troubles_;
  std::array<Stream, Axes> streams_{};
  Streamed streamed_{};
};

}  // namespace capstan::stm32f405
