// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/firmware/console/text.hpp"
#include "capstan/firmware/parameters/parameters.hpp"

namespace capstan {

enum class ValueError : std::uint8_t { kNone, kNotANumber, kUnit, kRange };

/// Reads a value with or without its unit ("4 Nm/rad", "30deg", "0.02"). Degrees, milli-units and the like of the
/// parameter's unit are converted; any other unit is refused.
auto parse_value(std::string_view text, const ParameterInfo& parameter, std::int32_t& raw) -> ValueError;

/// Reads a quantity of the given unit that is no parameter, such as the target of a move.
auto parse_quantity(std::string_view text, std::string_view unit, Q24& value) -> ValueError;

/// "4 Nm/rad"
void print_value(Print& out, const ParameterInfo& parameter, std::int32_t raw);
/// "0 to 100 Nm/rad"
void print_range(Print& out, const ParameterInfo& parameter);

}  // namespace capstan
