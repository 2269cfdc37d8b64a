// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/log/clock_time.hpp"

#include <chrono>

#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;

/// Takes text apart from the left.
class Cutter {
 public:
  explicit Cutter(std::string_view text) : left_(text) {}

  auto digits(std::size_t count) -> std::optional<int> {
    if (left_.size() < count) {
      return std::nullopt;
    }
    int value = 0;
    for (std::size_t i = 0; i < count; ++i) {
      if (left_[i] < '0' || left_[i] > '9') {
        return std::nullopt;
      }
      value = value * 10 + (left_[i] - '0');
    }
    left_.remove_prefix(count);
    return value;
  }
  auto one_of(std::string_view marks) -> bool {
    const bool there = !left_.empty() && marks.find(left_.front()) != std::string_view::npos;
    left_.remove_prefix(there ? 1 : 0);
    return there;
  }
  /// Digits behind a decimal point, to nanoseconds; the rest is dropped.
  auto fraction() -> std::int64_t {
    std::int64_t value = 0;
    std::int64_t unit = kSecond;
    while (!left_.empty() && left_.front() >= '0' && left_.front() <= '9') {
      unit /= 10;
      value += unit * (left_.front() - '0');
      left_.remove_prefix(1);
    }
    return value;
  }
  [[nodiscard]] auto left() const -> std::string_view { return left_; }
  [[nodiscard]] auto done() const -> bool { return left_.empty(); }

 private:
  std::string_view left_;
};

auto days_of(int year, int month, int day) -> std::optional<std::int64_t> {
  const std::chrono::year_month_day date{std::chrono::year{year}, std::chrono::month{static_cast<unsigned>(month)},
                                         std::chrono::day{static_cast<unsigned>(day)}};
  constexpr int kFirstYear = 1970;
  constexpr int kLastYear = 2200;  // nanoseconds since 1970 fit into 64 bits until 2262
  if (!date.ok() || year < kFirstYear || year > kLastYear) {
    return std::nullopt;
  }
  return std::chrono::sys_days(date).time_since_epoch().count();
}

/// "2026-11-22", "2026/11/22" or "22.11.2026"; days since 1970.
auto date(Cutter& text) -> std::optional<std::int64_t> {
  const bool dotted = text.left().size() > 2 && text.left()[2] == '.';
  const char* const marks = dotted ? "." : text.left().size() > 4 && text.left()[4] == '/' ? "/" : "-";
  const auto first = text.digits(dotted ? 2 : 4);
  const bool mark = text.one_of(marks);
  const auto month = text.digits(2);
  const bool again = text.one_of(marks);
  const auto last = text.digits(dotted ? 4 : 2);
  if (!first || !month || !last || !mark || !again) {
    return std::nullopt;
  }
  return dotted ? days_of(*last, *month, *first) : days_of(*first, *month, *last);
}

/// "PM" or nothing behind a time of day: hours to add; nothing if the hour is none of twelve.
auto half_day(Cutter& text, int hour) -> std::optional<int> {
  static_cast<void>(text.one_of(" "));
  const bool morning = text.one_of("Aa");
  const bool evening = !morning && text.one_of("Pp");
  if (!morning && !evening) {
    return 0;
  }
  if (!text.one_of("Mm") || hour < 1 || hour > 12) {
    return std::nullopt;
  }
  return (evening ? 12 : 0) - (hour == 12 ? 12 : 0);
}

/// "05:18:23.123", or "18:23.123" without hours; nanoseconds.
auto time_of_day(Cutter& text) -> std::optional<std::int64_t> {
  const bool no_hours = text.left().size() > 5 && (text.left()[5] == '.' || text.left()[5] == ',');
  const auto hour = no_hours ? std::optional(0) : text.digits(2);
  const bool mark = no_hours || text.one_of(":");
  const auto minute = text.digits(2);
  const bool again = text.one_of(":");
  const auto second = text.digits(2);
  if (!hour || !minute || !second || !mark || !again || *hour > 23 || *minute > 59 || *second > 60) {
    return std::nullopt;
  }
  const std::int64_t fraction = text.one_of(".,") ? text.fraction() : 0;
  const auto later = half_day(text, *hour);
  if (!later) {
    return std::nullopt;
  }
  return (((*hour + *later) * 60LL + *minute) * 60LL + *second) * kSecond + fraction;
}

/// "Z", "+02:00", "+0200", "+02" or nothing; nanoseconds to take off.
auto zone(Cutter& text) -> std::optional<std::int64_t> {
  if (text.done() || (text.one_of("Zz") && text.done())) {
    return 0;
  }
  const bool west = text.left().front() == '-';
  if (!text.one_of("+-")) {
    return std::nullopt;
  }
  const auto hours = text.digits(2);
  static_cast<void>(text.one_of(":"));
  const auto minutes = text.done() ? std::optional(0) : text.digits(2);
  if (!hours || !minutes || !text.done()) {
    return std::nullopt;
  }
  return (west ? -1 : 1) * (*hours * 60LL + *minutes) * 60LL * kSecond;
}

}  // namespace

auto parse_clock(std::string_view text) -> std::optional<ClockTime> {
  Cutter cutter(trimmed(text));
  ClockTime result;
  if (cutter.left().size() < 7) {
    return std::nullopt;
  }
  result.dated = cutter.left()[2] != ':';
  if (result.dated) {
    const auto days = date(cutter);
    if (!days || !cutter.one_of("T ")) {
      return std::nullopt;
    }
    result.nanoseconds = *days * 86400 * kSecond;
  }
  const auto of_day = time_of_day(cutter);
  const auto offset = of_day ? zone(cutter) : std::nullopt;
  if (!of_day || !offset) {
    return std::nullopt;
  }
  result.nanoseconds += *of_day - *offset;
  return result;
}

}  // namespace capstan::tools
