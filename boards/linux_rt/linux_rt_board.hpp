// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <exception>
#include <thread>

#include "boards/linux_rt/counted_io.hpp"
#include "firmware/application.hpp"
#include "firmware/board.hpp"
#include "hal/linux/rt_loop.hpp"
#include "hal/sim/sim_io.hpp"

namespace capstan {

/// The firmware with a real-time thread of its own, every object built once. The joint is the simulated plant, in
/// lock-step with the cycle.
class LinuxRtBoard final : public Board {
 public:
  using Io = CountedIo<SimIo>;

  /// @param fault_memory  FaultLog::words_for(1) words that outlive this object; empty: no fault log
  LinuxRtBoard(const RtOptions& options, Banks& banks, std::span<std::uint32_t> fault_memory = {});
  LinuxRtBoard(const LinuxRtBoard&) = delete;
  auto operator=(const LinuxRtBoard&) -> LinuxRtBoard& = delete;
  /// Stops first if it has not been done.
  ~LinuxRtBoard();

  /// Starts the cycle.
  void start();
  /// False once the cycle has ended by itself; stop() then says why.
  [[nodiscard]] auto running() const -> bool { return running_.load(); }
  /// Takes the torque away as a lost link does, lets the cycle carry that out, ends it and releases the joint.
  /// Throws std::runtime_error if the loop could not start or the plant failed.
  auto stop() -> RtReport;

  /// The operator wants to start anew: stop this one and make another on the same banks.
  [[nodiscard]] auto reboot_wanted() const -> bool { return reboot_wanted_; }

  [[nodiscard]] auto name() const -> const char* override { return "linux_rt"; }
  void print_timing(Print& out) const override;
  void reboot() override { reboot_wanted_ = true; }

  [[nodiscard]] auto application() -> Application<Io>& { return application_; }

 private:
  /// What `timing` shows, in us; written by the cycle.
  struct Timing {
    std::int32_t late = 0;
    std::int32_t latest = 0;
    std::int32_t cycle = 0;
    std::int32_t longest = 0;
    std::uint32_t page_faults = 0;
  };

  void run();
  void rt_note(const RtTick& tick, Timing& timing);

  sim::Plant plant_;
  SimIo plant_io_;
  Io io_;
  Application<Io> application_;
  RtLoop loop_;
  RtReport report_;
  std::exception_ptr problem_;
  std::atomic<bool> running_ = false;
  bool reboot_wanted_ = false;
  Published<Timing> timing_;
  std::thread thread_;
};

}  // namespace capstan
