// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "capstan/hal/linux/can_bus.hpp"
#include "capstan/hal/linux/gpio_lines.hpp"

namespace capstan {

// What the board's command line says about hardware. All throw std::runtime_error with "sentence; cure".

/// "can0:1,2" or "unix:PATH:1,2".
auto parse_can_bus(const std::string& text) -> CanBusSetup;
/// "separate" or "packed".
auto parse_pdo_layout(const std::string& text) -> cia402::PdoLayout;
/// A drive profile's file, see docs/cia402_drives.md.
auto read_drive_profile(const std::string& file) -> cia402::DriveProfile;
/// "/dev/gpiochip0:estop=3,enable=4,brake=!5,watchdog=6"; ! inverts.
auto parse_gpio(const std::string& text) -> GpioSetup;
/// What no single option can say: at most two buses and four drives, no interface or node twice.
void check(const CanSetup& setup);

}  // namespace capstan
