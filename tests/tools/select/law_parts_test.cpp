// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/select/law_parts.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "capstan/tools/select/effort_catalogue.hpp"

namespace capstan::tools {
namespace {

constexpr MotionRanges kLink = {.lowest = -1.0, .highest = 2.0, .speed = 4.0, .torque = 0.5};
constexpr MotionRanges kBehindGear = {.lowest = -20.0, .highest = 20.0, .speed = 40.0, .torque = 0.5};

auto terms_of(const std::vector<LawPart>& parts) -> std::multiset<std::string> {
  std::multiset<std::string> terms;
  for (const auto& part : parts) {
    terms.insert(part.term);
  }
  return terms;
}

auto part_of(const std::vector<LawPart>& parts, const std::string& term) -> const LawPart& {
  return *std::find_if(parts.begin(), parts.end(), [&](const auto& part) { return part.term == term; });
}

TEST(MotionRanges, AreThoseOfAllLogs) {
  AxisLog log;
  log.period_s = 0.01;
  const Eigen::ArrayXd t = Eigen::ArrayXd::LinSpaced(1000, 0.0, 9.99);
  log.time_s = t.matrix();
  log.q1_rad = (0.5 + (2.0 * t).sin()).matrix();
  log.tau_nm = (0.3 * (2.0 * t).cos()).matrix();
  log.effort = Eigen::VectorXd::Zero(1000);
  AxisLog other = log;
  other.q1_rad.array() += 1.0;
  const MotionRanges ranges = motion_ranges(EffortDesign({log, other}, {.window_s = 0.05, .standstill = 0.01}));
  EXPECT_NEAR(ranges.lowest, -0.5, 1e-3);
  EXPECT_NEAR(ranges.highest, 2.5, 1e-3);
  EXPECT_NEAR(ranges.speed, 2.0, 0.01);
  EXPECT_NEAR(ranges.torque, 0.3, 0.01);
  EXPECT_NEAR(ranges.centre(), 1.0, 1e-3);
  EXPECT_NEAR(ranges.half(), 1.5, 1e-3);
}

TEST(EffortParts, BeginWithRigidDynamics) {
  const auto parts = effort_parts(kLink, {}, AxisKind::kRotary);
  const char* first[] = {"inertia", "viscous_friction", "coulomb_friction", "offset"};
  static_assert(std::size(first) == kRigidParts);
  for (std::size_t i = 0; i < kRigidParts; ++i) {
    EXPECT_EQ(parts[i].term, first[i]);
  }
}

TEST(EffortParts, AWeightSwingsOnALinkAndNotOnASlideOrBeforeAGear) {
  EXPECT_EQ(terms_of(effort_parts(kLink, {}, AxisKind::kRotary)).count("gravity"), 1u);
  EXPECT_EQ(terms_of(effort_parts(kLink, {}, AxisKind::kLinear)).count("gravity"), 0u);
  EXPECT_EQ(terms_of(effort_parts(kBehindGear, {}, AxisKind::kRotary)).count("gravity"), 0u);
  EXPECT_EQ(terms_of(effort_parts(kBehindGear, {}, AxisKind::kRotary)).count("spring"), 2u);
}

TEST(EffortParts, FrictionOfALoadNeedsTheLoad) {
  for (const auto& part : effort_parts(kLink, {}, AxisKind::kRotary)) {
    const bool of_load = part.term.rfind("load_friction", 0) == 0;
    EXPECT_EQ(!part.needs.empty(), of_load) << part.term;
    EXPECT_TRUE(part.needs.empty() || part.needs == "spring" || part.needs == "gravity");
  }
}

TEST(EffortParts, OfEachAxisWhoseMotionIsKnownThereAreFour) {
  const auto terms = terms_of(effort_parts(kLink, {{2, false, 1.0}, {5, false, 1.0}}, AxisKind::kRotary));
  EXPECT_EQ(terms.count("axis_coupling_axis2"), 4u);
  EXPECT_EQ(terms.count("axis_coupling_axis5"), 4u);
  EXPECT_EQ(terms.count("axis_coupling_axis0"), 0u);
}

TEST(EffortParts, PostureActsBetweenLinksAndReachFromASlideToATurn) {
  const auto count = [](const MotionRanges& ranges, const KnownAxis& other, AxisKind axis, const std::string& term) {
    return terms_of(effort_parts(ranges, {other}, axis)).count(term);
  };
  const KnownAxis turns = {2, false, 1.0};
  const KnownAxis slides = {2, true, 0.1};
  const KnownAxis motor = {2, false, 40.0};  // more than three turns: before a gear
  EXPECT_EQ(count(kLink, turns, AxisKind::kRotary, "posture_coupling_axis2"), 8u);
  EXPECT_EQ(count(kLink, turns, AxisKind::kRotary, "reach_coupling_axis2"), 0u);
  EXPECT_EQ(count(kLink, slides, AxisKind::kRotary, "reach_coupling_axis2"), 5u);
  EXPECT_EQ(count(kLink, slides, AxisKind::kRotary, "posture_coupling_axis2"), 0u);
  EXPECT_EQ(count(kBehindGear, turns, AxisKind::kLinear, "posture_coupling_axis2"), 5u);  // of any length
  EXPECT_EQ(terms_of(effort_parts(kLink, {slides}, AxisKind::kLinear)).size(),
            terms_of(effort_parts(kLink, {}, AxisKind::kLinear)).size() + 4u);  // two slides: what is alike everywhere
  EXPECT_EQ(count(kBehindGear, turns, AxisKind::kRotary, "posture_coupling_axis2"), 0u);
  EXPECT_EQ(count(kLink, motor, AxisKind::kRotary, "posture_coupling_axis2"), 0u);
}

TEST(EffortParts, SettingsAreSharesOfTheMotion) {
  const auto parts = effort_parts(kLink, {}, AxisKind::kRotary);
  const auto& widths = part_of(parts, "play_friction").settings;
  EXPECT_NEAR(widths.front()[0], 1.5 / 500.0, 1e-12);
  EXPECT_NEAR(widths.back()[0], 0.4 * 1.5, 1e-12);
  const auto& orders = part_of(parts, "angle_periodic").settings;
  EXPECT_NEAR(orders.front()[0], 2.0 * std::numbers::pi / 1.5, 1e-9);  // two periods within the motion
  EXPECT_NEAR(orders.back()[0], 60.0 * std::numbers::pi / 1.5, 1e-9);
  EXPECT_EQ(part_of(parts, "power_law_friction").settings.front()[1], 4.0);
  EXPECT_NEAR(part_of(parts, "stribeck_friction").settings.back()[0], 0.8, 1e-12);
  EXPECT_EQ(part_of(parts, "spring").settings.front(), (Shapes{0.5, 1.5}));
}

TEST(Parts, PeriodsOfTheAngleAreNotTriedOnAFewPlaces) {
  MotionRanges few = kLink;
  few.many_places = false;
  EXPECT_TRUE(part_of(effort_parts(few, {}, AxisKind::kRotary), "angle_periodic").settings.empty());
  EXPECT_TRUE(part_of(gear_parts(few), "angle_periodic").settings.empty());
  EXPECT_FALSE(part_of(gear_parts(kBehindGear), "angle_periodic").settings.empty());
}

TEST(Parts, AreOfTermsThatTheirCataloguesHaveWithAsManyCoefficientsAndShapes) {
  for (const AxisKind axis : {AxisKind::kRotary, AxisKind::kLinear}) {
    for (const auto& part : effort_parts(kLink, {{0, false, 1.0}, {7, true, 1.0}}, axis)) {
      ASSERT_TRUE(effort_law_catalogue(axis).has(part.term)) << part.term;
      const CatalogueTerm& term = effort_law_catalogue(axis).term(part.term);
      EXPECT_LT(*std::max_element(part.coefficients.begin(), part.coefficients.end()), term.coefficients.size());
      for (const auto& setting : part.settings) {
        EXPECT_TRUE(setting.empty() || setting.size() == term.shapes.size()) << part.term;
      }
    }
  }
  const auto gears = gear_parts(kLink);
  EXPECT_EQ(gears[0].term, "gear_torque");
  EXPECT_EQ(gears[kGearBaseParts - 1].term, "offset");
  EXPECT_EQ(part_of(gears, "torque_saturation").settings.front()[0], 0.5);
  for (const auto& part : gears) {
    EXPECT_TRUE(gear_law_catalogue().has(part.term)) << part.term;
  }
}

}  // namespace
}  // namespace capstan::tools
