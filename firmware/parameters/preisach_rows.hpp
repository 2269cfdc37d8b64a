// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string_view>
#include <utility>

#include "capstan/firmware/parameters/parameter_rows.hpp"

namespace capstan {

/// "input_3", "force_10_7": the grid's rows have numbers instead of names.
struct GridName {
  std::array<char, 12> text{};
  constexpr explicit GridName(std::string_view stem) {
    for (const char c : stem) {
      text[size_++] = c;
    }
  }
  constexpr auto with(std::size_t number) const -> GridName {
    GridName longer = *this;
    longer.text[longer.size_++] = '_';
    if (number > 9) {
      longer.text[longer.size_++] = static_cast<char>('0' + number / 10);
    }
    longer.text[longer.size_++] = static_cast<char>('0' + number % 10);
    return longer;
  }

 private:
  std::size_t size_ = 0;
};

using ForceGrid = decltype(ForceConfig::grid);
inline constexpr std::size_t kGridRows = ForceConfig::kLevels + ForceGrid::kMaxValues;
constexpr auto make_grid_names() {
  std::array<GridName, kGridRows> names = []<std::size_t... I>(std::index_sequence<I...>) {
    return std::array<GridName, kGridRows>{((void)I, GridName(""))...};
  }
  (std::make_index_sequence<kGridRows>{});
  std::size_t next = 0;
  for (std::size_t level = 0; level < ForceConfig::kLevels; ++level) {
    names[next++] = GridName("input").with(level);
  }
  for (std::size_t row = 0; row < ForceConfig::kLevels; ++row) {
    for (std::size_t column = 0; column <= row; ++column) {
      names[next++] = GridName("force").with(row).with(column);
    }
  }
  return names;
}
inline constexpr std::array<GridName, kGridRows> kGridNames = make_grid_names();

/// The rows of the Preisach law: how many levels its grid of reversal values has, then the grid.
constexpr auto make_preisach_table() -> std::array<ParameterInfo, 1 + kGridRows> {
  constexpr std::size_t kGrid = offsetof(AxisConfig, force) + offsetof(ForceConfig, grid);
  constexpr double kMost = 127.0;
  std::array<ParameterInfo, 1 + kGridRows> table{};
  table[0] = integer("preisach", "levels", "1", "levels of the grid of reversal values",
                     kGrid + offsetof(ForceGrid, levels), 0, ForceConfig::kLevels);
  for (std::size_t i = 0; i < kGridRows; ++i) {
    const bool input = i < ForceConfig::kLevels;
    const std::size_t offset = input ? offsetof(ForceGrid, inputs) + i * sizeof(Q24)
                                     : offsetof(ForceGrid, forces) + (i - ForceConfig::kLevels) * sizeof(Q24);
    table[1 + i] = real("preisach", kGridNames[i].text.data(), "Nm",
                        input ? "motor torque of this level, in increasing order"
                              : "joint torque after a rise to the first level and a fall to the second",
                        kGrid + offset, -kMost, kMost);
  }
  return table;
}
inline constexpr std::array<ParameterInfo, 1 + kGridRows> kPreisachTable = make_preisach_table();

}  // namespace capstan
