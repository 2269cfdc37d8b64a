// SPDX-License-Identifier: Apache-2.0
#include "tools/log/column_map.hpp"

#include <cmath>

#include "tools/support/errors.hpp"
#include "tools/support/text.hpp"

namespace capstan::tools {

auto parse_mapping(const std::string& text) -> ColumnMapping {
  const auto equals = text.find('=');
  const std::string form = "; write it as --map axis0/q1_rad=q1_motor_rad or --map \"axis0/tau_Nm=current*0.0369\"";
  if (equals == std::string::npos) {
    throw BadInput("--map " + text + ": there is no '='" + form);
  }
  ColumnMapping mapping;
  mapping.wanted = trimmed(std::string_view(text).substr(0, equals));
  const std::string_view right = trimmed(std::string_view(text).substr(equals + 1));
  mapping.source = right;
  const auto star = right.rfind('*');
  if (star != std::string_view::npos) {
    const auto factor = parse_number(right.substr(star + 1));
    if (!factor || !std::isfinite(*factor) || *factor == 0.0) {
      throw BadInput("--map " + text + ": the factor after '*' is not a number other than zero" + form);
    }
    mapping.factor = *factor;
    mapping.source = trimmed(right.substr(0, star));
  }
  if (mapping.wanted.empty() || mapping.source.empty()) {
    throw BadInput("--map " + text + ": a column name is missing" + form);
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
