// SPDX-License-Identifier: Apache-2.0
#include "tools/identify/term_catalogue.hpp"

#include <gtest/gtest.h>

#include <set>

#include "tests/tools/synthetic_joint.hpp"
#include "tools/identify/law_fit.hpp"

namespace capstan::tools {
namespace {

TEST(TermCatalogue, CountsAndOrderAreThoseOfTheParameters) {
  std::size_t coefficients = 0;
  std::size_t shapes = 0;
  std::set<std::string> names;
  for (const auto& term : term_catalogue()) {
    EXPECT_EQ(term.first_coefficient, coefficients) << term.name;
    EXPECT_EQ(term.first_shape, shapes) << term.name;
    coefficients += term.coefficients.size();
    shapes += term.shapes.size();
    EXPECT_TRUE(names.insert(term.name).second) << term.name << " appears twice";
    EXPECT_FALSE(term.equation.empty());
    EXPECT_FALSE(term.exciting_motion.empty());
  }
  EXPECT_EQ(coefficients, kCoefficientCount);
  EXPECT_EQ(shapes, kShapeCount);
}

TEST(TermCatalogue, ColumnsTimesCoefficientsAreTheLawItself) {
  test::SyntheticRequest request;
  request.cycle_s = 10.0;
  request.cycles = 1;
  const std::vector<AxisLog> logs = {test::synthetic_log(request)};
  const ConditionerShape<double> conditioner;
  LawParameters<double> law = rigid_law();
  law.conditioner = conditioner;
  LawForm form;
  for (const auto& term : term_catalogue()) {
    form.terms.push_back(term.name);
  }
  for (std::size_t i = 0; i < law.coefficients.size(); ++i) {
    law.coefficients[i] = 0.3 + 0.1 * static_cast<double>(i);
  }
  // A running law's gravity is that of its own estimate, a fit's that of the measured angle.
  const std::size_t gravity = catalogue_term("gravity").first_coefficient;
  law.coefficients[gravity] = law.coefficients[gravity + 1] = 0.0;
  law.shapes[catalogue_term("transport_delay").first_shape] = 0.0123;
  form.shapes.assign(law.shapes.begin(), law.shapes.end());
  const LawDesign design(logs, conditioner);
  const Eigen::VectorXd theta =
      Eigen::Map<const Eigen::VectorXd>(law.coefficients.data(), static_cast<Eigen::Index>(law.coefficients.size()));
  const Eigen::VectorXd by_columns = law_columns(design, form) * theta;
  EXPECT_LT((by_columns - simulate(logs, law)).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(EffortCatalogue, HasEveryNameOfTheContract) {
  for (const char* name :
       {"viscous_friction", "coulomb_friction", "friction_asymmetry", "stribeck_friction", "play_friction", "offset",
        "gravity", "axis_coupling", "angle_periodic", "transport_delay", "thermal_drift"}) {
    EXPECT_TRUE(effort_catalogue(AxisKind::kRotary).has(name)) << name;
  }
  EXPECT_EQ(effort_catalogue(AxisKind::kRotary).target(), TargetKind::kEffort);
}

TEST(EffortCatalogue, UnitsFollowTheKindOfAxis) {
  const auto unit = [](AxisKind axis, const char* term) {
    return std::string(effort_catalogue(axis).term(term).coefficients[0].unit);
  };
  EXPECT_EQ(unit(AxisKind::kRotary, "inertia"), "kgm2");
  EXPECT_EQ(unit(AxisKind::kLinear, "inertia"), "kg");
  EXPECT_EQ(unit(AxisKind::kRotary, "viscous_friction"), "Nms/rad");
  EXPECT_EQ(unit(AxisKind::kLinear, "viscous_friction"), "Ns/m");
  EXPECT_EQ(unit(AxisKind::kRotary, "angle_periodic"), "Nm");
  EXPECT_EQ(unit(AxisKind::kLinear, "angle_periodic"), "N");
  EXPECT_EQ(unit(AxisKind::kRotary, "axis_coupling"), "Nm/rad");
  EXPECT_STREQ(effort_catalogue(AxisKind::kLinear).term("play_friction").shapes[0].unit, "m");
  EXPECT_EQ(effort_catalogue(AxisKind::kLinear).target_unit(), "N");
  EXPECT_FALSE(effort_catalogue(AxisKind::kLinear).has("gravity"));
}

TEST(EffortCatalogue, InertiaIsPerRadPerSecondSquared) {
  Samples samples(1);
  samples[0].ddq1 = 0.25;  // krad/s2
  const auto columns = effort_catalogue(AxisKind::kRotary).term("inertia").columns(samples, 0.001, {});
  EXPECT_DOUBLE_EQ(columns(0, 0), 250.0);
}

}  // namespace
}  // namespace capstan::tools
