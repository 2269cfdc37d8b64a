// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/log/time_scale.hpp"

#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

/// s. Joints are logged at 4 Hz at least (the slowest of the 83 measured ones), so a millisecond's whole number is
/// above.
constexpr double kSlowestPeriod = 1.0;
/// Steps that are likelier microseconds than milliseconds, and nanoseconds than microseconds: 2 Hz in the smaller unit.
constexpr double kMicroseconds = 500.0;
constexpr double kNanoseconds = 500e3;

}  // namespace

auto time_unit_fault(double period_s) -> std::string {
  if (period_s < kSlowestPeriod) {
    return {};
  }
  const bool nano = period_s >= kNanoseconds;
  const bool micro = !nano && period_s >= kMicroseconds;
  const char* unit = nano ? "nanoseconds" : micro ? "microseconds" : "milliseconds";
  const char* factor = nano ? "1e-9" : micro ? "1e-6" : "1e-3";
  return "time_s steps by " + rounded(period_s) + ", which looks like " + unit +
         ", not seconds; read it with --map \"time_s=time_s*" + factor +
         "\" (--map \"time_s=time_s*1\" if it is seconds)";
}

}  // namespace capstan::tools
