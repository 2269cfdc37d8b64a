// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>

#include "model/reversal_table.hpp"

namespace capstan {

/// A place between the levels of a grid: the cell, and how far into it, 0 to 1. Ordered like the inputs it stands for.
template <typename Scalar>
struct GridPosition {
  std::size_t cell = 0;
  Scalar fraction{};
  constexpr auto operator==(const GridPosition&) const -> bool = default;
  friend constexpr auto operator<(const GridPosition& a, const GridPosition& b) -> bool {
    return a.cell != b.cell ? a.cell < b.cell : a.fraction < b.fraction;
  }
};

/// One over the width of a cell, so that the loop divides nothing.
template <typename Scalar>
class CellScale;

template <>
class CellScale<double> {
 public:
  constexpr CellScale() = default;
  constexpr CellScale(double low, double high) : inverse_(1.0 / (high - low)) {}
  /// @pre low <= x <= high
  [[nodiscard]] constexpr auto fraction(double x, double low) const -> double {
    const double fraction = (x - low) * inverse_;
    return fraction < 1.0 ? fraction : 1.0;
  }

 private:
  double inverse_ = 0.0;
};

/// A 32-bit multiplier and a shift: the fraction is right to one unit in its last place whatever the width.
template <>
class CellScale<Q24> {
 public:
  constexpr CellScale() = default;
  constexpr CellScale(Q24 low, Q24 high) {
    const auto width = static_cast<std::uint64_t>(static_cast<std::int64_t>(high.raw()) - low.raw());
    const int bits = 64 - std::countl_zero(width);  // 2^(bits - 1) <= width < 2^bits, bits <= 32
    const std::uint64_t multiplier = ((std::uint64_t{1} << (kPrecision + bits)) + width / 2) / width;
    multiplier_ = narrow_saturating<std::uint64_t, std::uint32_t>(multiplier);
    shift_ = kPrecision + bits - Q24::kFrac;
  }
  /// @pre low <= x <= high
  [[nodiscard]] constexpr auto fraction(Q24 x, Q24 low) const -> Q24 {
    const auto distance = static_cast<std::uint32_t>(static_cast<std::int64_t>(x.raw()) - low.raw());
    const std::uint64_t product =
        static_cast<std::uint64_t>(distance) * multiplier_ + (std::uint64_t{1} << (shift_ - 1));
    const auto fraction = static_cast<std::int64_t>(product >> shift_);
    return Q24::from_raw(static_cast<std::int32_t>(fraction < kOne ? fraction : kOne));
  }

 private:
  static constexpr int kPrecision = 30;
  static constexpr std::int64_t kOne = std::int64_t{1} << Q24::kFrac;
  std::uint32_t multiplier_ = 0;
  int shift_ = 1;
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
  constexpr explicit ReversalSurface(const Table& table) : table_(&table) {
    for (std::size_t cell = 0; cell + 1 < table.levels; ++cell) {
      scales_[cell] = CellScale<Scalar>(table.inputs[cell], table.inputs[cell + 1]);
    }
  }
  explicit ReversalSurface(const Table&& table) = delete;

  [[nodiscard]] constexpr auto lowest() const -> Position { return {}; }
  [[nodiscard]] constexpr auto highest() const -> Position {
    constexpr Scalar kOne = ScalarTraits<Scalar>::from(1.0);
    return {table_->levels - 2, kOne};
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
    std::size_t low = 0;
    std::size_t high = last;
    while (high - low > 1) {  // halves a range below MaxLevels: at most ten rounds
      const std::size_t middle = (low + high) / 2;
      (input < table_->inputs[middle] ? high : low) = middle;
    }
    return {low, scales_[low].fraction(input, table_->inputs[low])};
  }

  /// The input that lies there.
  [[nodiscard]] constexpr auto input_at(const Position& x) const -> Scalar {
    const Scalar low = table_->inputs[x.cell];
    return low + (table_->inputs[x.cell + 1] - low) * x.fraction;
  }

  /// f_ab. @pre b <= a
  [[nodiscard]] constexpr auto at(const Position& a, const Position& b) const -> Scalar {
    if (a.cell == b.cell) {
      const Scalar corner = force(a.cell + 1, a.cell);
      const Scalar low = force(a.cell, a.cell);
      return low + (corner - low) * a.fraction + (force(a.cell + 1, a.cell + 1) - corner) * b.fraction;
    }
    const Scalar near = along_row(a.cell, b);
    if (a.fraction == Scalar{}) {
      return near;
    }
    return near + (along_row(a.cell + 1, b) - near) * a.fraction;
  }

 private:
  [[nodiscard]] constexpr auto force(std::size_t row, std::size_t column) const -> Scalar {
    return table_->force(row, column);
  }
  [[nodiscard]] constexpr auto along_row(std::size_t row, const Position& b) const -> Scalar {
    const Scalar low = force(row, b.cell);
    return low + (force(row, b.cell + 1) - low) * b.fraction;
  }

  const Table* table_ = nullptr;
  std::array<CellScale<Scalar>, MaxLevels - 1> scales_{};
};

}  // namespace capstan
