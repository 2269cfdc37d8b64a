// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

namespace capstan::tools {

/// Values from low to high in equal ratios. @pre 0 < low, count > 1
inline auto geometric_grid(double low, double high, std::size_t count) -> std::vector<double> {
  std::vector<double> values;
  for (std::size_t i = 0; i < count; ++i) {
    values.push_back(low * std::pow(high / low, static_cast<double>(i) / static_cast<double>(count - 1)));
  }
  return values;
}

/// Settings of one value each.
inline auto one_by_one(const std::vector<double>& values) -> std::vector<std::vector<double>> {
  std::vector<std::vector<double>> settings;
  for (const double value : values) {
    settings.push_back({value});
  }
  return settings;
}

/// Every combination of the values of each; of none the empty one. @param values_of  gives one's values
template <typename Several, typename ValuesOf>
auto combinations(const Several& several, ValuesOf&& values_of) -> std::vector<std::vector<double>> {
  std::vector<std::vector<double>> settings = {{}};
  for (const auto& one : several) {
    std::vector<std::vector<double>> next;
    for (const auto& start : settings) {
      for (const double value : values_of(one)) {
        next.push_back(start);
        next.back().push_back(value);
      }
    }
    settings = std::move(next);
  }
  return settings;
}

}  // namespace capstan::tools
