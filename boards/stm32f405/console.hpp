// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "firmware/shell.hpp"
#include "firmware/text.hpp"
#include "hal/stm32f4/memory_map.hpp"
#include "hal/stm32f4/tick.hpp"
#include "hal/stm32f4/usart.hpp"

namespace capstan::stm32f405 {

using SerialPort = stm32f4::Usart<stm32f4::MemoryRegister, 256, 1024>;
using BoardTick = stm32f4::Tick<stm32f4::MemoryRegister>;

/// The shell's output on a serial port. An answer longer than the port's buffer waits for room: a byte leaves every 87
/// us. Only the background waits; the cycle goes on in its interrupt.
class ConsoleSink final : public TextSink {
 public:
  /// Ticks (ms) without any byte leaving after which the rest of a text is dropped.
  static constexpr std::uint32_t kPatienceTicks = 20;

  ConsoleSink(SerialPort& port, const BoardTick& tick) noexcept : port_(port), tick_(tick) {}
  /// Characters that found no room.
  [[nodiscard]] auto dropped() const noexcept -> std::uint32_t { return dropped_; }

 private:
  void do_write(std::string_view text) override {
    std::span<const std::uint8_t> left(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
    std::uint32_t moved_at = tick_.count();
    while (!left.empty() && tick_.count() - moved_at < kPatienceTicks) {
      const std::size_t taken = port_.write(left);
      left = left.subspan(taken);
      moved_at = taken > 0 ? tick_.count() : moved_at;
    }
    dropped_ += static_cast<std::uint32_t>(left.size());
  }

  SerialPort& port_;
  const BoardTick& tick_;
  std::uint32_t dropped_ = 0;
};

/// Carries characters from the port to the shell, no faster than the shell answers: while an answer is under way they
/// wait in the port's ring. Only a Ctrl-C that comes next overtakes; it ends a log.
class ConsoleFeed {
 public:
  ConsoleFeed(SerialPort& port, Shell& shell) noexcept : port_(port), shell_(shell) {}

  /// Call it in the background loop.
  void poll() {
    shell_.poll();
    while (fetch() && (!shell_.busy() || waiting_ == kCancel)) {
      have_waiting_ = false;
      in_line_ = waiting_ != '\r' && waiting_ != '\n';
      shell_.receive(waiting_);
    }
  }

  /// True when a line is half typed or its answer is under way: nothing else should be printed now.
  [[nodiscard]] auto in_use() const -> bool { return in_line_ || have_waiting_ || shell_.busy(); }

 private:
  static constexpr char kCancel = 0x03;

  /// True when a character is at hand.
  auto fetch() -> bool {
    if (!have_waiting_) {
      std::uint8_t byte = 0;
      have_waiting_ = port_.read(byte);
      waiting_ = have_waiting_ ? static_cast<char>(byte) : waiting_;
    }
    return have_waiting_;
  }

  SerialPort& port_;
  Shell& shell_;
  char waiting_ = 0;
  bool have_waiting_ = false;
  bool in_line_ = false;
};

}  // namespace capstan::stm32f405
