// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/log/time_scale.hpp"

#include <string>
#include <vector>

#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

/// s. Joints are logged at 4 Hz at least (the slowest of the 83 measured ones), and at 20 kHz at most.
constexpr double kSlowestPeriod = 0.3;
constexpr double kFastestPeriod = 50e-6;

struct SmallUnit {
  const char* name;
  const char* factor;
  double seconds;
};
constexpr SmallUnit kUnits[] = {
    {"milliseconds", "1e-3", 1e-3}, {"microseconds", "1e-6", 1e-6}, {"nanoseconds", "1e-9", 1e-9}};

}  // namespace

auto time_unit_fault(double period_s) -> std::string {
  if (period_s < kSlowestPeriod) {
    return {};
  }
  std::vector<std::string> units;
  std::vector<std::string> cures;
  for (const SmallUnit& unit : kUnits) {
    const double period = period_s * unit.seconds;
    if (period >= kFastestPeriod && period <= kSlowestPeriod) {
      units.push_back(std::string(unit.name) + " (" + rounded(1.0 / period, 5) + " Hz)");
      cures.push_back(std::string("--map \"time_s=time_s*") + unit.factor + "\"");
    }
  }
  const std::string steps = "time_s steps by " + rounded(period_s) + ", which ";
  const std::string seconds = "--map \"time_s=time_s*1\" if it is seconds";
  return units.empty()
             ? steps + "is no log of a joint in seconds; read it with --map \"time_s=time_s*FACTOR\", or " + seconds
             : steps + "looks like " + joined(units, " or ") + ", not seconds; read it with " + joined(cures, " or ") +
                   " (" + seconds + ")";
}

}  // namespace capstan::tools
