// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/identify/term_catalogue.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>

#include "capstan/model/terms/table.hpp"
#include "capstan/tests/tools/synthetic_joint.hpp"
#include "capstan/tools/identify/law_fit.hpp"

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

// A report names them to whoever has an effort before them.
TEST(TermCatalogue, TermsOfAnEffortAreTakenForNoneThatOnlyAnAngleHas) {
  const Catalogue& efforts = effort_catalogue(AxisKind::kRotary);
  for (const auto& term : efforts) {
    std::string words = term.confusable_with;
    std::replace(words.begin(), words.end(), ',', ' ');
    std::istringstream stream(words);
    for (std::string word; stream >> word;) {
      EXPECT_TRUE(efforts.has(word) || !term_catalogue().has(word)) << term.name << " is easily taken for " << word;
    }
  }
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
  const std::size_t hysteresis = catalogue_term("hysteresis").first_shape;
  law.shapes[hysteresis + 1] = 0.3;  // two plays in front of the ratio
  law.shapes[hysteresis + 2] = 0.11;
  law.shapes[hysteresis + 3] = -0.2;
  form.shapes.assign(law.shapes.begin(), law.shapes.end());
  const LawDesign design(logs, conditioner);
  const Eigen::VectorXd theta =
      Eigen::Map<const Eigen::VectorXd>(law.coefficients.data(), static_cast<Eigen::Index>(law.coefficients.size()));
  const Eigen::VectorXd by_columns = law_columns(design, form) * theta;
  EXPECT_LT((by_columns - simulate(logs, law)).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(TermCatalogue, RelationsNameTermsThatThereAre) {
  for (const Catalogue* catalogue : {&term_catalogue(), &effort_catalogue(AxisKind::kRotary)}) {
    for (const auto& term : *catalogue) {
      for (const auto* names : {&term.builds_on, &term.special_cases}) {
        for (const auto& name : *names) {
          EXPECT_TRUE(catalogue->has(name)) << term.name << " names " << name;
          EXPECT_NE(name, term.name);
        }
      }
      for (const auto& name : term.doubles) {
        EXPECT_TRUE(term_catalogue().has(name) || effort_catalogue(AxisKind::kRotary).has(name)) << name;
        EXPECT_NE(name, term.name);
      }
    }
  }
  EXPECT_EQ(catalogue_term("slip_propagation").builds_on, std::vector<std::string>{"tendon_elongation"});
  EXPECT_EQ(effort_catalogue(AxisKind::kRotary).term("play_friction").special_cases,
            std::vector<std::string>{"coulomb_friction"});
  EXPECT_TRUE(contains(catalogue_term("play").shown_by, Motion::kSmall));
}

TEST(TermCatalogue, AnUnusualSignHasItsReason) {
  int either = 0;
  for (const auto& term : term_catalogue()) {
    for (const auto& c : term.coefficients) {
      EXPECT_EQ(c.usual == Sign::kAny, *c.unusual_because == '\0') << term.name;
      EXPECT_TRUE(c.usual == Sign::kAny || c.sign == Sign::kAny) << term.name << ": a hard sign has no unusual one";
      either += c.usual != Sign::kAny ? 1 : 0;
    }
  }
  EXPECT_EQ(either, 6) << "viscous drag twice, pretension, inertia, the slip front, the tendons' compliance";
}

TEST(EffortCatalogue, HasEveryNameOfTheContract) {
  for (const char* name : {"viscous_friction", "coulomb_friction", "friction_asymmetry", "stribeck_friction",
                           "play_friction", "offset", "gravity", "axis_coupling", "angle_periodic", "transport_delay",
                           "thermal_drift", "spring", "power_law_friction", "load_friction"}) {
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

// An arm's cable that is dragged along by another axis: what that moves at asks for torque as well as where it is.
TEST(EffortCatalogue, AnotherAxisActsByItsSpeedAndAccelerationToo) {
  constexpr double kPeriodS = 0.002;
  Samples samples(1000);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    samples[i].others[0].q1 = std::sin(3.0 * kPeriodS * static_cast<double>(i));
  }
  const CatalogueTerm& term = effort_catalogue(AxisKind::kRotary).term("axis_coupling");
  ASSERT_STREQ(term.coefficients.back().name, "inertia");
  EXPECT_STREQ(term.coefficients.back().unit, "kgm2");
  const auto columns = term.columns(samples, kPeriodS, {});
  ASSERT_EQ(columns.cols(), static_cast<Eigen::Index>(term.coefficients.size()));
  for (Eigen::Index i = 20; i < 980; ++i) {
    const double phase = 3.0 * kPeriodS * static_cast<double>(i);
    EXPECT_NEAR(columns(i, columns.cols() - 2), 3.0 * std::cos(phase), 1e-3);
    EXPECT_NEAR(columns(i, columns.cols() - 1), -9.0 * std::sin(phase), 5e-3);
  }
}

TEST(EffortCatalogue, InertiaIsPerRadPerSecondSquared) {
  Samples samples(1);
  samples[0].ddq1 = 0.25;  // krad/s2
  const auto columns = effort_catalogue(AxisKind::kRotary).term("inertia").columns(samples, 0.001, {});
  EXPECT_DOUBLE_EQ(columns(0, 0), 250.0);
}

TEST(TermCatalogue, ColumnsOfATableAreWhatTheTermGives) {
  test::SyntheticRequest request;
  request.cycle_s = 5.0;
  request.cycles = 1;
  const Samples samples = causal_samples(test::synthetic_log(request), {});
  const Shapes shapes = {0.0, 9.0, -0.8, 0.8, 1.0};  // over the motor angle, part of which lies outside, times torque
  const Eigen::MatrixXd columns = term_catalogue().term("table").columns(samples, 0.005, shapes);
  Table<double> table(SamplePeriod<double>(0.005), {0.0, 9.0, -0.8, 0.8, 1.0});
  for (Eigen::Index row = 0; row < columns.rows(); ++row) {
    const auto& sample = samples[static_cast<std::size_t>(row)];
    const auto regressors = table.update(sample);
    for (Eigen::Index i = 0; i < columns.cols(); ++i) {
      ASSERT_EQ(columns(row, i), regressors[static_cast<std::size_t>(i)]) << "row " << row << ", knot " << i;
    }
    ASSERT_NEAR(columns.row(row).sum(), sample.tau, 1e-15);  // shares of one whole, times the factor
  }
}

}  // namespace
}  // namespace capstan::tools
