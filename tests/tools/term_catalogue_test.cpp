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
  law.shapes[catalogue_term("transport_delay").first_shape] = 0.0123;
  form.shapes.assign(law.shapes.begin(), law.shapes.end());
  const LawDesign design(logs, conditioner);
  const Eigen::VectorXd theta =
      Eigen::Map<const Eigen::VectorXd>(law.coefficients.data(), static_cast<Eigen::Index>(law.coefficients.size()));
  const Eigen::VectorXd by_columns = law_columns(design, form) * theta;
  EXPECT_LT((by_columns - simulate(logs, law)).cwiseAbs().maxCoeff(), 1e-12);
}

}  // namespace
}  // namespace capstan::tools
