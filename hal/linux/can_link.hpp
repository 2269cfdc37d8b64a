// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "capstan/hal/cia402/bus_budget.hpp"

namespace capstan {

/// What the kernel says about a CAN interface.
struct CanLink {
  std::string name;
  std::string kind;  ///< can, vcan
  bool up = false;
  std::uint32_t send_queue = 0;  ///< frames
  std::uint32_t restart_ms = 0;  ///< after bus-off by itself; 0: never
  cia402::BitRates rates{0, 0};  ///< 0 where there is none, as on vcan
};

/// Throws std::runtime_error with "sentence; cure".
auto read_can_link(const std::string& name) -> CanLink;

/// Empty if torque may depend on this interface, else "sentence; cure".
auto objection_to(const CanLink& link, bool fd) -> std::string;

/// Sets bit rate (of a controller; 0 leaves it), no restart after bus-off, a short send queue, and brings it up. Needs
/// root. Throws std::runtime_error with "sentence; cure".
void bring_up_can_link(const std::string& name, std::uint32_t bit_s);

}  // namespace capstan
