// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/select/law_candidate.hpp"

#include <gtest/gtest.h>

namespace capstan::tools {
namespace {

auto names(const LawCandidate& law) -> std::vector<std::string> {
  std::vector<std::string> result;
  for (const auto& choice : law.terms) {
    result.push_back(choice.term);
  }
  return result;
}

TEST(LawCandidate, TermsStandInTheOrderOfTheCatalogueHoweverTheyCame) {
  const Catalogue& catalogue = term_catalogue();
  LawCandidate law;
  for (const auto& term : std::vector<std::string>{"transport_delay", "presliding", "joint_offset", "motor_angle"}) {
    law = with_term(catalogue, law, {term, {}});
  }
  std::vector<std::string> expected;
  for (const auto& term : catalogue) {
    if (law.has(term.name)) {
      expected.push_back(term.name);
    }
  }
  EXPECT_EQ(expected.size(), 4u);
  EXPECT_EQ(names(law), expected);
}

TEST(LawCandidate, ATermStandsInItOnce) {
  const Catalogue& catalogue = term_catalogue();
  LawCandidate law = with_term(catalogue, {}, {"presliding", {0.1}});
  law = with_term(catalogue, law, {"presliding", {0.2}});
  ASSERT_EQ(law.terms.size(), 1u);
  EXPECT_EQ(law.find("presliding")->shapes, Shapes{0.2});
  EXPECT_TRUE(without_term(law, "presliding").terms.empty());
  EXPECT_EQ(without_term(law, "gravity"), law);
}

TEST(LawCandidate, PlaysStandByTheirWidth) {
  LawCandidate law;
  for (const double width : {0.3, 0.1, 0.2}) {
    law = with_play(law, width);
  }
  EXPECT_EQ(law.plays, (std::vector<double>{0.1, 0.2, 0.3}));
  EXPECT_EQ(without_play(law, 1).plays, (std::vector<double>{0.1, 0.3}));
}

TEST(LawCandidate, ItsOutputIsTheTermThatActsOnTheSum) {
  const Catalogue& catalogue = term_catalogue();
  LawCandidate law = with_term(catalogue, {}, {"motor_angle", {}});
  EXPECT_EQ(law.output(catalogue), nullptr);
  law = with_term(catalogue, law, {"transport_delay", {0.02}});
  ASSERT_NE(law.output(catalogue), nullptr);
  EXPECT_EQ(law.output(catalogue)->term, "transport_delay");
  EXPECT_EQ(law.find("gravity"), nullptr);
}

TEST(LawCandidate, LawsThatDifferHaveKeysThatDiffer) {
  const TermChoice table{"table", {0.0, 9.0}};
  TermChoice by_direction = table;
  by_direction.by_direction = true;
  EXPECT_NE(key_of(table), key_of(by_direction));
  EXPECT_NE(key_of(TermChoice{"presliding", {0.1}}), key_of(TermChoice{"presliding", {0.1 + 1e-9}}));
  LawCandidate law = with_term(term_catalogue(), {}, {"motor_angle", {}});
  EXPECT_NE(key_of(law), key_of(with_play(law, 0.1)));
  EXPECT_NE(key_of(with_play(law, 0.1)), key_of(with_play(law, 0.2)));
  EXPECT_EQ(key_of(law), key_of(with_term(term_catalogue(), law, {"motor_angle", {}})));
}

TEST(LawCandidate, InShortWords) {
  LawCandidate law = with_term(term_catalogue(), {}, {"motor_angle", {}});
  EXPECT_EQ(described(law), "motor_angle");
  law = with_play(law, 0.1);
  EXPECT_EQ(described(law), "motor_angle + 1 play");
  EXPECT_EQ(described(with_play(law, 0.2)), "motor_angle + 2 plays");
}

TEST(LawCandidate, OfAFormHasThePlaysOfItsInputStageThatHaveAWeight) {
  LawForm form;
  form.terms = {"hysteresis", "motor_angle", "table"};
  const CatalogueTerm& stage = form.catalogue->term("hysteresis");
  Shapes shapes(stage.shapes.size(), 0.0);
  shapes[0] = 0.3;
  shapes[1] = 0.5;
  shapes[2] = 0.2;  // without a weight
  shapes[4] = 0.1;
  shapes[5] = -0.2;
  form.set_shapes(stage, shapes);
  const LawCandidate law = candidate_of(form);
  EXPECT_EQ(law.plays, (std::vector<double>{0.1, 0.3}));
  EXPECT_EQ(names(law), (std::vector<std::string>{"motor_angle", "table"}));
  EXPECT_TRUE(law.find("table")->by_direction);
  EXPECT_FALSE(law.find("motor_angle")->by_direction);
}

}  // namespace
}  // namespace capstan::tools
