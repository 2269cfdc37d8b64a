// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <random>

#include "capstan/model/coupled_axes.hpp"
#include "capstan/tests/model/support.hpp"

namespace capstan::test {

/// Any matrices with a B that is far from singular.
template <typename Scalar>
auto any_matrices(std::mt19937& engine) -> CouplingMatrices<Scalar, 3> {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  CouplingMatrices<Scalar, 3> m;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      m.rigid[i][j] = number<Scalar>((i == j ? 1.4 : 0.0) + 0.5 * unit(engine));
      m.elongation_top[i][j] = number<Scalar>(5.5 * unit(engine));
      m.elongation_bottom[i][j] = number<Scalar>(5.5 * unit(engine));
    }
    m.offset[i] = number<Scalar>(unit(engine));
  }
  return m;
}

}  // namespace capstan::test
