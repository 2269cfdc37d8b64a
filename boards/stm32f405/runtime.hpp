// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <span>

#include "capstan/boards/stm32f405/board.hpp"
#include "capstan/boards/stm32f405/can_node.hpp"
#include "capstan/boards/stm32f405/can_setpoints.hpp"
#include "capstan/boards/stm32f405/console.hpp"
#include "capstan/boards/stm32f405/own_image.hpp"
#include "capstan/boards/stm32f405/startup.hpp"
#include "capstan/firmware/console/shell.hpp"
#include "capstan/firmware/loop/application.hpp"
#include "capstan/hal/stm32f4/clocks.hpp"
#include "capstan/hal/stm32f4/cycle_schedule.hpp"
#include "capstan/hal/stm32f4/metered_io.hpp"
#include "capstan/hal/stm32f4/reset_cause.hpp"
#include "capstan/hal/stm32f4/tick.hpp"
#include "capstan/hal/stm32f4/watchdog.hpp"

namespace capstan::stm32f405 {

/// What the board found when it started.
struct StartReport {
  stm32f4::ClockStatus clock{};
  stm32f4::ResetCause reset_cause = stm32f4::ResetCause::kUnknown;
  bool faulted = false;  ///< the last run ended in a fault handler
  FaultRecord fault{};
  bool watchdog_set = false;
  bool brown_out_watched = false;  ///< the core is in reset where its supply is too low for its clock
};

/// What blocks arming until the next start. A run that a fault of the core ended is no better than one that the
/// watchdog did, and without the watchdog nothing would end the next one.
[[nodiscard]] constexpr auto faults_at_start(const StartReport& report) -> FaultSet {
  const bool by_watchdog = report.reset_cause == stm32f4::ResetCause::kIndependentWatchdog;
  return (report.clock.fell_back() ? bit(Fault::kBoardClock) : 0) |
         (by_watchdog || report.faulted || !report.watchdog_set ? bit(Fault::kWatchdog) : 0);
}
static_assert(faults_at_start({.faulted = true, .watchdog_set = true}) == bit(Fault::kWatchdog));
static_assert(faults_at_start({.watchdog_set = false}) == bit(Fault::kWatchdog));
static_assert(faults_at_start({.reset_cause = stm32f4::ResetCause::kSoftware, .watchdog_set = true}) == 0);

/// Clocks, reset cause and the record of the last fault. First thing in main(), before any other peripheral.
[[nodiscard]] auto start_core() noexcept -> StartReport;

/// Clocks and modes of the pins both images use, then those of `pins`.
void start_pins(std::span<const stm32f4::Pin> pins) noexcept;

/// Prints what start_core() found, one "# ..." line each, which hosts skip.
void print_start(Print& out, const StartReport& report);

/// What the timing line shows.
struct Timing {
  stm32f4::CycleMeter cycle;     ///< the cycle without its input and output, core cycles
  stm32f4::CycleMeter hardware;  ///< its input and output, core cycles
  std::atomic<std::uint32_t> overruns{0};
};
/// Eight hexadecimal digits.
void print_hex(Print& out, std::uint32_t value);
void print_timing(Print& out, const Timing& timing, std::uint32_t core_hz);

using CanPort = stm32f4::Can<stm32f4::MemoryRegister>;

/// What the firmware needs of the board besides its joint I/O; built once by main.
struct BoardParts {
  SerialPort& console;
  BoardTick& tick;
  stm32f4::Watchdog<stm32f4::MemoryRegister>& watchdog;
  Banks& banks;
  CanPort& can;
};

/// The firmware on this board: the cycle in the timer's interrupt, the shell in the background. `Io` is the only
/// difference between the motor board and its emulated twin.
template <typename Io>
class Runtime final : public Board {
 public:
  /// Words of memory that start-up leaves alone.
  using FaultMemory = std::array<std::uint32_t, FaultLog::words_for(Io::kAxes)>;

  Runtime(Io& io, const BoardParts& parts, FaultMemory& fault_memory, const char* board_name)
      : io_(io),
        console_(parts.console),
        name_(board_name),
        tick_(parts.tick),
        watchdog_(parts.watchdog),
        metered_(io, parts.tick),
        application_(metered_, parts.banks, fault_memory),
        sink_(parts.console, parts.tick),
        shell_(application_, sink_, *this, true),
        feed_(parts.console, shell_),
        can_(parts.can),
        setpoints_(kCanNode, can_troubles_),
        can_node_(parts.can, parts.tick, application_, *this, kCanNode, can_troubles_) {}

