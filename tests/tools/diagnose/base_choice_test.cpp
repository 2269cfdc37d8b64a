// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/diagnose/base_choice.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "capstan/tests/tools/diagnose/small_evidence.hpp"
#include "capstan/tools/identify/tendon_fit.hpp"

namespace capstan::tools {
namespace {

using test::normals;
using test::preparation_of;
using test::split_of;

auto found(const std::vector<std::string>& names) -> Search {
  Search search;
  for (const auto& name : names) {
    search.effects.emplace_back();
    search.effects.back().name = name;
  }
  return search;
}

TEST(MayBeTendons, WhereAnEffectIsOneThatTendonsPassForOrStandFor) {
  EXPECT_FALSE(may_be_tendons(found({})));
  EXPECT_FALSE(may_be_tendons(found({"thermal_drift", "angle_periodic"})));
  const CatalogueTerm& tendon = catalogue_term(kTendonModel);
  ASSERT_FALSE(tendon.doubles.empty() && tendon.special_cases.empty());
  for (const auto* names : {&tendon.doubles, &tendon.special_cases}) {
    for (const auto& name : *names) {
      EXPECT_TRUE(may_be_tendons(found({"thermal_drift", name}))) << name;
    }
  }
}

/// 600 samples of q2 = q1 + 0.5 + `ripple` sin(8 q1) and noise of 0.01.
struct Joint {
  explicit Joint(double ripple_rad) {
    Samples samples(600);
    Eigen::VectorXd target = 0.01 * normals(600, 1, 3);
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const double q = std::sin(0.03 * static_cast<double>(i)) + 0.4 * std::sin(0.11 * static_cast<double>(i));
      samples[i].q1 = samples[i].h = q;
      target[static_cast<Eigen::Index>(i)] += q + 0.5 + ripple_rad * std::sin(8.0 * q);
    }
    p = preparation_of(samples, target, split_of(12, 50, {Role::kFit, Role::kChoose, Role::kReport}));
    p.logs.front().has_torque = true;
  }
  Preparation p = preparation_of(1, {});
};

auto law_of(const std::vector<std::string>& terms) -> LawForm {
  LawForm law;
  law.terms = terms;
  if (law.has("angle_periodic")) {
    law.set_shapes(law.catalogue->term("angle_periodic"), {8.0});
  }
  return law;
}

TEST(SettledBase, ALawWithoutTendonsStaysAsItIs) {
  Preparation p = preparation_of(1, {});
  const LawForm law = settled_base(p, law_of({"motor_angle", "joint_offset"}));
  EXPECT_EQ(law.terms, (std::vector<std::string>{"motor_angle", "joint_offset"}));
  EXPECT_TRUE(law.held.empty());
}

TEST(SettledBase, TendonsWhoseNumbersAreKnownKeepThem) {
  LawForm known = law_of({"motor_angle", "joint_offset", kTendonModel});
  known.shapes[known.catalogue->term(kTendonModel).first_shape] = 0.77;
  Preparation p = preparation_of(1, {});
  const LawForm law = settled_base(p, known);
  EXPECT_EQ(law.shapes, known.shapes);
  EXPECT_EQ(law.held, std::vector<std::string>{kTendonModel});
}

TEST(BetterBase, WithoutTorqueThereIsNone) {
  Joint joint(0.0);
  joint.p.logs.front().has_torque = false;
  EXPECT_FALSE(better_base(joint.p, law_of({"motor_angle", "joint_offset"}), found({})));
}

TEST(BetterBase, ALawWithEffectsOfAnotherKindThatLeavesNoiseNeedsNoTendons) {
  const Joint joint(0.2);
  Search search = found({"angle_periodic"});
  search.law = law_of({"motor_angle", "joint_offset", "angle_periodic"});
  search.noise_floor = 0.01;
  EXPECT_FALSE(better_base(joint.p, law_of({"motor_angle", "joint_offset"}), search));
}

TEST(WithoutFormError, WhatTheBaseExplainsItselfIsNoEffect) {
  // The base leaves its noise and the search named a ripple all the same.
  const Joint joint(0.0);
  Search search = found({"angle_periodic"});
  search.law = law_of({"motor_angle", "joint_offset", "angle_periodic"});
  search.noise_floor = 0.01;
  search.lacks_something = true;
  search.unlisted = "something";
  const LawForm base = law_of({"motor_angle", "joint_offset"});
  const Search answer = without_form_error(joint.p, {base, 0.0}, search);
  EXPECT_TRUE(answer.effects.empty());
  EXPECT_EQ(answer.law.terms, base.terms);
  EXPECT_FALSE(answer.lacks_something);
  EXPECT_TRUE(answer.unlisted.empty());
  EXPECT_NEAR(answer.share.value, 0.0, 1e-12);
}

TEST(WithoutFormError, WhatTheBasesFormMayErrByIsNoEffectEither) {
  // A ripple of 0.05 leaves 0.037 rms: several noises, and within the form's error of 0.05.
  const Joint joint(0.05);
  Search search = found({"angle_periodic"});
  search.law = law_of({"motor_angle", "joint_offset", "angle_periodic"});
  search.noise_floor = 0.01;
  const LawForm base = law_of({"motor_angle", "joint_offset"});
  EXPECT_TRUE(without_form_error(joint.p, {base, 0.05}, search).effects.empty());
}

TEST(WithoutFormError, EffectsBeyondTheOneThatSufficesAreLeftOut) {
  const Joint joint(0.2);
  Search search = found({"angle_periodic", "thermal_drift"});
  search.law = law_of({"motor_angle", "joint_offset", "angle_periodic", "thermal_drift"});
  search.noise_floor = 0.01;
  const Search answer = without_form_error(joint.p, {law_of({"motor_angle", "joint_offset"}), 0.0}, search);
  ASSERT_EQ(answer.effects.size(), 1u);
  EXPECT_EQ(answer.effects.front().name, "angle_periodic");
  EXPECT_EQ(answer.law.terms, (std::vector<std::string>{"motor_angle", "joint_offset", "angle_periodic"}));
  EXPECT_GT(answer.share.value, 0.99);  // 0.0001 of 0.02
}

TEST(WithoutFormError, WhereNothingSufficesTheSearchStands) {
  const Joint joint(0.2);
  Search search = found({"thermal_drift", "gravity"});
  search.law = law_of({"motor_angle", "joint_offset", "thermal_drift"});
  search.noise_floor = 0.01;
  search.lacks_something = true;
  const Search answer = without_form_error(joint.p, {law_of({"motor_angle", "joint_offset"}), 0.0}, search);
  EXPECT_EQ(answer.effects.size(), 2u);
  EXPECT_TRUE(answer.lacks_something);
}

}  // namespace
}  // namespace capstan::tools
