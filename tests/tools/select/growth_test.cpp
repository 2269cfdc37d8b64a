// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/select/growth.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

namespace capstan::tools {
namespace {

/// Laws by their numbers, each with a score and a list of laws that it leads to.
class Listed final : public LawFamily<int> {
 public:
  auto score(const int& law) -> double override {
    ++asked;
    const auto found = scores.find(law);
    return found == scores.end() ? std::numeric_limits<double>::infinity() : found->second;
  }
  [[nodiscard]] auto additions(const int& law) const -> std::vector<int> override { return of(more, law); }
  [[nodiscard]] auto reductions(const int& law) const -> std::vector<int> override { return of(less, law); }
  [[nodiscard]] auto variations(const int& law) const -> std::vector<int> override { return of(other, law); }

  std::map<int, double> scores;
  std::map<int, std::vector<int>> more, less, other;
  int asked = 0;

 private:
  static auto of(const std::map<int, std::vector<int>>& lists, int law) -> std::vector<int> {
    const auto found = lists.find(law);
    return found == lists.end() ? std::vector<int>{} : found->second;
  }
};

auto grown(Listed& family, GrowthRules rules = {}) -> std::vector<int> {
  std::vector<int> laws;
  for (const auto& step : Grower<int>(family, rules).run(0)) {
    laws.push_back(step.law);
  }
  return laws;
}

TEST(Grower, TakesTheBestStepAsLongAsOneIsWorthIt) {
  Listed family;
  family.scores = {{0, 1.0}, {1, 0.9}, {2, 0.5}, {3, 0.486}, {4, 0.484}};
  family.more = {{0, {1, 2}}, {2, {3}}, {3, {4}}};
  EXPECT_EQ(grown(family), (std::vector<int>{0, 2}));  // 0.486 is 0.972 of 0.5, and 0.97 is asked for
  family.scores[3] = 0.484;
  EXPECT_EQ(grown(family), (std::vector<int>{0, 2, 3}));
}

TEST(Grower, TakesNoLawThatIsNone) {
  Listed family;
  family.scores = {{0, 1.0}};
  family.more = {{0, {1, 2}}};  // without a score
  EXPECT_EQ(grown(family), std::vector<int>{0});
  family.scores.clear();
  EXPECT_EQ(grown(family), std::vector<int>{0});
}

TEST(Grower, EndsAfterSoManySteps) {
  Listed family;
  for (int law = 0; law < 20; ++law) {
    family.scores[law] = std::pow(0.5, law);
    family.more[law] = {law + 1};
  }
  EXPECT_EQ(grown(family).size(), 9u);
  EXPECT_EQ(grown(family, {.most_steps = 2}).size(), 3u);
}

TEST(Grower, DropsWhatIsSuperfluousAtTheStartAndAfterAStep) {
  Listed family;
  family.scores = {{0, 1.0}, {1, 1.004}, {2, 0.5}, {3, 0.502}};
  family.less = {{0, {1}}, {2, {3}}};
  family.more = {{1, {2}}};
  EXPECT_EQ(grown(family), (std::vector<int>{1, 3}));
  family.scores[3] = 0.503;  // errs by more than a factor of 1.005
  EXPECT_EQ(grown(family), (std::vector<int>{1, 2}));
}

TEST(Grower, MovesToANeighbourThatServesBetter) {
  Listed family;
  family.scores = {{0, 1.0}, {1, 0.997}, {2, 0.9955}};
  family.other = {{0, {1}}, {1, {2, 0}}};
  EXPECT_EQ(grown(family), std::vector<int>{1});  // the next one is not worth a move
  family.scores[2] = 0.9;
  EXPECT_EQ(grown(family), std::vector<int>{2});
}

TEST(Grower, DoesNotGoRoundForEver) {
  // Each law may be reduced to the other at no cost.
  Listed family;
  family.scores = {{0, 1.0}, {1, 1.0}};
  family.less = {{0, {1}}, {1, {0}}};
  EXPECT_EQ(grown(family).size(), 1u);
  EXPECT_LT(family.asked, 100);
}

}  // namespace
}  // namespace capstan::tools