  /// In the cycle's interrupt: one cycle, if one is due.
  void rt_cycle() {
    const std::uint32_t begin = tick_.core_cycles();
    if (!schedule_.rt_begin(tick_.count(), tick_.since_edge(), tick_.period())) {
      return;
    }
    io_.set_overruns(schedule_.overruns());
    application_.rt_tick(rt_setpoints());
    const std::uint32_t spent = metered_.take_spent();
    timing_.cycle.rt_add(tick_.core_cycles() - begin - spent);
    timing_.hardware.rt_add(spent);
    timing_.overruns.store(schedule_.overruns(), std::memory_order_relaxed);
    watchdog_.rt_refresh();  // only here: a board whose cycle has stopped must not look alive
  }

  /// Joins the bus; without an exact clock, or without a controller, there is no CAN. In main(), before run().
  void start_can(const stm32f4::ClockStatus& clock) {
    const std::uint32_t timing = clock.fell_back() ? 0 : stm32f4::can_bit_timing(clock.apb1_hz, kCanBitRate);
    static_cast<void>(can_.start(timing, {setpoints_.identifiers(), can_node_.identifiers()}));
  }
  void rt_can_isr(std::size_t fifo) { can_.rt_isr(fifo); }

  /// In main(), after everything has been started. Does not return.
  [[noreturn]] void run(const StartReport& report) {
    core_hz_ = report.clock.core_hz;
    application_.set_board_faults(faults_at_start(report));
    Print out(sink_);
    print_start(out, report);
    shell_.print_banner();
    bool timing_printed = false;
    for (;;) {
      if (!watchdog_.taken()) {  // a save left a setting of which nobody knows how long it is
        application_.set_board_faults(faults_at_start(report) | bit(Fault::kWatchdog));
      }
      feed_.poll();
      can_node_.poll();
      if (can_node_.take_bus_loss()) {
        application_.link_lost();
      }
      if (!timing_printed && tick_.count() >= kTimingAfterTicks && !feed_.in_use()) {
        timing_printed = true;
        out << "\r\n";  // the prompt may stand there already
        out << "# timing: ";
        print_timing(out);
      }
      asm volatile("wfi");  // until the next interrupt, a millisecond at most
    }
  }

  [[nodiscard]] auto name() const -> const char* override { return name_; }
  [[nodiscard]] auto simulated() const -> bool override {
    return requires {
      requires Io::kSimulated;
    };
  }
  void print_timing(Print& out) const override {
    stm32f405::print_timing(out, timing_, core_hz_);
    const stm32f4::UsartErrors errors = console_.errors();
    out << "console: received characters lost " << errors.ring_overruns + errors.hardware_overruns << ", damaged "
        << errors.line_errors << "\r\n";
    can_node_.print(out);
    if constexpr (requires { io_.supply_v(); }) {
      out << "supply of the amplifiers " << io_.supply_v() << " V\r\n";
    }
  }
  void print_image(Print& out) const override {
    out << " image ";
    print_hex(out, own_seal());
  }
  void reboot() override {
    const std::uint32_t begin = tick_.count();
    while (console_.write_free() < SerialPort::kTxRoom && tick_.count() - begin < kFarewellTicks) {
    }
    rt_release_outputs();
    reset_core();
  }

 private:
  static constexpr std::uint32_t kTimingAfterTicks = 1'000;
  static constexpr std::uint32_t kFarewellTicks = 200;  // 1024 characters take 90 ms

  /// What came over the bus since the last cycle.
  auto rt_setpoints() -> const typename CanSetpoints<kAxes>::Streamed& {
    setpoints_.rt_begin_cycle();
    stm32f4::CanFrame frame;
    while (can_.rt_receive(0, frame)) {  // bounded by the bus: 21 frames come in a millisecond at most
      setpoints_.rt_take(frame);
    }
    return setpoints_.rt_streamed();
  }

  Io& io_;
  SerialPort& console_;
  const char* name_;
  std::uint32_t core_hz_ = 0;
  BoardTick& tick_;
  stm32f4::Watchdog<stm32f4::MemoryRegister>& watchdog_;
  stm32f4::MeteredIo<Io, BoardTick> metered_;
  Application<stm32f4::MeteredIo<Io, BoardTick>> application_;
  ConsoleSink sink_;
  Shell shell_;
  ConsoleFeed feed_;
  CanPort& can_;
  CanTroubleCounters can_troubles_;
  CanSetpoints<kAxes> setpoints_;
  CanNode<CanPort, BoardTick> can_node_;
  stm32f4::CycleSchedule schedule_;
  Timing timing_;
};

}  // namespace capstan::stm32f405
