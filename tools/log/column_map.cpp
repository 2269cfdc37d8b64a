// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/log/column_map.hpp"

#include <cmath>

#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {

auto mapping_form() -> std::string {
  return "; write it as --map axis0/q1_rad=q1_motor_rad, --map \"axis0/tau_Nm=current*0.0369\" or --map "
         "\"axis0/q1_rad=deg(0.5*(left + right))\"";
}

auto ColumnMapping::scaled() const -> std::optional<std::pair<std::string, double>> {
  const auto star = expression.rfind('*');
  if (star == std::string::npos) {
    return std::nullopt;
  }
  const auto factor = parse_number(std::string_view(expression).substr(star + 1));
  if (!factor || !std::isfinite(*factor)) {
    return std::nullopt;
  }
  return std::pair(std::string(trimmed(std::string_view(expression).substr(0, star))), *factor);
}

auto parse_mapping(const std::string& text) -> ColumnMapping {
  const auto equals = text.find('=');
  if (equals == std::string::npos) {
    throw BadInput("--map " + text + ": there is no '='" + mapping_form());
  }
  ColumnMapping mapping;
  mapping.wanted = trimmed(std::string_view(text).substr(0, equals));
  mapping.expression = trimmed(std::string_view(text).substr(equals + 1));
  if (mapping.wanted.empty() || mapping.expression.empty()) {
    throw BadInput("--map " + text + ": a column name is missing" + mapping_form());
  }
  const auto star = mapping.expression.rfind('*');
  if (star != std::string::npos) {
    const auto last = trimmed(std::string_view(mapping.expression).substr(star + 1));
    const auto factor = parse_number(last);
    if (last.empty() || (factor && (!std::isfinite(*factor) || *factor == 0.0))) {
      throw BadInput("--map " + text + ": the factor after '*' is not a number other than zero" + mapping_form());
    }
  }
  return mapping;
}

auto parse_mappings(const std::vector<std::string>& texts) -> std::vector<ColumnMapping> {
  std::vector<ColumnMapping> mappings;
  for (const auto& text : texts) {
    mappings.push_back(parse_mapping(text));
    for (std::size_t i = 0; i + 1 < mappings.size(); ++i) {
      if (mappings[i].wanted == mappings.back().wanted) {
        throw BadInput("--map gives " + mappings.back().wanted + " twice; keep one of them");
      }
    }
  }
  return mappings;
}

}  // namespace capstan::tools
