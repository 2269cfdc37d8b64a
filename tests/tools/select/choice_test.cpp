// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/select/choice.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "capstan/tests/tools/select/small_selection.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

using test::normals;
using test::play_of;
using test::two_sines;

constexpr Eigen::Index kRows = 800;
constexpr double kNoise = 0.01;

/// As few candidates as show the way.
auto few_candidates() -> DecidingNumbers {
  DecidingNumbers numbers = test::few_parts();
  numbers.parts = 8;
  numbers.first_judged_part = 4;
  numbers.pieces_per_part = 5;
  numbers.run = 2;
  numbers.play_widths = 5;
  numbers.narrowest_play = 0.05;
  numbers.shape_values = 2;
  numbers.coupled_play_widths = 2;
  numbers.table_knots = 5;
  numbers.fine_table_knots = 5;
  numbers.growth.most_steps = 2;
  return numbers;
}

auto joint_with(const std::vector<std::string>& terms) -> JointFile {
  JointFile joint;
  joint.terms = terms;
  if (joint.has("angle_periodic")) {
    joint.parameters.shapes[joint.catalogue->term("angle_periodic").first_shape] = 8.0;
  }
  return joint;
}

const std::vector<std::string> kBase = {"motor_angle", "joint_offset"};
const std::vector<std::string> kRippled = {"motor_angle", "joint_offset", "angle_periodic"};

/// q2 = 0.8 q1 + `ripple` sin(8 q1) + `play` (play(q1, 0.4) - q1) + noise; half of the blocks to learn from.
struct Log {
  Log(double ripple, double play, double noise = kNoise) {
    const Eigen::VectorXd q1 = two_sines(kRows);
    const Eigen::VectorXd target = 0.8 * q1 + (ripple * (8.0 * q1.array()).sin()).matrix() +
                                   play * (play_of(q1, 0.4) - q1) + noise * normals(kRows, 1, 5);
    p = test::preparation_of(test::samples_of(q1), target,
                             test::split_of(20, kRows / 20, {Role::kFit, Role::kChoose, Role::kReport}), 0.05);
  }
  [[nodiscard]] auto chosen(const std::optional<JointFile>& found, Lacking lacking = Lacking::kNothing,
                            const DecidingNumbers& numbers = few_candidates()) const -> LawChoice {
    return choose_law(p, joint_with(kBase), found, lacking, numbers);
  }
  Preparation p = test::preparation_of(1, {});
};

TEST(ChooseLaw, TheBaseLawWhereItIsTheTruth) {
  const LawChoice choice = Log(0.0, 0.0).chosen(std::nullopt);
  EXPECT_EQ(choice.status, LawStatus::kBase);
  EXPECT_FALSE(choice.is_named);
  EXPECT_EQ(choice.law.terms, kBase);
  EXPECT_EQ(choice.learned.terms, kBase);
  EXPECT_NEAR(choice.unseen_rms, kNoise, 0.1 * kNoise);
  EXPECT_EQ(choice.halves_agree, 2);
}

TEST(ChooseLaw, TheFoundLawWhereItCostsNextToNothing) {
  const LawChoice choice = Log(0.05, 0.0).chosen(joint_with(kRippled));
  EXPECT_EQ(choice.status, LawStatus::kConfirmed);
  EXPECT_TRUE(choice.is_named);
  EXPECT_EQ(choice.law.terms, kRippled);
  EXPECT_EQ(choice.law.status, LawStatus::kConfirmed);
  EXPECT_NEAR(choice.unseen_rms, kNoise, 0.1 * kNoise);
}

TEST(ChooseLaw, AGrownLawWhereNothingWasFoundAndItErrsLess) {
  const LawChoice choice = Log(0.0, 0.3).chosen(std::nullopt);
  EXPECT_EQ(choice.status, LawStatus::kProvisional);
  EXPECT_FALSE(choice.is_named);
  EXPECT_TRUE(choice.law.has("hysteresis"));
  EXPECT_EQ(choice.learned.status, LawStatus::kProvisional);
  EXPECT_LT(choice.unseen_rms, 0.5 * std::sqrt(choice.selection.laws[0].score));
}

TEST(ChooseLaw, AFoundLawThatErrsMuchMoreThanAGrownOneIsNotNamed) {
  const LawChoice choice = Log(0.0, 0.3).chosen(joint_with(kRippled));
  EXPECT_EQ(choice.status, LawStatus::kProvisional);
  EXPECT_FALSE(choice.is_named);
}

