// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/select/selection.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "capstan/tests/tools/select/small_selection.hpp"

namespace capstan::tools {
namespace {

using test::law_of;
using test::normals;
using test::play_of;
using test::SmallSelection;
using test::two_sines;

constexpr Eigen::Index kRows = 400;
const LawCandidate kRatio = test::ratio_law();

auto words() -> Vocabulary {
  Vocabulary words;
  words.start = kRatio;
  words.starts = {kRatio};
  words.plays = {0.2, 0.3};
  return words;
}

auto sheath() -> Eigen::VectorXd {
  const Eigen::VectorXd q1 = two_sines(kRows);
  return 0.6 * q1 + 0.2 * play_of(q1, 0.3) + 0.01 * normals(kRows, 1, 1);
}

TEST(SelectLaw, GivenLawsStandFirstAndNoneStandsTwice) {
  SmallSelection small(two_sines(kRows), sheath());
  const Selection selection = select_law(small.forward, {kRatio, with_play(kRatio, 0.2)}, words());
  ASSERT_GE(selection.laws.size(), 3u);
  EXPECT_EQ(selection.laws[0].law, kRatio);
  EXPECT_EQ(selection.laws[1].law, with_play(kRatio, 0.2));
  for (std::size_t i = 0; i < selection.laws.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      EXPECT_FALSE(selection.laws[i].law == selection.laws[k].law);
    }
  }
  EXPECT_EQ(selection.laws[selection.best].law, with_play(kRatio, 0.3));
}

TEST(SelectLaw, TheBestLawIsInTheSetAndTheRatioAloneIsNot) {
  SmallSelection small(two_sines(kRows), sheath());
  const Selection selection = select_law(small.forward, {kRatio}, words());
  EXPECT_TRUE(selection.laws[selection.best].in_set);
  EXPECT_EQ(selection.laws[selection.best].p_value, 1.0);
  EXPECT_FALSE(selection.laws[0].in_set);
  const Eigen::VectorXd losses = small.forward.losses(kRatio);
  EXPECT_NEAR(selection.laws[0].halves[0], losses.head(2).mean(), 1e-12);
  EXPECT_NEAR(selection.laws[0].halves[1], losses.tail(2).mean(), 1e-12);
}

TEST(SelectLaw, ALawThatIsNoneKeepsItsPlaceAndIsNotJudged) {
  // The play's weight against the ratio is beyond any input stage.
  const Eigen::VectorXd q1 = two_sines(kRows);
  SmallSelection small(q1, play_of(q1, 0.3) - 0.99 * q1 + 0.01 * normals(kRows, 1, 2));
  Vocabulary none = words();
  none.plays.clear();
  const Selection selection = select_law(small.forward, {with_play(kRatio, 0.3), kRatio}, none);
  ASSERT_EQ(selection.laws.size(), 2u);
  EXPECT_FALSE(std::isfinite(selection.laws[0].score));
  EXPECT_FALSE(selection.laws[0].in_set);
  EXPECT_EQ(selection.best, 1u);
  EXPECT_TRUE(selection.laws[1].in_set);
}

TEST(SelectLaw, AGrownLawThatIsNoneIsLeftOut) {
  // A curve of 300 rad is in no joint file.
  const Eigen::VectorXd q1 = two_sines(kRows);
  SmallSelection small(q1, q1 + 300.0 * (q1.cwiseAbs2().array() - q1.cwiseAbs2().mean()).matrix());
  small.forward.limit_as(law_of({{"joint_offset", {}}}));
  Vocabulary from_it = words();
  from_it.plays.clear();
  from_it.start = law_of({{"motor_angle", {}}, {"curved_ratio", {0.0, 1.0}}});
  from_it.starts = {from_it.start};
  const LawCandidate offset = law_of({{"joint_offset", {}}});
  const Selection selection = select_law(small.forward, {offset}, from_it);
  ASSERT_EQ(selection.laws.size(), 1u);
  EXPECT_EQ(selection.laws[0].law, offset);
}

TEST(SelectLaw, WhereNoLawIsOneNothingIsJudged) {
  SmallSelection small(two_sines(kRows), sheath());
  ForwardScore nowhere(small.data, {});
  const Selection selection = select_law(nowhere, {kRatio}, words());
  ASSERT_EQ(selection.laws.size(), 1u);
  EXPECT_FALSE(selection.laws[0].in_set);
}

TEST(JointOf, HasTheTermsOfTheLawAndItsPlaysAsTheInputStage) {
  const Eigen::VectorXd q1 = two_sines(kRows);
  SmallSelection small(q1, 0.1 + (0.6 * q1 + 0.2 * play_of(q1, 0.3)).array());
  ConditionerShape<double> conditioner;
  conditioner.rate_time_constant_s = 0.123;
  const JointFile joint = joint_of(small.data, small.data.logs(), with_play(kRatio, 0.3), conditioner);
  EXPECT_TRUE(joint.has("motor_angle"));
  EXPECT_TRUE(joint.has("joint_offset"));
  EXPECT_TRUE(joint.has("hysteresis"));
  EXPECT_FALSE(joint.has("play"));
  EXPECT_EQ(joint.parameters.conditioner.rate_time_constant_s, 0.123);
  const std::size_t stage = joint.catalogue->term("hysteresis").first_shape;
  EXPECT_EQ(joint.parameters.shapes[stage], 0.3);
  EXPECT_NEAR(joint.parameters.shapes[stage + 1], 0.25, 0.01);  // 0.2 of 0.8
  EXPECT_NEAR(joint.parameters.coefficients[joint.catalogue->term("motor_angle").first_coefficient], 0.8, 0.01);
  const JointFile bare = joint_of(small.data, small.data.logs(), kRatio, conditioner);
  EXPECT_FALSE(bare.has("hysteresis"));
}

}  // namespace
}  // namespace capstan::tools
