// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/diagnose/compare.hpp"

#include <gtest/gtest.h>

#include "capstan/tools/identify/term_catalogue.hpp"

namespace capstan::tools {
namespace {

/// A law of a ratio, an offset and a gap: four parameters. The ratio is known to 0.001.
auto joint_of_ratio(double beta) -> JointFile {
  JointFile joint;
  joint.terms = {"motor_angle", "joint_offset", "play"};
  const auto known = [&joint](std::size_t at, double value, double half) {
    joint.parameters.coefficients[at] = value;
    joint.coefficient_ci95[at] = Interval{value - half, value + half};
  };
  known(catalogue_term("motor_angle").first_coefficient, beta, 0.001);
  known(catalogue_term("joint_offset").first_coefficient, 0.01, 0.001);
  known(catalogue_term("play").first_coefficient, 0.9, 0.001);
  const std::size_t width = catalogue_term("play").first_shape;
  joint.parameters.shapes[width] = 0.03;
  joint.shape_ci95[width] = Interval{0.029, 0.031};
  return joint;
}

TEST(MovedBetween, IsWhatChanceMovesInOneOfAThousandHealthyPairsAlone) {
  // A difference has 0.001414 for its interval; 0.001 / (2 * 4) in either tail is 3.66 standard deviations (tables of
  // the normal), so 0.001414 * 3.66 / 1.96 = 0.002643. Intervals that do not meet begin at 0.002.
  const JointFile healthy = joint_of_ratio(0.9);
  EXPECT_TRUE(moved_between(healthy, joint_of_ratio(0.9)).empty());
  EXPECT_TRUE(moved_between(healthy, joint_of_ratio(0.9026)).empty());
  const auto moved = moved_between(healthy, joint_of_ratio(0.9027));
  ASSERT_EQ(moved.size(), 1U);
  EXPECT_EQ(moved[0].name, "motor_angle.beta");
  EXPECT_EQ(moved[0].now, 0.9027);
}

TEST(MovedBetween, NamesWhatMovedMostFirst) {
  JointFile now = joint_of_ratio(0.91);
  const std::size_t width = catalogue_term("play").first_shape;
  now.parameters.shapes[width] = 0.05;
  now.shape_ci95[width] = Interval{0.049, 0.051};
  const auto moved = moved_between(joint_of_ratio(0.9), now);
  ASSERT_EQ(moved.size(), 2U);
  EXPECT_EQ(moved[0].name, "play.half_width");
  EXPECT_EQ(moved[1].name, "motor_angle.beta");
}

TEST(MovedBetween, AsksNothingOfWhatIsNotKnownAtBothTimes) {
  JointFile now = joint_of_ratio(0.95);
  now.coefficient_ci95[catalogue_term("motor_angle").first_coefficient].reset();
  EXPECT_TRUE(moved_between(joint_of_ratio(0.9), now).empty());
}

TEST(MovedSentence, ShowsFiguresThatDiffer) {
  EXPECT_EQ(moved_sentence({"play.half_width", "rad", 0.02, 0.03, {0.0199, 0.0201}, {0.0299, 0.0301}}),
            "play.half_width moved from 0.02 [0.0199, 0.0201] to 0.03 [0.0299, 0.0301] rad");
  EXPECT_EQ(moved_sentence({"motor_angle.beta", "1", 0.899969, 0.900012, {0.899952, 0.899986}, {0.899998, 0.900027}}),
            "motor_angle.beta moved from 0.89997 [0.89995, 0.89999] to 0.90001 [0.9, 0.90003] 1");
  EXPECT_EQ(moved_sentence({"play.gain", "1", 0.5, 0.7, {0.4, 0.6}, {0.6, 0.8}}),
            "play.gain moved from 0.5 [0.4, 0.6] to 0.7 [0.6, 0.8] 1");
}

}  // namespace
}  // namespace capstan::tools
