// SPDX-License-Identifier: Apache-2.0
// What the tip touches, against the simulated instrument's environment.
#include "capstan/tools/identify/palpation.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "capstan/tests/tools/run/by_hand.hpp"
#include "capstan/tests/tools/run/recipe_log.hpp"
#include "capstan/tools/identify/palpation_log.hpp"
#include "capstan/tools/support/errors.hpp"

namespace capstan::tools {
namespace {

using test::log_of;
using test::record;
using test::triangle;
using test::turn_by_hand;

auto locked() -> PullPushFit {
  sim::PlantParameters plant;
  plant.environment.kind = sim::EnvironmentKind::kLocked;
  return fit_pull_push({turn_by_hand(plant, 60.0, triangle(0.25, 0.05))});
}

TEST(Palpation, AbsoluteStiffnessOfASpringComesBackFromTheMotorAlone) {
  const auto parameters = tension_state_of(locked());
  for (const double stiffness : {0.02, 0.05, 0.2, 0.5}) {
    sim::PlantParameters plant;
    plant.environment = {.kind = sim::EnvironmentKind::kSpring, .stiffness = stiffness};
    plant.pretension_n = 27.6984;
    AxisLog log = turn_by_hand(plant, 40.0, triangle(0.5, 0.05));
    log.effort.setZero();  // nobody at the joint tells
    const auto sites = palpate(log, parameters, {{0.0, 40.0}});
    ASSERT_EQ(sites.size(), 1U);
    ASSERT_TRUE(sites[0].combined.has_value()) << stiffness;
    for (const auto& [name, phase] : {std::pair{"III", sites[0].both_active}, std::pair{"IV", sites[0].one_slack}}) {
      if (phase) {
        std::printf("K_env %.3f N m/rad, phase %s: %.4f +- %.4f\n", stiffness, name, phase->value,
                    phase->half_interval);
      }
    }
    EXPECT_NEAR(sites[0].combined->value, stiffness, 0.05 * stiffness);
    EXPECT_LT(sites[0].combined->half_interval, 0.1 * stiffness);
  }
}

// The scenario: 0.06 N m/rad in the deep layer, 0.08 more over the inclusion, exp(-(5/4)^2) of that beside it.
const double kBeside = 0.06 + 0.08 * std::exp(-25.0 / 16.0);
const std::array<double, 9> kRecipeStiffness = {0.06, 0.06, 0.06, kBeside, 0.14, kBeside, 0.06, 0.06, 0.06};
constexpr double kRecipePeriodS = 10.0;

TEST(Palpation, MapOfTheRecipeShowsTheInclusionUnderTheFifthSiteAndNowhereElse) {
  const auto parameters = tension_state_of(fit_pull_push({record("recipe_pull_push.toml")}));
  const AxisLog log = record("recipe_palpation.toml");
  std::vector<SiteSpan> spans;
  for (int i = 0; i < 9; ++i) {
    spans.push_back({kRecipePeriodS * i, kRecipePeriodS * (i + 1)});
  }
  const auto sites = palpate(log, parameters, spans);
  for (std::size_t i = 0; i < sites.size(); ++i) {
    ASSERT_TRUE(sites[i].combined.has_value()) << "site " << i;
    std::printf("site %zu: %.4f +- %.4f N m/rad\n", i + 1, sites[i].combined->value, sites[i].combined->half_interval);
  }
  EXPECT_EQ(stiff_sites(sites, 1.5), std::vector<std::size_t>{4}) << "hit, and no false alarm";
  // What the inclusion adds beside itself is 28 % of the rest, and found too.
  EXPECT_EQ(stiff_sites(sites), (std::vector<std::size_t>{3, 4, 5}));
  const std::array<double, 9>& truth = kRecipeStiffness;
  int inside = 0;
  for (std::size_t i = 0; i < sites.size(); ++i) {
    EXPECT_NEAR(sites[i].combined->value, truth[i], 0.06 * truth[i]) << "site " << i + 1;
    inside += std::abs(sites[i].combined->value - truth[i]) < sites[i].combined->half_interval ? 1 : 0;
  }
  EXPECT_GE(inside, 8) << "of nine intervals of 95 %; the tissue's resistance to speed put five of them wrong";
}

// The whole way of the command line, firmware's servo and all: a tissue that resists speed, a law and a map from logs
// of their own, and intervals that have to hold over other noise.
TEST(Palpation, IntervalsOfTheRecipeHoldOverSeedsThatNothingWasChosenOn) {
  constexpr std::uint64_t kFirstSeed = 880000;
  const std::uint64_t maps = std::getenv("CAPSTAN_TISSUES") == nullptr ? 4 : 20;
  const auto parameters =
      tension_state_of(fit_pull_push({read_force_log(log_of("recipe_pull_push.toml", kFirstSeed - 1), 0)}));
  int asked = 0;
  int inside = 0;
  double error = 0.0;
  for (std::uint64_t seed = kFirstSeed; seed < kFirstSeed + maps; ++seed) {
    const CsvLog log = log_of("recipe_palpation.toml", seed);
    const auto rows = map_sites(sites_of(log, kRecipePeriodS), {read_palpation_log(log, 0), parameters});
    ASSERT_EQ(rows.size(), kRecipeStiffness.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const auto& felt = rows[i].stiffness.combined;
      ASSERT_TRUE(felt.has_value()) << "seed " << seed << ", site " << i + 1;
      ++asked;
      inside += std::abs(felt->value - kRecipeStiffness[i]) < felt->half_interval ? 1 : 0;
      error += felt->value / kRecipeStiffness[i] - 1.0;
    }
  }
  std::printf("recipe, seeds %llu on: %d of %d inside, mean error %+.2f %%\n",
              static_cast<unsigned long long>(kFirstSeed), inside, asked, 100.0 * error / asked);
  EXPECT_GE(inside, asked * 90 / 100) << "at 0.4 Hz 84 % held it, half of the strokes out being too short to use";
  EXPECT_LT(std::abs(error / asked), 0.007);
}

TEST(Palpation, FreeTipFeelsNextToNothingAndASpanWithoutSamplesNothing) {
  sim::PlantParameters plant;
  const AxisLog log = turn_by_hand(plant, 20.0, triangle(0.3, 0.1));
  const auto sites = palpate(log, tension_state_of(locked()), {{5.0, 20.0}, {30.0, 40.0}});
  EXPECT_LT(sites[0].combined.value_or(Stiffness{}).value, 0.005);
  EXPECT_FALSE(sites[1].combined.has_value()) << "no sample lies in that span";
}

TEST(Palpation, ParametersOutOfRangeAndMissingStiffnessAreRefused) {
  AxisLog log;
  EXPECT_THROW(static_cast<void>(palpate(log, TensionStateParameters<double>{}, {})), BadInput);
  EXPECT_THROW(static_cast<void>(tension_state_of(PullPushFit{})), Refusal);
}

}  // namespace
}  // namespace capstan::tools
