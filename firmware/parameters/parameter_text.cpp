// SPDX-License-Identifier: Apache-2.0
#include "capstan/firmware/parameters/parameter_text.hpp"

#include <array>

namespace capstan {
namespace {

struct Conversion {
  std::string_view from;
  std::string_view to;
  UnitScale scale;
};

// Units that people type instead of the one a parameter has.
constexpr std::array<Conversion, 7> kConversions = {{
    {"deg", "rad", {.degrees = true}},
    {"deg/s", "rad/s", {.degrees = true}},
    {"deg/s2", "rad/s2", {.degrees = true}},
    {"ms", "s", {.exponent = -3}},
    {"mA", "A", {.exponent = -3}},
    {"mNm", "Nm", {.exponent = -3}},
    {"mrad", "rad", {.exponent = -3}},
}};

/// How to get from the unit that follows the number to the wanted one; nullptr if there is no way.
auto scale_of(std::string_view given, std::string_view wanted) -> const UnitScale* {
  static constexpr UnitScale kSame{};
  if (given.empty() || given == wanted) {
    return &kSame;
  }
  for (const Conversion& conversion : kConversions) {
    if (given == conversion.from && wanted == conversion.to) {
      return &conversion.scale;
    }
  }
  return nullptr;
}

/// No unit begins so: what is before it in "0x10", "1,5" or "1e" is not all of a number.
auto breaks_off(std::string_view rest) -> bool {
  constexpr std::string_view kInNumbers = ",.'_:+-xXeE";
  return !rest.empty() && kInNumbers.find(rest.front()) != std::string_view::npos;
}

}  // namespace

auto parse_quantity(std::string_view text, std::string_view unit, Q24& value) -> ValueError {
  skip_blanks(text);
  std::size_t used = 0;
  Q24 number;
  if (parse_real(text, number, used) == ParseResult::kNotANumber) {
    return ValueError::kNotANumber;
  }
  std::string_view rest = text;
  rest.remove_prefix(used);
  if (breaks_off(rest)) {
    return ValueError::kNotANumber;
  }
  const UnitScale* scale = scale_of(next_word(rest), unit);
  if (scale == nullptr || !next_word(rest).empty()) {
    return ValueError::kUnit;
  }
  return parse_scaled(text, *scale, value, used) == ParseResult::kOk ? ValueError::kNone : ValueError::kRange;
}

auto parse_value(std::string_view text, const ParameterInfo& parameter, std::int32_t& raw) -> ValueError {
  if (parameter.type != ParameterType::kInteger) {
    Q24 value;
    const ValueError error = parse_quantity(text, parameter.unit, value);
    if (error != ValueError::kNone) {
      return error;
    }
    raw = value.raw();
  } else {
    std::string_view rest = text;
    const std::string_view number = next_word(rest);
    const ParseResult result = parse_integer(number, raw);
    if (result == ParseResult::kNotANumber || !next_word(rest).empty()) {
      return ValueError::kNotANumber;
    }
    if (result == ParseResult::kOutOfRange) {
      return ValueError::kRange;
    }
  }
  if (raw < parameter.minimum || raw > parameter.maximum) {
    return ValueError::kRange;
  }
  const bool part = parameter.type == ParameterType::kWhole && nearest_whole(Q24::from_raw(raw)).raw() != raw;
  return part ? ValueError::kNotANumber : ValueError::kNone;
}

void print_value(Print& out, const ParameterInfo& parameter, std::int32_t raw) {
  if (parameter.type != ParameterType::kInteger) {
    out << Q24::from_raw(raw);
  } else {
    out << raw;
  }
  if (std::string_view(parameter.unit) != "1") {
    out << ' ' << parameter.unit;
  }
}

void print_range(Print& out, const ParameterInfo& parameter) {
  if (parameter.type != ParameterType::kInteger) {
    out << Q24::from_raw(parameter.minimum);
  } else {
    out << parameter.minimum;
  }
  out << " to ";
  print_value(out, parameter, parameter.maximum);
}

}  // namespace capstan
