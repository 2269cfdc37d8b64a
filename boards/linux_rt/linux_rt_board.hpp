// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <exception>
#include <memory>
#include <ostream>
#include <thread>

#include "capstan/boards/linux_rt/rt_joints.hpp"
#include "capstan/firmware/loop/board.hpp"
#include "capstan/firmware/loop/exchange.hpp"
#include "capstan/hal/linux/rt_loop.hpp"

namespace capstan {

/// The firmware with a real-time thread of its own, every object built once.
class LinuxRtBoard final : public Board {
 public:
  /// Throws std::runtime_error with "sentence; cure" if the options are out of range.
  LinuxRtBoard(const RtOptions& options, std::unique_ptr<RtJoints> joints);
  LinuxRtBoard(const LinuxRtBoard&) = delete;
  auto operator=(const LinuxRtBoard&) -> LinuxRtBoard& = delete;
  /// Stops first if it has not been done.
  ~LinuxRtBoard();

  /// Starts the cycle.
  void start();
  /// False once the cycle has ended by itself; stop() then says why.
  [[nodiscard]] auto running() const -> bool { return running_.load(); }
  /// Takes the torque away as a lost link does, lets the cycle carry that out, ends it and releases the joint.
  /// Throws std::runtime_error if the loop could not start or the joints failed.
  auto stop() -> RtReport;

  /// The operator wants to start anew: stop this one and make another on the same banks.
  [[nodiscard]] auto reboot_wanted() const -> bool { return reboot_wanted_; }

  [[nodiscard]] auto name() const -> const char* override { return "linux_rt"; }
  /// @param simulated  the drives are programs   @param means  what the board has beside taking torque away
  void describe(bool simulated, StopMeans means) {
    simulated_drives_ = simulated;
    means_ = means;
  }
  [[nodiscard]] auto simulated() const -> bool override { return simulated_drives_ || joints_->simulated(); }
  [[nodiscard]] auto stop_means() const -> StopMeans override { return means_; }
  void print_timing(Print& out) const override;
  void reboot() override { reboot_wanted_ = true; }

  [[nodiscard]] auto machine() -> Machine& { return joints_->machine(); }
  /// The console is gone, see Application.
  void link_lost() { joints_->link_lost(); }
  /// Sentences about what has gone wrong since the last call. For the background, now and then.
  void report(std::ostream& out) { joints_->report(out); }

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

  std::unique_ptr<RtJoints> joints_;
  RtLoop loop_;
  RtReport report_;
  std::exception_ptr problem_;
  std::atomic<bool> running_ = false;
  bool reboot_wanted_ = false;
  bool simulated_drives_ = false;
  StopMeans means_;
  Published<Timing> timing_;
  std::thread thread_;
};

}  // namespace capstan
