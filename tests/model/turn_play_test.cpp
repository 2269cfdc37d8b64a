// SPDX-License-Identifier: Apache-2.0
#include "capstan/model/turn_play.hpp"

#include <gtest/gtest.h>

#include "capstan/model/fixed.hpp"

namespace capstan {
namespace {

template <typename Scalar>
class TurnPlayOf : public testing::Test {};
using Scalars = testing::Types<double, Q24>;
TYPED_TEST_SUITE(TurnPlayOf, Scalars);

TYPED_TEST(TurnPlayOf, IsNearAReversalForAsLongAsItsTurn) {
  TurnPlay<TypeParam> play;
  const auto at = [&play](double x) {
    return play.update(ScalarTraits<TypeParam>::from(x), ScalarTraits<TypeParam>::from(0.2));
  };
  EXPECT_TRUE(at(0.0)) << "nobody knows where it came from";
  EXPECT_FALSE(at(0.5));
  EXPECT_FALSE(at(0.495)) << "noise";
  EXPECT_FALSE(at(0.6));
  EXPECT_TRUE(at(0.55));
  EXPECT_TRUE(at(0.41));
  EXPECT_FALSE(at(0.39));
  EXPECT_FALSE(at(-0.5));
  EXPECT_TRUE(at(-0.4));
  play.restart();
  EXPECT_TRUE(at(0.0));
}

}  // namespace
}  // namespace capstan
