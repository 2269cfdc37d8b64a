// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "capstan/firmware/console/shell_input.hpp"
#include "capstan/firmware/console/text.hpp"
#include "capstan/hal/stm32f4/memory_map.hpp"
#include "capstan/hal/stm32f4/tick.hpp"
#include "capstan/hal/stm32f4/usart.hpp"

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

 private:
  [[nodiscard]] auto do_dropped() const -> std::uint32_t override { return dropped_; }
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

/// Carries characters from the port to the shell by the rules of ShellInput.
class ConsoleFeed {
 public:
  ConsoleFeed(SerialPort& port, Shell& shell) noexcept : port_(port), shell_(shell), input_(shell) {}

  /// Call it in the background loop.
  void poll() {
    constexpr std::size_t kMost = 256;
    std::uint8_t byte = 0;
    for (std::size_t taken = 0; taken < kMost && input_.wants() > 0 && port_.read(byte); ++taken) {
      input_.take(static_cast<char>(byte));
    }
    input_.poll();
  }

  /// True when a line is half typed or its answer is under way: nothing else should be printed now.
  [[nodiscard]] auto in_use() const -> bool { return input_.in_line() || shell_.busy(); }

 private:
  SerialPort& port_;
  Shell& shell_;
  ShellInput input_;
};

}  // namespace capstan::stm32f405