TEST(ChooseLaw, ASmallLawIsOneStepAwayFromTheBaseLaw) {
  const Log both(0.2, 0.3);
  const LawChoice grown = both.chosen(std::nullopt);
  EXPECT_TRUE(grown.law.has("hysteresis") && grown.law.has("angle_periodic")) << joined(grown.law.terms);
  const LawChoice small = choose_small_law(both.p, joint_with(kBase));
  EXPECT_EQ(small.status, LawStatus::kProvisional);
  EXPECT_EQ(small.law.terms.size(), kBase.size() + 1) << joined(small.law.terms);
  EXPECT_EQ(choose_small_law(Log(0.0, 0.0).p, joint_with(kBase)).status, LawStatus::kBase);
}

// Columns of a weight predict the log as well as its law would with the right numbers; with others it does not.
TEST(ChooseLaw, AFoundLawWithAWeightCountsAsWhatItLeavesWhenItRuns) {
  Log log(0.0, 0.0);
  const Eigen::ArrayXd rigid = 0.8 * two_sines(kRows).array();
  Eigen::ArrayXd q2 = rigid;
  for (int round = 0; round < 50; ++round) {
    q2 = rigid + 0.01 * q2.sin() + 0.05 * q2.cos();
  }
  log.p.target += (q2 - rigid).matrix();
  JointFile found = joint_with({"motor_angle", "joint_offset", "gravity"});
  const std::size_t beta = found.catalogue->term("motor_angle").first_coefficient;
  const std::size_t weight = found.catalogue->term("gravity").first_coefficient;
  found.parameters.coefficients[beta] = 0.8;
  found.parameters.coefficients[weight] = 0.01;
  found.parameters.coefficients[weight + 1] = 0.05;
  EXPECT_TRUE(log.chosen(found).is_named);
  found.parameters.coefficients[weight + 1] = 0.5;
  EXPECT_FALSE(log.chosen(found).is_named);
}

TEST(ChooseLaw, WhereTheBaseLawLacksSomethingAndNothingIsBetterItStays) {
  const LawChoice choice = Log(0.0, 0.0).chosen(std::nullopt, Lacking::kSomething);
  EXPECT_EQ(choice.status, LawStatus::kBase);
  EXPECT_EQ(choice.law.terms, kBase);
}

/// Whether laws were compared that only the wider vocabulary has: other tables than over the motor's angle alone.
auto compared_wider(const Selection& selection) -> bool {
  return std::any_of(selection.laws.begin(), selection.laws.end(), [](const JudgedLaw& judged) {
    const TermChoice* table = judged.law.find("table");
    return table != nullptr && (table->by_direction || table->shapes[0] != 0.0 || table->shapes[4] != 0.0);
  });
}

TEST(ChooseLaw, ALawOfTheWiderVocabularyHasToErrLessByMoreThanAStandardError) {
  // A play, and a slope that differs by direction, which the wider vocabulary alone has.
  Log log(0.0, 0.3, 0.03);
  const Samples& samples = log.p.causal.samples()[0];
  for (Eigen::Index i = 0; i < kRows; ++i) {
    const auto& sample = samples[static_cast<std::size_t>(i)];
    log.p.target[i] += (sample.forward ? 0.05 : -0.05) * sample.q1;
  }
  const LawChoice certain = log.chosen(std::nullopt);
  EXPECT_EQ(certain.status, LawStatus::kProvisional);
  EXPECT_TRUE(compared_wider(certain.selection));
  // One run of pieces has no spread: nothing is certain, and the choice before stands.
  DecidingNumbers numbers = few_candidates();
  numbers.pieces_per_part = 1;
  numbers.run = numbers.parts - numbers.first_judged_part;
  const LawChoice uncertain = log.chosen(std::nullopt, Lacking::kNothing, numbers);
  EXPECT_EQ(uncertain.status, LawStatus::kProvisional);
  EXPECT_FALSE(compared_wider(uncertain.selection));
}

TEST(ChooseLaw, WhereTheBaseLawLacksSomethingTheWiderVocabularyIsAsked) {
  // A slope that differs by direction, small beside the noise: only tables by direction have it.
  Log log(0.0, 0.0, 0.03);
  const Samples& samples = log.p.causal.samples()[0];
  for (Eigen::Index i = 0; i < kRows; ++i) {
    const auto& sample = samples[static_cast<std::size_t>(i)];
    log.p.target[i] += (sample.forward ? 0.05 : -0.05) * sample.q1;
  }
  const LawChoice asked = log.chosen(std::nullopt, Lacking::kSomething);
  EXPECT_EQ(asked.status, LawStatus::kProvisional) << described(asked.selection.laws[asked.selection.best].law);
  EXPECT_LT(asked.unseen_rms, 0.95 * std::sqrt(asked.selection.laws[0].score));
}

}  // namespace
}  // namespace capstan::tools
