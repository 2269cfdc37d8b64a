// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <type_traits>

#include "capstan/model/cell_scale.hpp"
#include "capstan/model/reversal_table.hpp"

namespace capstan {

/// A place between the levels of a grid: the cell, and how far into it, 0 to 1. Ordered like the inputs it stands for.
template <typename Scalar>
struct GridPosition {
  std::size_t cell = 0;
  typename ScalarTraits<Scalar>::Gain fraction{};
  constexpr auto operator==(const GridPosition&) const -> bool = default;
  friend constexpr auto operator<(const GridPosition& a, const GridPosition& b) -> bool {
    if constexpr (std::is_same_v<Scalar, Q24>) {
      return a.as_one_number() < b.as_one_number();
    } else {
      return a.cell != b.cell ? a.cell < b.cell : a.fraction < b.fraction;
    }
  }

 private:
  /// Compared in two instructions.
  [[nodiscard]] constexpr auto as_one_number() const -> std::uint64_t {
    return (std::uint64_t{cell} << 32U) | static_cast<std::uint32_t>(fraction.raw());
  }
};

/// The reversal values between the grid's points: bilinear in square cells (4.9), linear in the triangles on a = b
/// (4.10). Keeps a reference to the table, which must outlive it.
template <typename Scalar, std::size_t MaxLevels>
class ReversalSurface {
 public:
  using Table = ReversalTable<Scalar, MaxLevels>;
  using Position = GridPosition<Scalar>;

  /// A surface of no table, to be assigned one before anything is asked of it.
  constexpr ReversalSurface() = default;
  /// @pre check(table) passes with some tolerance
  constexpr explicit ReversalSurface(const Table& table)
      : table_(&table), half_(std::bit_floor(std::size_t{table.levels - 1})) {
    for (std::size_t cell = 0; cell + 1 < table.levels; ++cell) {
      scales_[cell] = CellScale<Scalar>(table.inputs[cell], table.inputs[cell + 1]);
    }
  }
  explicit ReversalSurface(const Table&& table) = delete;

  [[nodiscard]] constexpr auto lowest() const -> Position { return {}; }
  [[nodiscard]] constexpr auto highest() const -> Position {
    constexpr auto kWhole = Traits::fraction(1.0);
    return {table_->levels - 2, kWhole};
  }
  [[nodiscard]] constexpr auto levels() const -> std::size_t { return table_->levels; }
  [[nodiscard]] constexpr auto lower_saturation() const -> Scalar { return table_->force(0, 0); }

  /// Where an input lies. Inputs beyond the grid, and NaN, are taken to its nearest end and `beyond` is set.
  [[nodiscard]] constexpr auto locate(Scalar input, bool& beyond) const -> Position {
    const std::size_t last = table_->levels - 1;
    if (!(table_->inputs[0] <= input)) {
      beyond = true;
      return lowest();
    }
    if (!(input < table_->inputs[last])) {
      beyond = table_->inputs[last] < input;
      return highest();
    }
    beyond = false;
    // The cells are the last power of two or fewer behind one place, or that many from the first on; halving then needs
    // no other bound. At most ten rounds.
    const Scalar* const first = table_->inputs.data();
    const Scalar* low = input < first[last - half_] ? first : first + (last - half_);
    for (std::size_t step = half_ / 2; step > 0; step /= 2) {
      if (!(input < low[step])) {
        low += step;
      }
    }
    const auto cell = static_cast<std::size_t>(low - first);
    return {cell, scales_[cell].fraction(input, *low)};
  }

  /// The input that lies there.
  [[nodiscard]] constexpr auto input_at(const Position& x) const -> Scalar {
    return Traits::between(table_->inputs[x.cell], table_->inputs[x.cell + 1], x.fraction);
  }

  /// f_ab. @pre b <= a
  [[nodiscard]] constexpr auto at(const Position& a, const Position& b) const -> Scalar {
    const Scalar* const near = &table_->forces[Table::index(a.cell, b.cell)];
    const Scalar* const far = near + a.cell + 1;  // the same place in the next row
    if (a.cell == b.cell) {
      return near[0] + Traits::part(far[0] - near[0], a.fraction) + Traits::part(far[1] - far[0], b.fraction);
    }
    return Traits::between(Traits::between(near[0], near[1], b.fraction), Traits::between(far[0], far[1], b.fraction),
                           a.fraction);
  }
  /// f_uu.
  [[nodiscard, gnu::always_inline]] constexpr auto on_diagonal(const Position& u) const -> Scalar {
    const Scalar* const near = &table_->forces[Table::index(u.cell, u.cell)];
    return Traits::between(near[0], near[u.cell + 2], u.fraction);
  }

 private:
  using Traits = ScalarTraits<Scalar>;

  const Table* table_ = nullptr;
  std::size_t half_ = 0;  ///< the largest power of two that is not above the number of cells
  std::array<CellScale<Scalar>, MaxLevels - 1> scales_{};
};

}  // namespace capstan
