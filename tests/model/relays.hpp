// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <vector>

#include "capstan/model/reversal_table.hpp"

namespace capstan::test {

/// The definition of the Preisach model and nothing else: every relay of the triangle stored and asked, (4.1).
/// Thresholds lie in the middle of the cells of a regular n x n grid over [-5, 5], so an input that is a multiple of
/// 10/n meets none of them.
class Relays {
 public:
  static constexpr double kLow = -5.0;
  static constexpr double kHigh = 5.0;

  explicit Relays(int n) : n_(n), weights_(cells()), states_(cells(), -1.0) {
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j <= i; ++j) {
        const double area = step() * step() * (i == j ? 0.5 : 1.0);
        weights_[index(i, j)] = area * density(threshold(i), threshold(j));
      }
    }
  }

  [[nodiscard]] auto step() const -> double { return (kHigh - kLow) / n_; }
  void saturate_low() { states_.assign(states_.size(), -1.0); }

  auto update(double u) -> double {
    double sum = kOffset;
    for (int i = 0; i < n_; ++i) {
      const bool above = u > threshold(i);
      for (int j = 0; j <= i; ++j) {
        double& state = states_[index(i, j)];
        state = above ? 1.0 : (u < threshold(j) ? -1.0 : state);
        sum += weights_[index(i, j)] * state;
      }
    }
    return sum;
  }

  /// First-order reversal values on a regular grid of `levels`, counted relay by relay: a rise to a and a fall to b
  /// leave up what has its upper threshold under a and its lower one under b.
  template <std::size_t MaxLevels>
  [[nodiscard]] auto table(std::size_t levels) const -> ReversalTable<double, MaxLevels> {
    // A copy: as a local variable of its own the compiler would write each of a large table's values one by one, and
    // take half a minute for it.
    static ReversalTable<double, MaxLevels> unset;
    ReversalTable<double, MaxLevels> table = unset;
    table.levels = static_cast<std::uint32_t>(levels);
    const int per_cell = n_ / static_cast<int>(levels - 1);
    std::vector<double> up_by_column(static_cast<std::size_t>(n_) + 1, 0.0);  // weight up if b is at that line
    double all = 0.0;
    for (const double weight : weights_) {
      all += weight;
    }
    int rows_done = 0;
    for (std::size_t row = 0; row < levels; ++row) {
      table.inputs[row] = kLow + static_cast<double>(row) * per_cell * step();
      for (; rows_done < static_cast<int>(row) * per_cell; ++rows_done) {
        double up = 0.0;
        for (int j = 0; j < n_; ++j) {
          up += j <= rows_done ? weights_[index(rows_done, j)] : 0.0;
          up_by_column[static_cast<std::size_t>(j) + 1] += up;
        }
      }
      for (std::size_t column = 0; column <= row; ++column) {
        table.set_force(row, column, kOffset - all + 2.0 * up_by_column[column * static_cast<std::size_t>(per_cell)]);
      }
    }
    return table;
  }

 private:
  static constexpr double kOffset = 1.25;  // makes the saturations asymmetric
  /// Smooth, positive, not symmetric: a ridge along a - b = 1.5 like the width of an instrument's loop, stronger at
  /// positive input.
  static auto density(double alpha, double beta) -> double {
    const double width = alpha - beta - 1.5;
    const double middle = 0.5 * (alpha + beta) - 0.8;
    return 0.16 * std::exp(-0.18 * width * width - 0.05 * middle * middle) + 0.01;
  }
  [[nodiscard]] auto cells() const -> std::size_t { return index(n_, 0); }
  [[nodiscard]] static auto index(int i, int j) -> std::size_t {
    const auto row = static_cast<std::size_t>(i);
    return row * (row + 1) / 2 + static_cast<std::size_t>(j);
  }
  [[nodiscard]] auto threshold(int i) const -> double { return kLow + (i + 0.5) * step(); }

  int n_;
  std::vector<double> weights_;
  std::vector<double> states_;
};

}  // namespace capstan::test
