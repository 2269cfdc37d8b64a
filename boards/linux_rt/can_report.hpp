// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <ostream>

#include "capstan/firmware/console/text.hpp"
#include "capstan/hal/linux/can_bus.hpp"

namespace capstan {

/// Every counter of a bus that is not zero, and the states of its drives.
void print_counters(Print& out, const CanBus& bus);

/// Turns a bus's journal into sentences, each as it happens: what it said before it does not say again before it has
/// happened twice as often, so that a flood of troubles is no flood of lines.
class CanReport {
 public:
  void say_news(std::ostream& out, const CanBus& bus);

 private:
  void say_emergencies(std::ostream& out, const CanBus& bus, std::size_t source);

  std::array<std::array<std::uint32_t, cia402::kAnomalies>, cia402::Journal::kSources> said_{};
};

}  // namespace capstan
