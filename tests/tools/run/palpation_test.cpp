// SPDX-License-Identifier: Apache-2.0
// What the tip touches, against the simulated instrument's environment.
#include "capstan/tools/identify/palpation.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>

#include "capstan/tests/tools/run/by_hand.hpp"
#include "capstan/tests/tools/run/recipe_log.hpp"
#include "capstan/tools/support/errors.hpp"

namespace capstan::tools {
namespace {

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
    ForceLog log = turn_by_hand(plant, 40.0, triangle(0.5, 0.05));
    log.tau_out_nm.setZero();  // nobody at the joint tells
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

TEST(Palpation, MapOfTheRecipeShowsTheInclusionUnderTheFifthSiteAndNowhereElse) {
  const auto parameters = tension_state_of(fit_pull_push({record("recipe_pull_push.toml")}));
  const ForceLog log = record("recipe_palpation.toml");
  std::vector<SiteSpan> spans;
  for (int i = 0; i < 9; ++i) {
    spans.push_back({5.0 * i, 5.0 * (i + 1)});
  }
  const auto sites = palpate(log, parameters, spans);
  for (std::size_t i = 0; i < sites.size(); ++i) {
    ASSERT_TRUE(sites[i].combined.has_value()) << "site " << i;
    std::printf("site %zu: %.4f +- %.4f N m/rad\n", i + 1, sites[i].combined->value, sites[i].combined->half_interval);
  }
  EXPECT_EQ(stiff_sites(sites), std::vector<std::size_t>{4}) << "hit, and no false alarm";
  // The scenario: 0.06 N m/rad in the deep layer, 0.08 more over the inclusion, exp(-(5/4)^2) of that beside it.
  const double beside = 0.06 + 0.08 * std::exp(-25.0 / 16.0);
  const std::array<double, 9> truth = {0.06, 0.06, 0.06, beside, 0.14, beside, 0.06, 0.06, 0.06};
  int inside = 0;
  for (std::size_t i = 0; i < sites.size(); ++i) {
    EXPECT_NEAR(sites[i].combined->value, truth[i], 0.06 * truth[i]) << "site " << i + 1;
    inside += std::abs(sites[i].combined->value - truth[i]) < sites[i].combined->half_interval ? 1 : 0;
  }
  EXPECT_GE(inside, 8) << "of nine intervals of 95 %; the tissue's resistance to speed put five of them wrong";
}

TEST(Palpation, FreeTipFeelsNextToNothingAndASpanWithoutSamplesNothing) {
  sim::PlantParameters plant;
  const ForceLog log = turn_by_hand(plant, 20.0, triangle(0.3, 0.1));
  const auto sites = palpate(log, tension_state_of(locked()), {{5.0, 20.0}, {30.0, 40.0}});
  EXPECT_LT(sites[0].combined.value_or(Stiffness{}).value, 0.005);
  EXPECT_FALSE(sites[1].combined.has_value()) << "no sample lies in that span";
}

TEST(Palpation, ParametersOutOfRangeAndMissingStiffnessAreRefused) {
  ForceLog log;
  EXPECT_THROW(static_cast<void>(palpate(log, TensionStateParameters<double>{}, {})), BadInput);
  EXPECT_THROW(static_cast<void>(tension_state_of(PullPushFit{})), Refusal);
}

}  // namespace
}  // namespace capstan::tools
