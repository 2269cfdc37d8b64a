// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace capstan::tools {

/// A time of day, with or without a date.
struct ClockTime {
  std::int64_t nanoseconds = 0;  ///< since 1970-01-01T00:00Z, or since midnight without a date
  bool dated = false;
};

/// Reads ISO 8601 ("2026-11-22T05:18:23.123Z", a blank for the T, a comma for the point, an offset "+02:00"), the same
/// with the date as "22.11.2026" or "2026/11/22", a time of day alone ("05:18:23.123", "05:18:23.123 PM"), and minutes
/// with seconds that have a fraction ("18:23.123"). Nothing for anything else, such as dates with slashes that end in
/// the year, whose order of day and month nobody knows.
auto parse_clock(std::string_view text) -> std::optional<ClockTime>;

}  // namespace capstan::tools
