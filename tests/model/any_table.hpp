// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <rapidcheck.h>

#include "capstan/model/preisach.hpp"
#include "capstan/tests/model/support.hpp"

namespace capstan::test {

// Random tables: uneven levels, relay weights of zero and more, so the properties do not hang on one instrument.
template <typename Scalar>
auto any_table() -> ReversalTable<Scalar, 9> {
  ReversalTable<double, 9> table;
  table.levels = *rc::gen::inRange<std::uint32_t>(2, 10);
  double input = -0.25 * *rc::gen::inRange(1, 20);
  double lower = -0.125 * *rc::gen::inRange(-20, 40);
  for (std::size_t row = 0; row < table.levels; ++row) {
    table.inputs[row] = input;
    input += 0.0625 * *rc::gen::inRange(1, 16);
    // The weights of this row's cells, summed along the row onto the row before: exact in both formats.
    double force = lower;
    double added = 0.0;
    for (std::size_t column = 0; column <= row; ++column) {
      added += column > 0 ? 0.03125 * *rc::gen::inRange(0, 32) : 0.0;
      force = (column < row ? table.force(row - 1, column) : (row > 0 ? table.force(row - 1, row - 1) : lower)) + added;
      table.set_force(row, column, force);
    }
  }
  return convert_table<Scalar>(table);
}

/// An input anywhere in the table, ends included.
template <typename Scalar>
auto any_input(const ReversalTable<Scalar, 9>& table, double low = 0.0, double high = 1.0) -> Scalar {
  const double first = value_of(table.inputs[0]);
  const double range = value_of(table.inputs[table.levels - 1]) - first;
  return number<Scalar>(first + range * (low + (high - low) * 0.001 * *rc::gen::inRange(0, 1001)));
}

template <typename Scalar>
void play_history(auto& preisach, const ReversalTable<Scalar, 9>& table, double low = 0.0, double high = 1.0) {
  const int count = *rc::gen::inRange(0, 30);
  for (int i = 0; i < count; ++i) {
    preisach.update(any_input(table, low, high));
  }
}

}  // namespace capstan::test
