// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/select/angle_laws.hpp"

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
constexpr double kNoise = 0.01;

auto vocabulary() -> Vocabulary {
  Vocabulary words;
  words.start = test::ratio_law();
  words.starts = {words.start};
  words.plays = {0.1, 0.2, 0.3, 0.4};
  return words;
}

auto grown(SmallSelection& small, const Vocabulary& words) -> ScoredLaw<LawCandidate> {
  return grown_angle_laws(small.forward, words).back();
}

/// q2 = 0.6 q1 + `weight` play(q1, 0.3) + noise.
auto with_one_play(double weight) -> Eigen::VectorXd {
  const Eigen::VectorXd q1 = two_sines(kRows);
  return 0.6 * q1 + weight * play_of(q1, 0.3) + kNoise * normals(kRows, 1, 1);
}

TEST(GrownAngleLaws, BeginWithTheStartAndEndWithTheTruth) {
  SmallSelection small(two_sines(kRows), with_one_play(0.2));
  const auto path = grown_angle_laws(small.forward, vocabulary());
  EXPECT_EQ(path.front().law, vocabulary().start);
  EXPECT_EQ(path.back().law.plays, std::vector<double>{0.3});
  EXPECT_NEAR(std::sqrt(path.back().score), kNoise, 0.1 * kNoise);
  for (std::size_t i = 1; i < path.size(); ++i) {
    EXPECT_LT(path[i].score, 0.97 * path[i - 1].score);
  }
}

TEST(GrownAngleLaws, StayWithTheStartWhereItIsTheTruth) {
  SmallSelection small(two_sines(kRows), with_one_play(0.0));
  EXPECT_EQ(grown_angle_laws(small.forward, vocabulary()).size(), 1u);
}

TEST(GrownAngleLaws, LeaveOutWhatAStartHasTooMuch) {
  SmallSelection small(two_sines(kRows), with_one_play(0.0));
  Vocabulary words = vocabulary();
  words.starts = {law_of({{"motor_angle", {}}, {"joint_offset", {}}, {"curved_ratio", {0.0, 1.4}}}, {0.2})};
  EXPECT_EQ(grown(small, words).law, words.start);
}

TEST(GrownAngleLaws, MoveAPlayOfAStartToANeighbour) {
  SmallSelection small(two_sines(kRows), with_one_play(0.2));
  Vocabulary words = vocabulary();
  words.starts = {law_of({{"motor_angle", {}}, {"joint_offset", {}}}, {0.2})};
  EXPECT_EQ(grown(small, words).law.plays, std::vector<double>{0.3});
  words.starts = {law_of({{"motor_angle", {}}, {"joint_offset", {}}}, {0.25})};  // on no grid: it stays or goes
  const auto plays = grown(small, words).law.plays;
  EXPECT_TRUE(plays == std::vector<double>{0.25} || plays == std::vector<double>{0.3} || plays.size() == 2u);
}

TEST(GrownAngleLaws, ThePlaysAtTheEndsOfTheGridHaveOneNeighbour) {
  const Eigen::VectorXd q1 = two_sines(kRows);
  for (const double width : {0.1, 0.4}) {
    SmallSelection small(q1, 0.6 * q1 + 0.2 * play_of(q1, width) + kNoise * normals(kRows, 1, 7));
    Vocabulary words = vocabulary();
    words.starts = {law_of({{"motor_angle", {}}, {"joint_offset", {}}}, {width})};
    EXPECT_EQ(grown(small, words).law.plays, std::vector<double>{width});
  }
}

TEST(GrownAngleLaws, HaveNoMorePlaysThanTheInputStage) {
  const Eigen::VectorXd q1 = two_sines(kRows);
  DecidingNumbers numbers = test::few_parts();
  numbers.most_plays = 1;
  numbers.growth.worth_a_step = 1.0;
  SmallSelection small(q1, 0.4 * q1 + 0.2 * play_of(q1, 0.1) + 0.2 * play_of(q1, 0.4), numbers);
  EXPECT_EQ(grown(small, vocabulary()).law.plays.size(), 1u);
}

TEST(GrownAngleLaws, TakeOneSettingOfATermAndMoveIt) {
  // A ripple of order 5, of which the grid has 3, 4, 5 and 6.
  const Eigen::VectorXd q1 = two_sines(kRows);
  SmallSelection small(q1, 0.6 * q1 + (0.05 * (5.0 * q1.array()).sin()).matrix() + kNoise * normals(kRows, 1, 2));
  Vocabulary words = vocabulary();
  words.plays.clear();
  words.terms = {{"angle_periodic", {{3.0}, {4.0}, {5.0}, {6.0}}}};
  const auto law = grown(small, words).law;
  ASSERT_TRUE(law.has("angle_periodic"));
  EXPECT_EQ(law.find("angle_periodic")->shapes, Shapes{5.0});
  words.starts = {with_term(term_catalogue(), words.start, {"angle_periodic", {4.0}})};
  EXPECT_EQ(grown(small, words).law.find("angle_periodic")->shapes, Shapes{5.0});
}

