// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "capstan/boards/stm32f405/can_protocol.hpp"
#include "capstan/firmware/console/shell_input.hpp"
#include "capstan/firmware/loop/machine.hpp"
#include "capstan/hal/stm32f4/ring_buffer.hpp"

namespace capstan::stm32f405 {

/// The board's node on CAN, for the background: heartbeat, telemetry and a shell of its own.
/// `Port` is stm32f4::Can or what stands in for it; `Clock` counts milliseconds by count().
template <typename Port, typename Clock>
class CanNode {
 public:
  static constexpr std::uint32_t kHeartbeatTicks = kCanHeartbeat.period_ms;
  static constexpr std::uint32_t kTelemetryTicks = kCanTelemetry.period_ms;
  static constexpr std::size_t kBackgroundFifo = 1;

  CanNode(Port& port, const Clock& clock, Machine& machine, Board& board, std::uint8_t node,
          CanTroubleCounters& troubles)
      : port_(port),
        clock_(clock),
        machine_(machine),
        node_(node),
        troubles_(troubles),
        sink_(*this),
        shell_(machine, sink_, board, false),
        input_(shell_) {}

  [[nodiscard]] auto identifiers() const -> std::array<std::uint16_t, 4> {
    const std::uint16_t id = identifier(kCanShellIn, node_);
    return {id, id, id, id};
  }

  /// One round of the background.
  void poll() {
    const std::uint32_t tick = clock_.count();
    port_.poll(tick);
    stm32f4::CanFrame frame;
    while (port_.rt_receive(kBackgroundFifo, frame)) {
      take(frame);
    }
    input_.poll();
    pump();
    send_cyclic(tick);
    note_port_errors();
  }

  /// True once for each time the bus, or everybody else on it, was lost while somebody was on it: the shell then
  /// forgets what the peer had opened, begun and taken.
  [[nodiscard]] auto take_bus_loss() -> bool {
    const std::uint32_t losses = port_.errors().bus_off + port_.errors().alone;
    const bool lost = losses != seen_losses_ && (heard_ || troubles_.count(CanTrouble::kSetpointAlone) != 0);
    seen_losses_ = losses;
    if (lost) {
      input_.peer_left();
    }
    return lost;
  }

  void print(Print& out) const {
    out << "can node " << static_cast<std::uint32_t>(node_);
    if (!port_.answers()) {
      out << " off: the controller does not answer or its clock is not exact; expected in an emulator\r\n";
      return;
    }
    out << (port_.bus_off() ? " off the bus" : " on the bus") << ", transmit errors " << port_.transmit_errors()
        << " receive errors " << port_.receive_errors() << "\r\n";
    for (std::size_t i = 0; i < kCanTroubles.size(); ++i) {
      if (const std::uint32_t count = troubles_.count(static_cast<CanTrouble>(i)); count != 0) {
        const CanTroubleInfo& trouble = kCanTroubles[i];
        out << "can " << trouble.name << ' ' << count << ": " << trouble.cause << "; " << trouble.cure << "\r\n";
      }
    }
  }

 private:
  static constexpr std::size_t kRoom = 256;       // characters
  static constexpr std::uint32_t kPatience = 20;  // ms without a frame leaving after which a text's rest is dropped
  // ms within which a frame that is the same in everything is the last one again. A controller that believes a frame
  // lost repeats it at once; later it is another host that counts from where the last one stopped.
  static constexpr std::uint32_t kTwinTicks = 10;

  class Sink final : public TextSink {
   public:
    explicit Sink(CanNode& node) : node_(node) {}

   private:
    [[nodiscard]] auto do_dropped() const -> std::uint32_t override { return dropped_; }
    void do_write(std::string_view text) override {
      std::uint32_t moved_at = node_.clock_.count();
      for (const char c : text) {
        while (!node_.out_.push(static_cast<std::uint8_t>(c))) {
          const std::uint32_t now = node_.clock_.count();
          if (node_.pump()) {
            moved_at = now;
          } else if (now - moved_at >= kPatience || !node_.port_.answers()) {
            ++dropped_;
            break;
          } else {
            node_.port_.poll(now);
          }
        }
      }
    }
    CanNode& node_;
    std::uint32_t dropped_ = 0;
  };

  /// What a mailbox holds behind a frame's length is anything.
  [[nodiscard]] auto is_last_again(const stm32f4::CanFrame& frame) const -> bool {
    return frame.size == last_in_.size && clock_.count() - last_in_at_ < kTwinTicks &&
           std::equal(frame.data.begin(), frame.data.begin() + frame.size, last_in_.data.begin());
  }

  void take(const stm32f4::CanFrame& frame) {
    if (frame.id != identifier(kCanShellIn, node_)) {
      troubles_.rt_add(CanTrouble::kUnexpected);
      return;
    }
    if (frame.size < 2 || frame.size > frame.data.size()) {
      troubles_.rt_add(CanTrouble::kShellLength);
      return;
    }
    if (heard_ && is_last_again(frame)) {
      troubles_.rt_add(CanTrouble::kShellDuplicate);
      return;
    }
    const bool damaged = heard_ && static_cast<std::uint8_t>(frame.data[0] - last_in_.data[0]) != 1;
    if (damaged) {
      troubles_.rt_add(CanTrouble::kShellLost);
    }
    heard_ = true;
    last_in_ = frame;
    last_in_at_ = clock_.count();
    if (input_.room() < frame.size) {
      troubles_.rt_add(CanTrouble::kShellCrowded);
    }
    if (damaged) {
      input_.take(kNoText);  // the shell refuses a line with it, and says why
    }
    for (std::size_t i = 1; i < frame.size; ++i) {
      input_.take(static_cast<char>(frame.data[i]));
    }
  }

