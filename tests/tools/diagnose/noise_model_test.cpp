// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/diagnose/noise_model.hpp"

#include <gtest/gtest.h>

#include <random>

namespace capstan::tools {
namespace {

auto series(double a1, double a2, Eigen::Index rows, std::uint64_t seed) -> Eigen::VectorXd {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal(0.0, 2.0);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(rows);
  for (Eigen::Index i = 2; i < rows; ++i) {
    x[i] = a1 * x[i - 1] + a2 * x[i - 2] + normal(random);
  }
  return x;
}

TEST(NoiseModel, RecoversASecondOrderProcessAndItsInnovations) {
  const Eigen::VectorXd x = series(1.2, -0.5, 20000, 1);
  const AutoregressiveNoise noise = fit_noise(x, {{0, 20000}}, 8);
  ASSERT_GE(noise.order(), 2);
  EXPECT_NEAR(noise.coefficients[0], 1.2, 0.03);
  EXPECT_NEAR(noise.coefficients[1], -0.5, 0.03);
  EXPECT_NEAR(noise.innovation_variance, 4.0, 0.15);
}

TEST(NoiseModel, WhiteNoiseHasNoOrder) {
  const AutoregressiveNoise noise = fit_noise(series(0.0, 0.0, 5000, 2), {{0, 5000}}, 8);
  EXPECT_EQ(noise.order(), 0);
}

TEST(NoiseModel, PiecesDoNotSeeEachOther) {
  Eigen::VectorXd x = series(0.9, 0.0, 6000, 3);
  x.tail(3000).array() += 1000.0;
  x.tail(3000).array() -= x.tail(3000).mean();
  const AutoregressiveNoise apart = fit_noise(x, {{0, 3000}, {3000, 6000}}, 8);
  EXPECT_NEAR(apart.coefficients[0], 0.9, 0.03);
}

TEST(NoiseModel, ShortPiecesAreAskedForALowerOrderAndStillTellHowLargeTheNoiseIs) {
  const Eigen::VectorXd x = series(0.7, 0.0, 300, 5);
  Blocks pieces;
  for (Eigen::Index begin = 0; begin < 300; begin += 30) {
    pieces.push_back({begin, begin + 30});
  }
  const AutoregressiveNoise noise = fit_noise(x, pieces, 8);
  ASSERT_GE(noise.order(), 1);
  EXPECT_LE(noise.order(), 7);
  EXPECT_NEAR(noise.coefficients[0], 0.7, 0.15);
  EXPECT_NEAR(noise.innovation_variance, 4.0, 1.0);
  for (auto& piece : pieces) {
    piece.end = piece.begin + 3;  // too short for any
  }
  EXPECT_EQ(fit_noise(x, pieces, 8).order(), 0);
  EXPECT_NEAR(fit_noise(x, pieces, 8).innovation_variance, 4.0 / (1.0 - 0.49), 3.5);
}

TEST(NoiseModel, WhitenedNoiseHasNoCorrelationLeft) {
  const Eigen::VectorXd x = series(0.8, 0.1, 20000, 4);
  const Blocks all = {{0, 20000}};
  const Eigen::VectorXd u = whitened(x, all, fit_noise(x, all, 8));
  const double power = u.squaredNorm();
  for (Eigen::Index lag = 1; lag < 6; ++lag) {
    EXPECT_LT(std::abs(u.head(20000 - lag).dot(u.tail(20000 - lag))) / power, 0.025);
  }
}

}  // namespace
}  // namespace capstan::tools
