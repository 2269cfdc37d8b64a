// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/support/statistics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace capstan::tools {
namespace {

TEST(Statistics, StudentsQuantilesAreThoseOfTheTables) {
  EXPECT_NEAR(student_t95(1), 12.706, 0.001);  // an interval of a quarter less held the truth 93 times of 100
  EXPECT_NEAR(student_t95(1.5), 6.0167, 0.003);
  EXPECT_NEAR(student_t95(2), 4.303, 0.001);
  EXPECT_NEAR(student_t95(3), 3.182, 0.001);
  EXPECT_NEAR(student_t95(4), 2.776, 0.008);
  EXPECT_NEAR(student_t95(5), 2.571, 0.01);
  EXPECT_NEAR(student_t95(10), 2.228, 0.003);
  EXPECT_NEAR(student_t95(30), 2.042, 0.002);
  EXPECT_NEAR(student_t95(1e6), 1.960, 0.001);
}

TEST(Statistics, NormalTailAndItsInverseAgree) {
  EXPECT_NEAR(normal_tail(1.644854), 0.05, 1e-6);
  EXPECT_NEAR(normal_quantile_upper(0.01), 2.326348, 1e-5);
}

TEST(Statistics, GoodnessOfFitIsThatOfTheThesis) {
  // |q - q^| = 1, |q^ - mean| = sqrt(2): 100 (1 - 1 / sqrt(2)).
  EXPECT_NEAR(goodness_of_fit_percent(Eigen::Vector3d(0.0, 1.0, 3.0), Eigen::Vector3d(0.0, 1.0, 2.0)),
              100.0 * (1.0 - std::sqrt(0.5)), 1e-9);
  EXPECT_EQ(goodness_of_fit_percent(Eigen::Vector3d(1, 2, 3), Eigen::Vector3d(1, 2, 3)), 100.0);
}

TEST(Statistics, WhiteNoiseIsMeasuredUnderASmoothMotion) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal(0.0, 0.003);
  Eigen::VectorXd signal(20000);
  for (Eigen::Index i = 0; i < signal.size(); ++i) {
    signal[i] = 2.0 * std::sin(0.01 * static_cast<double>(i)) + normal(random);
  }
  EXPECT_NEAR(white_noise_level(signal), 0.003, 0.0001);
  EXPECT_NEAR(fast_noise_level(signal), 0.003, 0.0001);
}

TEST(Statistics, TheEncodersStepIsFoundAndASmoothSignalHasNone) {
  Eigen::VectorXd smooth(5000);
  Eigen::VectorXd stepped(5000);
  const double step = 6.2831853 / 8192.0;
  for (Eigen::Index i = 0; i < smooth.size(); ++i) {
    smooth[i] = std::sin(0.003 * static_cast<double>(i));
    stepped[i] = std::floor(smooth[i] / step) * step;
  }
  EXPECT_NEAR(quantisation_step(stepped), step, 1e-3 * step);
  const Eigen::VectorXd printed = (stepped.array() * 1e5).round() / 1e5;  // five decimals, a hundredth of a step
  EXPECT_NEAR(quantisation_step(printed), step, 1e-3 * step);
  EXPECT_EQ(quantisation_step(smooth), 0.0);
}

}  // namespace
}  // namespace capstan::tools