TEST(GrownAngleLaws, ATermThatBuildsOnAnotherComesBehindItAndKeepsIt) {
  // Compliance that hardens: without elongation there is nothing to harden.
  const Eigen::VectorXd q1 = two_sines(kRows);
  Samples samples = test::samples_of(q1);
  Eigen::VectorXd y = 0.8 * q1;
  for (Eigen::Index i = 0; i < kRows; ++i) {
    const double tau = std::sin(0.37 * static_cast<double>(i));
    samples[static_cast<std::size_t>(i)].tau = tau;
    y[i] += -0.2 * tau + 0.1 * tau * std::abs(tau);
  }
  y += kNoise * normals(kRows, 1, 3);
  SmallSelection small(samples, y);
  Vocabulary words = vocabulary();
  words.plays.clear();
  const CatalogueTerm& hardening = term_catalogue().term("stiffness_hardening");
  ASSERT_EQ(hardening.builds_on, std::vector<std::string>{"tendon_elongation"});
  words.terms = {{"stiffness_hardening", {hardening.initial_shapes()}}};
  EXPECT_FALSE(grown(small, words).law.has("stiffness_hardening"));
  words.terms.push_back({"tendon_elongation", {term_catalogue().term("tendon_elongation").initial_shapes()}});
  const LawCandidate law = grown(small, words).law;
  EXPECT_TRUE(law.has("tendon_elongation"));
  EXPECT_TRUE(law.has("stiffness_hardening"));
  // Though it alone would explain all there is.
  for (Eigen::Index i = 0; i < kRows; ++i) {
    const double tau = samples[static_cast<std::size_t>(i)].tau;
    y[i] = 0.8 * q1[i] + 0.1 * tau * std::abs(tau);
  }
  SmallSelection alone(samples, y);
  words.terms.pop_back();
  EXPECT_FALSE(grown(alone, words).law.has("stiffness_hardening"));
}

TEST(GrownAngleLaws, ATermThatSeesWhatIsBehindThePlaysStandsWithoutThem) {
  std::string reads;
  for (const auto& term : term_catalogue()) {
    if (term.reads_input && !term.placed && term.name != "motor_angle" && term.builds_on.empty() && reads.empty()) {
      reads = term.name;
    }
  }
  ASSERT_FALSE(reads.empty());
  SmallSelection small(two_sines(kRows), with_one_play(0.2));
  Vocabulary words = vocabulary();
  words.starts = {with_term(term_catalogue(), words.start, {reads, term_catalogue().term(reads).initial_shapes()})};
  for (const auto& step : grown_angle_laws(small.forward, words)) {
    EXPECT_TRUE(step.law.plays.empty() || !step.law.has(reads)) << described(step.law);
  }
  words.starts = {with_play(words.start, 0.3)};
  words.terms = {{reads, {term_catalogue().term(reads).initial_shapes()}}};
  for (const auto& step : grown_angle_laws(small.forward, words)) {
    EXPECT_TRUE(step.law.plays.empty() || !step.law.has(reads)) << described(step.law);
  }
}

TEST(GrownAngleLaws, ATableByDirectionMovesAmongTheSettingsOfItsOwnKind) {
  // The offset differs by direction: a table of both directions together has no such value.
  const Eigen::VectorXd q1 = two_sines(kRows);
  const Samples samples = test::samples_of(q1);
  Eigen::VectorXd y = 0.6 * q1 + kNoise * normals(kRows, 1, 4);
  for (Eigen::Index i = 0; i < kRows; ++i) {
    y[i] += (samples[static_cast<std::size_t>(i)].forward ? 0.1 : -0.1) * std::abs(q1[i]);
  }
  SmallSelection small(samples, y);
  Vocabulary words = vocabulary();
  words.plays.clear();
  const auto over = [](double knots) { return Shapes{0.0, knots, -1.4, 1.4, 0.0}; };
  words.terms = {{"table", {over(5.0), over(9.0)}, false}, {"table", {over(5.0), over(9.0)}, true}};
  const LawCandidate law = grown(small, words).law;
  ASSERT_TRUE(law.has("table"));
  EXPECT_TRUE(law.find("table")->by_direction);
}

}  // namespace
}  // namespace capstan::tools
