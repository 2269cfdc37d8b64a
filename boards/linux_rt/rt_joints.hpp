// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <ostream>
#include <span>
#include <string>

#include "capstan/firmware/console/text.hpp"
#include "capstan/firmware/loop/machine.hpp"
#include "capstan/hal/linux/can_bus.hpp"
#include "capstan/hal/linux/gpio_lines.hpp"

namespace capstan {

/// The firmware with the joints it drives, whatever they are and however many. The cycle's thread calls rt_tick, all
/// others belong to the background.
class RtJoints {
 public:
  virtual ~RtJoints() = default;

  /// One cycle. @param overruns  edges missed since start
  virtual void rt_tick(std::uint32_t overruns) = 0;
  /// De-energises. Only while no cycle runs.
  virtual void release() = 0;
  [[nodiscard]] virtual auto machine() -> Machine& = 0;
  /// The console is gone, see Application.
  virtual void link_lost() = 0;
  /// Why the joints can not go on; empty while they can.
  /// They are programs, not drives.
  [[nodiscard]] virtual auto simulated() const -> bool { return false; }
  [[nodiscard]] virtual auto failure() const -> std::string { return ""; }
  /// What was lost, in lines that end in CR LF.
  virtual void print(Print& /*out*/) const {}
  /// Sentences about what has gone wrong since the last call.
  virtual void report(std::ostream& /*out*/) {}
};

/// One simulated joint inside this program. Throws std::runtime_error if the lines can not be had.
/// @param fault_memory  FaultLog::words_for(1) words that outlive the joints; empty: no fault log
auto simulated_joints(Banks& banks, const GpioSetup& gpio = {}, std::span<std::uint32_t> fault_memory = {})
    -> std::unique_ptr<RtJoints>;

/// Drives on CAN buses, one to four in all, set up and operational. Throws std::runtime_error with "sentence; cure".
auto can_joints(const CanSetup& setup, const GpioSetup& gpio, Banks& banks, std::span<std::uint32_t> fault_memory,
                std::ostream& out) -> std::unique_ptr<RtJoints>;

}  // namespace capstan
