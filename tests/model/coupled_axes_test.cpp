// SPDX-License-Identifier: Apache-2.0
#include "capstan/model/coupled_axes.hpp"

#include <gtest/gtest.h>

#include "capstan/tests/model/support.hpp"

namespace capstan {
namespace {

using test::number;

/// Table 6.1 and the identified coefficients of chapter 6.
template <typename Scalar>
auto thesis_wrist() -> WristTransmission<Scalar> {
  const auto n = [](double x) { return number<Scalar>(x); };
  return {n(0.996),
          n(1.109),
          n(1.138),
          n(0.674),
          n(0.664),
          {n(-0.424), n(-2.828)},
          {n(-1.907), n(-1.054)},
          {n(-1.047), n(-0.541)}};
}

TEST(WristCoupling, IsEquations614To616) {
  const auto m = coupling_of(thesis_wrist<double>());
  EXPECT_EQ(m.rigid[0], (std::array{0.996, 0.0, 0.0}));
  EXPECT_EQ(m.rigid[1], (std::array{0.674 * 0.996, 1.109, 0.0}));
  EXPECT_EQ(m.rigid[2], (std::array{0.664 * 0.996, 0.0, 1.138}));
  EXPECT_EQ(m.elongation_top[1], (std::array{0.674 * -0.424, -1.907, 0.0}));
  EXPECT_EQ(m.elongation_bottom[2], (std::array{0.664 * -2.828, 0.0, -0.541}));
}

}  // namespace
}  // namespace capstan