  /// Gives waiting characters to the controller, seven at a time; true if any left.
  auto pump() -> bool {
    bool moved = false;
    while (out_.size() > 0 && port_.can_send()) {
      stm32f4::CanFrame frame{.id = identifier(kCanShellOut, node_), .size = 1};
      frame.data[0] = shell_out_++;
      std::uint8_t c = 0;
      while (frame.size < frame.data.size() && out_.pop(c)) {
        frame.data[frame.size++] = c;
      }
      moved = port_.send(frame) || moved;
    }
    return moved;
  }

  void send_cyclic(std::uint32_t tick) {
    if (!port_.answers() || port_.bus_off()) {
      return;
    }
    if (tick - heartbeat_at_ >= kHeartbeatTicks) {
      heartbeat_at_ = tick;
      static_cast<void>(port_.send(heartbeat()));
    }
    // One axis a millisecond, so that the three mailboxes are never all taken by telemetry.
    if (tick - telemetry_at_ >= (axis_ == 0 ? kTelemetryTicks - machine_.axes() + 1 : 1)) {
      telemetry_at_ = tick;
      static_cast<void>(port_.send(telemetry(axis_)));
      axis_ = (axis_ + 1) % machine_.axes();
    }
  }

  auto heartbeat() -> stm32f4::CanFrame {
    const MachineTelemetry now = machine_.telemetry();
    stm32f4::CanFrame frame{.id = identifier(kCanHeartbeat, node_), .size = 8};
    std::uint32_t refused = 0;
    for (std::size_t i = 0; i <= static_cast<std::size_t>(CanTrouble::kUnexpected); ++i) {
      refused += troubles_.count(static_cast<CanTrouble>(i));
    }
    put<can_heartbeat::kState>(frame, static_cast<std::uint32_t>(now.state));
    put<can_heartbeat::kFirstFault>(frame, static_cast<std::uint32_t>(now.first_fault));
    unsigned warnings = now.warnings;
    for (std::size_t axis = 0; axis < machine_.axes(); ++axis) {
      warnings |= machine_.axis_telemetry(axis).warnings;
    }
    static_assert(kFaultTable.size() <= can_heartbeat::kFaults.bits);
    put<can_heartbeat::kFaults>(frame, now.conditions);
    put<can_heartbeat::kWarnings>(frame, warnings);
    put<can_heartbeat::kRefused>(frame, refused);
    put<can_heartbeat::kCounter>(frame, heartbeats_++);
    return frame;
  }

  [[nodiscard]] auto telemetry(std::size_t axis) const -> stm32f4::CanFrame {
    const AxisTelemetry now = machine_.axis_telemetry(axis);
    stm32f4::CanFrame frame{.id = identifier(kCanTelemetry, node_, axis), .size = 8};
    constexpr std::int64_t kMost = 32767;
    const std::int64_t milliampere = (std::int64_t{now.current_a.raw()} * 1000) >> Q24::kFrac;
    static_assert(kCanAngleParts == 1U << Q24::kFrac);
    put<can_telemetry::kAngle>(frame, static_cast<std::uint32_t>(now.q2_rad.raw()));
    put<can_telemetry::kCurrent>(frame, static_cast<std::uint32_t>(std::clamp(milliampere, -kMost, kMost)));
    put<can_telemetry::kLimits>(frame, now.limits);
    put<can_telemetry::kAngleValid>(frame, now.estimate_valid ? 1U : 0U);
    put<can_telemetry::kTime>(frame, machine_.telemetry().tick);
    return frame;
  }

  /// The port keeps its own counters; the table shows their sum since start.
  void note_port_errors() {
    const stm32f4::CanErrors now = port_.errors();
    const auto note = [this](CanTrouble trouble, std::uint32_t total) {
      troubles_.rt_add(trouble, total - troubles_.count(trouble));
    };
    note(CanTrouble::kFifoOverrun, now.fifo_overruns);
    note(CanTrouble::kRingOverrun, now.ring_overruns);
    note(CanTrouble::kForeign, now.foreign);
    note(CanTrouble::kSendFull, now.send_full);
    note(CanTrouble::kSendLost, now.send_lost);
    note(CanTrouble::kErrorPassive, now.passive);
    note(CanTrouble::kBusOff, now.bus_off);
    note(CanTrouble::kAlone, now.alone);
  }

  static constexpr char kNoText = '\0';

  Port& port_;
  const Clock& clock_;
  Machine& machine_;
  std::uint8_t node_;
  CanTroubleCounters& troubles_;
  RingBuffer<kRoom> out_;
  Sink sink_;
  Shell shell_;
  ShellInput input_;
  stm32f4::CanFrame last_in_;
  std::uint32_t last_in_at_ = 0;
  std::uint32_t heartbeat_at_ = 0;
  std::uint32_t telemetry_at_ = 0;
  std::size_t axis_ = 0;
  std::uint32_t seen_losses_ = 0;
  std::uint8_t heartbeats_ = 0;
  std::uint8_t shell_out_ = 0;
  bool heard_ = false;
};

}  // namespace capstan::stm32f405
