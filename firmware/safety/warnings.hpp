// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "capstan/firmware/safety/code_info.hpp"

namespace capstan {

/// What somebody should look at; nothing is stopped by it. Numbers are append-only, like those of faults.
enum class Warning : std::uint8_t {
  kLawMisfit = 0,
  kFrictionHigher = 1,
  kFrictionLower = 2,
  kThermometerLost = 3,
  kLimitCycle = 4,
};

using WarningInfo = CodeInfo<Warning>;

/// One table for shell, heartbeat and documentation.
inline constexpr std::array<WarningInfo, 5> kWarningTable = {{
    {Warning::kLawMisfit, "law_misfit",
     "the joint's sensor and the law differ by more than monitor.excess times monitor.joint_rms",
     "look for wear, slack and a pulley that slipped, and identify the law again"},
    {Warning::kFrictionHigher, "friction_higher",
     "moving the joint back and forth takes more torque than control.torque_forward and torque_backward say",
     "look for wear, dirt and a tip that touches something, and identify the law again"},
    {Warning::kFrictionLower, "friction_lower",
     "moving the joint back and forth takes less torque than control.torque_forward and torque_backward say",
     "look for lost pretension or a tendon that came off, and identify the law again"},
    {Warning::kThermometerLost, "thermometer_lost",
     "the thermometer gave values and gives none now, so thermal_drift stays at the last one", "check its cable"},
    {Warning::kLimitCycle, "limit_cycle", "the joint oscillates by its own control, without a command to move",
     "lower control.stiffness, damping, kp and ki, or take gains from 'capstan tune'"},
}};
static_assert(in_order(kWarningTable));

/// A set of warnings, one bit each.
using WarningSet = std::uint8_t;
static_assert(kWarningTable.size() <= 8);
constexpr auto bit(Warning warning) -> WarningSet {
  return static_cast<WarningSet>(1U << static_cast<unsigned>(warning));
}

}  // namespace capstan
