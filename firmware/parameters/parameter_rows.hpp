// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "capstan/firmware/parameters/parameters.hpp"

namespace capstan {

// Rows of the parameter table.

constexpr auto real(const char* group, const char* name, const char* unit, const char* doc, std::size_t offset,
                    double minimum, double maximum, ParameterChange change = ParameterChange::kDisarmed)
    -> ParameterInfo {
  return {group,
          name,
          unit,
          doc,
          ParameterType::kReal,
          change,
          static_cast<std::uint16_t>(offset),
          Q24::from_double(minimum).raw(),
          Q24::from_double(maximum).raw()};
}

constexpr auto integer(const char* group, const char* name, const char* unit, const char* doc, std::size_t offset,
                       std::int32_t minimum, std::int32_t maximum, ParameterChange change = ParameterChange::kDisarmed)
    -> ParameterInfo {
  return {group,   name,   unit, doc, ParameterType::kInteger, change, static_cast<std::uint16_t>(offset),
          minimum, maximum};
}

/// Of a law's term.
constexpr auto shape(const char* group, const ShapeInfo& s, std::size_t offset) -> ParameterInfo {
  ParameterInfo row = real(group, s.name, s.unit, s.doc, offset, std::min(0.0, s.minimum), s.maximum);
  row.type = s.whole ? ParameterType::kWhole : ParameterType::kReal;
  return row;
}

}  // namespace capstan
