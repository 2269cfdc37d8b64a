// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/log/csv_cells.hpp"

#include <algorithm>
#include <array>
#include <cctype>

#include "capstan/tools/log/clock_time.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

auto lower_case(std::string_view text) -> std::string {
  std::string lower(text);
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return lower;
}

/// What numpy, pandas, MATLAB and databases write where nothing was measured.
auto is_missing(std::string_view cell) -> bool {
  constexpr std::array kWords = {"", "nan", "-nan", "na", "n/a", "<na>", "null", "none"};
  return is_one_of(kWords, lower_case(trimmed(cell)));
}

auto has_digit(std::string_view cell) -> bool {
  return std::any_of(cell.begin(), cell.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
}

auto is_blank(char c) -> bool {
  return c == ' ' || c == '\t';
}

/// "1.5D-03": as "1.5E-03".
auto is_fortran(std::string_view cell) -> bool {
  std::string text(trimmed(cell));
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == 'D' || c == 'd'; }, 'E');
  return text != trimmed(cell) && parse_number(text);
}

auto is_value(const std::string& cell) -> bool {
  return !is_missing(cell) && (parse_number(cell) || with_decimal_point(cell) || has_thousands(cell) ||
                               is_fortran(cell) || parse_clock(cell));
}

/// "11/22/2026 05:00:00"
auto is_slashed_date(std::string_view cell) -> bool {
  const std::string_view date = trimmed(cell).substr(0, trimmed(cell).find(' '));
  return std::count(date.begin(), date.end(), '/') == 2 && has_digit(date) &&
         date.find_first_not_of("0123456789/") == std::string_view::npos;
}

}  // namespace

auto is_remark(std::string_view line) -> bool {
  return line.starts_with(kRemark) || line.starts_with('%');
}

auto cells_of(std::string_view line, Separator separator) -> std::vector<std::string> {
  std::vector<std::string> cells(1);
  bool quoted = false;
  const char mark = separator == Separator::kTab         ? '\t'
                    : separator == Separator::kSemicolon ? ';'
                    : separator == Separator::kBar       ? '|'
                                                         : ',';
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    const std::string_view so_far = trimmed(cells.back());
    if (quoted) {
      const bool doubled = c == '"' && i + 1 < line.size() && line[i + 1] == '"';
      quoted = c != '"' || doubled;
      cells.back() += quoted ? std::string(1, c) : "";
      i += doubled ? 1 : 0;
    } else if (c == '"' && so_far.empty()) {
      quoted = true;
    } else if (separator == Separator::kWideBlanks || separator == Separator::kBlanks) {
      const std::size_t end = std::min(line.find_first_not_of(" \t", i), line.size());
      const bool cut = is_blank(c) && (separator == Separator::kBlanks || c == '\t' || end - i > 1);
      if (cut && end < line.size()) {
        cells.emplace_back();
      }
      cells.back() += is_blank(c) ? (cut ? "" : " ") : std::string(1, c);
      i = is_blank(c) ? end - 1 : i;
    } else if (c == mark) {
      cells.emplace_back();
    } else {
      cells.back() += c;
    }
  }
  if (quoted) {
    throw Unclosed{};
  }
  for (auto& cell : cells) {
    cell = std::string(trimmed(cell));
  }
  return cells;
}

auto with_decimal_point(std::string_view cell) -> std::optional<std::string> {
  const auto comma = cell.find(',');
  if (comma == std::string_view::npos || cell.find('.') != std::string_view::npos) {
    return std::nullopt;
  }
  std::string text(cell);
  text[comma] = '.';
  return parse_number(text) ? std::optional(text) : std::nullopt;
}

auto has_thousands(std::string_view cell) -> bool {
  if (cell.find('.') == std::string_view::npos || cell.find(',') == std::string_view::npos) {
    return false;
  }
  std::string text;
  std::copy_if(cell.begin(), cell.end(), std::back_inserter(text), [](char c) { return c != '.' && c != ','; });
  return parse_number(text).has_value();
}

auto is_data(const std::vector<std::string>& cells) -> bool {
  const auto filled = std::count_if(cells.begin(), cells.end(), [](const auto& cell) { return !is_missing(cell); });
  return filled > 0 && std::count_if(cells.begin(), cells.end(), is_value) * 2 >= filled;
}

auto is_unit_word(std::string_view word) -> bool {
  constexpr std::array kUnits = {"s",      "ms",      "us",   "µs",    "ns",   "sec",   "seconds", "rad",    "deg",
                                 "°",      "mrad",    "m",    "mm",    "um",   "Nm",    "N m",     "N*m",    "N.m",
                                 "mNm",    "Nmm",     "N",    "kN",    "A",    "mA",    "V",       "mV",     "C",
                                 "°C",     "degC",    "K",    "Hz",    "rpm",  "rad/s", "deg/s",   "rad/s²", "rad/s^2",
                                 "rad/s2", "deg/s^2", "m/s",  "m/s^2", "mm/s", "%",     "-",       "1",      "counts",
                                 "cnt",    "ticks",   "bool", "N·m",   "1/min"};
  word = trimmed(word);
  if (word.size() > 2 && ((word.front() == '[' && word.back() == ']') || (word.front() == '(' && word.back() == ')'))) {
    return true;
  }
  return is_one_of(kUnits, word);
}

auto is_units_row(const std::vector<std::string>& cells) -> bool {
  const auto units = [](const auto& cell) { return cell.empty() || is_unit_word(cell); };
  return std::all_of(cells.begin(), cells.end(), units) &&
         std::any_of(cells.begin(), cells.end(), [](const auto& cell) { return !cell.empty(); });
}

auto is_types_row(const std::vector<std::string>& cells) -> bool {
  constexpr std::array kTypes = {"float",   "double",  "single", "int",     "integer", "number", "numeric", "real",
                                 "float32", "float64", "int8",   "int16",   "int32",   "int64",  "uint8",   "uint16",
                                 "uint32",  "uint64",  "bool",   "boolean", "string",  "str",    "datetime"};
  return std::all_of(cells.begin(), cells.end(), [&](const auto& cell) { return is_one_of(kTypes, lower_case(cell)); });
}

auto no_number(std::string_view cell, bool may_be_empty, const std::string& log) -> std::string {
  const std::string word(trimmed(cell));
  if (may_be_empty && !word.empty() && is_missing(word)) {
    return ", which is not a number; leave the cells empty where nothing was measured, with `sed -E ':a; "
           "s#(^|[,;\\t])\"?" +
           word + "\"?([,;\\t]|\\r?$)#\\1\\2#; ta' " + log + " > log.csv`";
  }
  if (is_slashed_date(word)) {
    return ", a date that does not say which number is the day and which the month; write it as 2026-11-22 "
           "05:18:23.123";
  }
  if (is_fortran(word)) {
    return ", which is not a number, as Fortran's exponents begin with a D; write an E with `sed -E "
           "'s/([0-9.])[Dd]([-+]?[0-9])/\\1E\\2/g' " +
           log + " > log.csv`";
  }
  return ", which is not a number; repair the line or cut the log before it";
}

}  // namespace capstan::tools
