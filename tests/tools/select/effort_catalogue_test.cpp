// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/select/effort_catalogue.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace capstan::tools {
namespace {

/// Samples in motion: no column of any term is nothing by accident.
auto moving() -> Samples {
  Samples samples(200);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double t = 0.05 * static_cast<double>(i);
    samples[i].q1 = samples[i].h = samples[i].q2 = std::sin(t);
    samples[i].dq1 = samples[i].dh = std::cos(t);
    samples[i].ddq1 = -1e-3 * std::sin(t);
    samples[i].tau = 0.3 * std::cos(0.7 * t);
    samples[i].forward = samples[i].dq1 > 0.0;
  }
  return samples;
}

TEST(EffortLawCatalogue, EveryTermGivesAColumnPerCoefficientUnderItsInitialShapes) {
  const Samples samples = moving();
  for (const Catalogue* catalogue :
       {&effort_law_catalogue(AxisKind::kRotary), &effort_law_catalogue(AxisKind::kLinear), &gear_law_catalogue()}) {
    for (const auto& term : *catalogue) {
      if (term.acts_on_output) {
        continue;
      }
      const Eigen::MatrixXd columns =
          term.pair_columns ? term.pair_columns(samples, samples) : term.columns(samples, 0.05, term.initial_shapes());
      EXPECT_EQ(columns.rows(), 200) << term.name;
      EXPECT_EQ(columns.cols(), static_cast<Eigen::Index>(term.coefficients.size())) << term.name;
      EXPECT_TRUE(columns.allFinite()) << term.name;
    }
  }
}

TEST(EffortLawCatalogue, NoNameStandsTwiceAndOutputTermsStandLast) {
  for (const AxisKind axis : {AxisKind::kRotary, AxisKind::kLinear}) {
    std::set<std::string> names;
    bool output = false;
    for (const auto& term : effort_law_catalogue(axis)) {
      EXPECT_TRUE(names.insert(term.name).second) << term.name;
      EXPECT_TRUE(!output || term.acts_on_output) << term.name;
      output = output || term.acts_on_output;
    }
    EXPECT_TRUE(output);
  }
}

TEST(EffortLawCatalogue, ASlideIsInMetresAndNewtons) {
  const Catalogue& slide = effort_law_catalogue(AxisKind::kLinear);
  EXPECT_EQ(slide.target_unit(), "N");
  EXPECT_EQ(slide.motion_unit(), "m");
  const std::set<std::string> rotary = {"rad", "rad/s", "Nm", "Nm/rad", "Nms/rad", "Nm/K", "kgm2"};
  for (const char* name : {"spring", "play_friction", "power_law_friction", "axis_coupling_axis3", "load_friction_2"}) {
    for (const auto& coefficient : slide.term(name).coefficients) {
      EXPECT_EQ(rotary.count(coefficient.unit), 0u) << name << ": " << coefficient.unit;
    }
    for (const auto& shape : slide.term(name).shapes) {
      EXPECT_EQ(rotary.count(shape.unit), 0u) << name << ": " << shape.unit;
    }
  }
  EXPECT_EQ(effort_law_catalogue(AxisKind::kRotary).target_unit(), "Nm");
}

TEST(EffortLawCatalogue, FurtherPlacesAreTheSameTermByAnotherName) {
  const Catalogue& catalogue = effort_law_catalogue(AxisKind::kRotary);
  const Samples samples = moving();
  for (const auto& [first, further] : {std::pair{"angle_periodic", "angle_periodic_3"},
                                       {"play_friction", "play_friction_2"},
                                       {"load_friction", "load_friction_2"}}) {
    const CatalogueTerm& own = catalogue.term(first);
    const CatalogueTerm& more = catalogue.term(further);
    EXPECT_NE(own.first_coefficient, more.first_coefficient);
    EXPECT_EQ(
        (own.columns(samples, 0.05, own.initial_shapes()) - more.columns(samples, 0.05, more.initial_shapes())).norm(),
        0.0);
  }
  EXPECT_FALSE(catalogue.has("angle_periodic_4"));
}

TEST(EffortLawCatalogue, AnotherAxissAccelerationIsInSiUnits) {
  const CatalogueTerm& coupling = effort_law_catalogue(AxisKind::kRotary).term("axis_coupling_axis5");
  EXPECT_EQ(*coupling.of_axis, 5);
  ASSERT_EQ(coupling.coefficients.size(), 4u);
  EXPECT_STREQ(coupling.coefficients[3].unit, "kgm2");
  const Samples samples = moving();
  EXPECT_NEAR(coupling.columns(samples, 0.05, {})(30, 3), -std::sin(1.5), 1e-9);
}

TEST(GearLawCatalogue, ExplainsATorqueByTheMotorsWithAnySign) {
  const Catalogue& gears = gear_law_catalogue();
  EXPECT_EQ(gears.target(), TargetKind::kForce);
  EXPECT_TRUE(gears.has("gear_torque"));
  EXPECT_TRUE(gears.has("torque_saturation"));
  EXPECT_TRUE(gears.has("power_law_friction"));
  for (const auto& term : gears) {
    EXPECT_FALSE(term.acts_on_output) << term.name;
    for (const auto& coefficient : term.coefficients) {
      EXPECT_EQ(coefficient.sign, Sign::kAny) << term.name;
    }
  }
}

TEST(EffectName, IsTheTermWithoutPlaceOrAxisAndNothingElse) {
  EXPECT_EQ(effect_name("offset"), "offset");
  EXPECT_EQ(effect_name("axis_coupling_axis12"), "axis_coupling");
  EXPECT_EQ(effect_name("play_friction_2"), "play_friction");
  EXPECT_EQ(effect_name("play_friction_2b"), "play_friction_2b");
  EXPECT_EQ(effect_name("of_axis"), "of_axis");  // no number
  EXPECT_EQ(effect_name("ends_with_"), "ends_with_");
}

}  // namespace
}  // namespace capstan::tools
