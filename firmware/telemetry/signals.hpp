// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string_view>

#include "capstan/firmware/console/text.hpp"
#include "capstan/firmware/loop/cycle.hpp"

namespace capstan {

enum class SignalType : std::uint8_t { kReal, kWord, kByte };

/// One number of the telemetry. The table feeds scope and watch; there is no second list.
struct SignalInfo {
  const char* name;    ///< after "jointN." or "machine."
  const char* column;  ///< in a log, after "axisN/" for a joint's
  const char* unit;    ///< "1" for pure numbers
  const char* doc;
  SignalType type;
  std::uint16_t offset;  ///< into AxisTelemetry or MachineTelemetry
};

/// What a scope, a recorder or a watch takes at once.
inline constexpr std::size_t kMostSignals = 8;

/// What each joint has, and what the machine has once.
auto joint_signals() -> std::span<const SignalInfo>;
auto machine_signals() -> std::span<const SignalInfo>;

/// A signal of a certain joint or of the machine.
struct Signal {
  static constexpr std::uint8_t kMachine = 0xFF;
  const SignalInfo* info = nullptr;
  std::uint8_t axis = kMachine;
};

/// "joint0.q2" or "machine.state"; `info` is nullptr if there is none of that name on a machine of so many joints.
auto find_signal(std::string_view text, std::size_t axes) -> Signal;
/// The signal's value now: raw Q24, or an integer. For the cycle too. @pre signal.info is not nullptr
auto rt_raw(const Signal& signal, const MachineTelemetry& machine, std::span<const AxisTelemetry> axes) -> std::int32_t;

void print_name(Print& out, const Signal& signal);
void print_column(Print& out, const Signal& signal);
/// Without its unit.
void print_raw(Print& out, const Signal& signal, std::int32_t raw);

}  // namespace capstan
