// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "capstan/tools/log/channel_gate.hpp"

namespace capstan::tools::test {

/// What was done to a log. The first is nothing.
enum class Injury { kNone, kHeld, kLate, kUnsigned, kSpiked, kDegrees, kTimeUnit, kVeryLate };
inline constexpr Injury kInjuries[] = {Injury::kHeld,    Injury::kLate,     Injury::kUnsigned, Injury::kSpiked,
                                       Injury::kDegrees, Injury::kTimeUnit, Injury::kVeryLate};
auto injury_word(Injury injury) -> const char*;

struct NamedSignal {
  std::string name;
  ChannelRole role = ChannelRole::kOther;
  Eigen::VectorXd values;
};

struct ChannelLog {
  std::string source;  ///< which generator
  Eigen::VectorXd time_s;
  std::vector<NamedSignal> signals;
};

/// A clean log drawn by chance: joints and driven axes of the generators in tests/tools and tests/tools/blind, without
/// effects and with them.
auto clean_log(std::uint64_t seed) -> ChannelLog;

struct Injured {
  ChannelLog log;
  std::string channel;  ///< the one that was hurt; empty: the injury makes no sense for this log
  double size = 0.0;    ///< rows held, rows late, spikes, the unit
};

/// The same log with one channel hurt, which and how badly by chance.
auto injured(const ChannelLog& clean, Injury injury, std::uint64_t seed) -> Injured;

/// What the gate says of it.
struct Verdicts {
  bool time_unit = false;
  std::vector<ChannelFinding> findings;
};
auto judged(const ChannelLog& log) -> Verdicts;

/// Whether the injury is among the verdicts, with its channel.
auto is_named(const Verdicts& verdicts, Injury injury, const std::string& channel) -> bool;

}  // namespace capstan::tools::test
