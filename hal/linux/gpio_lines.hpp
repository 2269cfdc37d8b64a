// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>

#include "capstan/hal/linux/gpio_request.hpp"

namespace capstan {

/// Which lines of a GPIO chip do what. A line that is not given is not used.
struct GpioSetup {
  struct Line {
    std::uint32_t offset = 0;
    bool inverted = false;  ///< low means what high would mean
  };
  std::string chip;              ///< device file; empty: no lines at all
  std::optional<Line> estop;     ///< input, high while the emergency stop is closed: a broken wire stops
  std::optional<Line> enable;    ///< output, high while drives may give torque
  std::optional<Line> brake;     ///< output, high while the brake is to be open
  std::optional<Line> watchdog;  ///< output, a square wave of 500 Hz while the cycle runs
};

/// Opens at once, on an edge of either kind or on the level; closes when the contact has been closed for 20 cycles.
class EstopContact {
 public:
  static constexpr std::uint32_t kCyclesToClose = 20;

  /// @param opened  there was an edge since the last call  @returns whether it counts as open
  auto rt_step(bool opened, bool closed) -> bool {
    cycles_closed_ = opened || !closed ? 0 : std::min(cycles_closed_ + 1, kCyclesToClose);
    return cycles_closed_ < kCyclesToClose;
  }

 private:
  std::uint32_t cycles_closed_ = 0;
};

/// Emergency stop, enable, brake and watchdog on lines of a GPIO chip. What goes wrong with them counts as an open
/// emergency stop.
class GpioLines {
 public:
  /// Takes the lines; outputs begin low. Throws std::runtime_error with "sentence; cure".
  explicit GpioLines(const GpioSetup& setup);
  GpioLines(GpioLines&&) noexcept = default;
  auto operator=(GpioLines&&) noexcept -> GpioLines& = default;
  ~GpioLines();

  /// Once a cycle.
  auto rt_estop() -> bool;
  /// Once a cycle: enable and brake as said, the watchdog's next half wave. @returns whether the chip took it
  auto rt_drive(bool enabled, bool brake_open) -> bool;
  /// Enable and brake low; the watchdog stays where it is.
  void rt_off();

  [[nodiscard]] auto has_estop() const -> bool { return static_cast<bool>(input_); }
  /// Calls of the kernel that failed since start.
  [[nodiscard]] auto failures() const -> std::uint32_t { return failures_; }

 private:
  auto rt_write(bool enabled, bool brake_open) -> bool;

  GpioRequest input_;
  GpioRequest outputs_;
  bool input_inverted_ = false;
  // Bits of the outputs in the request; 0: not used.
  std::uint32_t enable_bit_ = 0;
  std::uint32_t brake_bit_ = 0;
  std::uint32_t watchdog_bit_ = 0;
  std::uint32_t inverted_bits_ = 0;
  bool wave_ = false;
  std::uint32_t failures_ = 0;
  EstopContact contact_;
};

}  // namespace capstan
