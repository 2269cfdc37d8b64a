// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <exception>
#include <thread>

#include "boards/linux_rt/counted_io.hpp"
#include "firmware/application.hpp"
#include "hal/linux/rt_loop.hpp"
#include "hal/sim/sim_io.hpp"

namespace capstan {

/// The firmware with a real-time thread of its own, every object built once. The joint is the simulated plant, in
/// lock-step with the cycle.
class LinuxRtBoard {
 public:
  using Io = CountedIo<SimIo>;

  LinuxRtBoard(const RtOptions& options, Banks& banks);
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

  [[nodiscard]] auto application() -> Application<Io>& { return application_; }

 private:
  void run();

  sim::Plant plant_;
  SimIo plant_io_;
  Io io_;
  Application<Io> application_;
  RtLoop loop_;
  RtReport report_;
  std::exception_ptr problem_;
  std::atomic<bool> running_ = false;
  std::thread thread_;
};

}  // namespace capstan
