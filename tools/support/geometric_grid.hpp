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

}  // namespace capstan::tools
