// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "capstan/model/scalar.hpp"

namespace capstan {

/// First-order reversal values f_ab of a hysteresis (thesis 4.2): rise from the lower saturation to the input a, fall
/// to b <= a, note the force. Plain data that may live in flash. A value nobody has set counts as missing. Rows are the
/// levels of a, columns those of b; both use the same levels, which need not be evenly spaced.
template <typename Scalar, std::size_t MaxLevels>
struct ReversalTable {
  static_assert(MaxLevels >= 2 && MaxLevels < 1024);
  static constexpr std::size_t kMaxLevels = MaxLevels;
  static constexpr std::size_t kMaxValues = MaxLevels * (MaxLevels + 1) / 2;

  std::uint32_t levels = 0;                           ///< how many of the levels are in use, 2 to MaxLevels
  std::array<Scalar, MaxLevels> inputs{};             ///< strictly increasing; the ends are the input's range
  std::array<Scalar, kMaxValues> forces = missing();  ///< the triangle row by row

  /// @pre column <= row < MaxLevels
  static constexpr auto index(std::size_t row, std::size_t column) -> std::size_t {
    return row * (row + 1) / 2 + column;
  }
  [[nodiscard]] constexpr auto force(std::size_t row, std::size_t column) const -> Scalar {
    return forces[index(row, column)];
  }
  constexpr void set_force(std::size_t row, std::size_t column, Scalar value) { forces[index(row, column)] = value; }

 private:
  static constexpr auto missing() -> std::array<Scalar, kMaxValues> {
    std::array<Scalar, kMaxValues> values{};
    values.fill(ScalarTraits<Scalar>::missing());
    return values;
  }
};

enum class TableFault : std::uint8_t {
  kNone,
  kLevelCount,
  kInputsNotIncreasing,
  kMissingForce,
  kSpanTooWide,
  kFallsAlongRow,
  kFallsAlongColumn,
  kSaturationDiffers,
};

/// What is wrong with a table, and where (row and column of the first offender, from 0).
struct TableCheck {
  TableFault fault = TableFault::kNone;
  std::size_t row = 0;
  std::size_t column = 0;
  [[nodiscard]] constexpr auto ok() const -> bool { return fault == TableFault::kNone; }
};

/// Cause and cure in one sentence; the caller adds row and column.
constexpr auto describe(TableFault fault) -> const char* {
  switch (fault) {
    case TableFault::kNone:
      return "the reversal table is complete and monotone";
    case TableFault::kLevelCount:
      return "the reversal table has fewer than two levels or more than the model holds; measure on a grid that fits";
    case TableFault::kInputsNotIncreasing:
      return "the input levels do not increase strictly; sort them and drop the one that repeats";
    case TableFault::kMissingForce:
      return "a reversal value is missing or out of the number range; measure that reversal curve again";
    case TableFault::kSpanTooWide:
      return "the forces at the two saturations are too far apart for the number format; give the force in a larger "
             "unit";
    case TableFault::kFallsAlongRow:
      return "the force falls while the input of one curve rises; average more repeats or raise the tolerance to the "
             "noise";
    case TableFault::kFallsAlongColumn:
      return "a higher peak gives less force at the same input; average more repeats or raise the tolerance to the "
             "noise";
    case TableFault::kSaturationDiffers:
      return "the curves do not end in one lower saturation; start the grid at a lower input or raise the tolerance";
  }
  return "";
}

namespace detail {

template <typename Scalar, std::size_t MaxLevels>
constexpr auto check_shape(const ReversalTable<Scalar, MaxLevels>& table) -> TableCheck {
  using Traits = ScalarTraits<Scalar>;
  if (table.levels < 2 || table.levels > MaxLevels) {
    return {TableFault::kLevelCount, table.levels, 0};
  }
  for (std::size_t row = 0; row < table.levels; ++row) {
    if (Traits::is_missing(table.inputs[row]) || (row > 0 && !(table.inputs[row - 1] < table.inputs[row]))) {
      return {TableFault::kInputsNotIncreasing, row, 0};
    }
    for (std::size_t column = 0; column <= row; ++column) {
      if (Traits::is_missing(table.force(row, column))) {
        return {TableFault::kMissingForce, row, column};
      }
    }
  }
  const std::size_t last = table.levels - 1;
  if (Traits::is_saturated(table.force(last, last) - table.force(0, 0))) {
    return {TableFault::kSpanTooWide, last, last};
  }
  return {};
}

}  // namespace detail

/// Refuses a table that is not complete, or along which the force falls by more than the tolerance (the noise of its
/// measurement, in units of force) where a sum of relays with positive weights would rise or stay.
/// Rows and columns only: the weight of a single cell is a second difference, which noise makes negative in any
/// measured table. Where it is, rising branches inside a loop may fall by as much.
template <typename Scalar, std::size_t MaxLevels>
constexpr auto check(const ReversalTable<Scalar, MaxLevels>& table, Scalar tolerance = Scalar{}) -> TableCheck {
  if (const TableCheck shape = detail::check_shape(table); !shape.ok()) {
    return shape;
  }
  for (std::size_t row = 1; row < table.levels; ++row) {
    if (tolerance < abs(table.force(row, 0) - table.force(0, 0))) {
      return {TableFault::kSaturationDiffers, row, 0};
    }
    for (std::size_t column = 1; column <= row; ++column) {
      if (table.force(row, column) + tolerance < table.force(row, column - 1)) {
        return {TableFault::kFallsAlongRow, row, column};
      }
      if (column < row && table.force(row, column) + tolerance < table.force(row - 1, column)) {
        return {TableFault::kFallsAlongColumn, row, column};
      }
    }
  }
  return {};
}

/// The same table in another number format. Missing values stay missing. Host, or constant evaluation on target.
template <typename Scalar, std::size_t MaxLevels>
constexpr auto convert_table(const ReversalTable<double, MaxLevels>& from) -> ReversalTable<Scalar, MaxLevels> {
  auto convert = [](double value) {
    return ScalarTraits<double>::is_missing(value) ? ScalarTraits<Scalar>::missing()
                                                   : ScalarTraits<Scalar>::from(value);
  };
  ReversalTable<Scalar, MaxLevels> to;
  to.levels = from.levels;
  for (std::size_t i = 0; i < from.inputs.size(); ++i) {
    to.inputs[i] = convert(from.inputs[i]);
  }
  for (std::size_t i = 0; i < from.forces.size(); ++i) {
    to.forces[i] = convert(from.forces[i]);
  }
  return to;
}

}  // namespace capstan
