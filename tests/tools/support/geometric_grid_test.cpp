// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/support/geometric_grid.hpp"

#include <gtest/gtest.h>

namespace capstan::tools {
namespace {

TEST(GeometricGrid, GoesFromEndToEndInEqualRatios) {
  const std::vector<double> grid = geometric_grid(0.5, 8.0, 5);
  const double expected[] = {0.5, 1.0, 2.0, 4.0, 8.0};
  ASSERT_EQ(grid.size(), 5u);
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_NEAR(grid[i], expected[i], 1e-12);
  }
}

}  // namespace
}  // namespace capstan::tools
