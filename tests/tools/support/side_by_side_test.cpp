// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/support/side_by_side.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

namespace capstan::tools {
namespace {

TEST(TwoAtATime, DoesEachPieceOnce) {
  for (const std::size_t count : {0, 1, 2, 7, 1000}) {
    std::vector<int> done(count);
    two_at_a_time(count, [&](std::size_t i) { ++done[i]; });
    EXPECT_EQ(done, std::vector<int>(count, 1)) << count;
  }
}

TEST(TwoAtATime, HandsOnWhatAPieceThrows) {
  for (const std::size_t bad : {0, 1, 2}) {
    const auto work = [bad](std::size_t i) {
      if (i == bad) {
        throw std::runtime_error("bad");
      }
    };
    EXPECT_THROW(two_at_a_time(3, work), std::runtime_error) << bad;
  }
}

}  // namespace
}  // namespace capstan::tools
