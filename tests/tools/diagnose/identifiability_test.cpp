// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/diagnose/identifiability.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "capstan/tools/report/covariance_section.hpp"
#include "capstan/tools/select/effort_catalogue.hpp"

namespace capstan::tools {
namespace {

/// What inertia 0.05 and a spring of 0.4 per radian ask for on sines of these frequencies.
auto sprung_log(const std::vector<double>& hertz) -> AxisLog {
  constexpr Eigen::Index kRows = 4000;
  AxisLog log;
  log.name = "made up";
  log.target = "axis0/tau_Nm";
  log.period_s = 0.005;
  log.time_s = Eigen::VectorXd::LinSpaced(kRows, 0.0, (kRows - 1) * log.period_s);
  log.q1_rad = log.effort = log.tau_nm = Eigen::VectorXd::Zero(kRows);
  for (const double one : hertz) {
    const double omega = 2.0 * std::numbers::pi * one;
    const Eigen::VectorXd part = (omega * log.time_s.array()).sin();
    log.q1_rad += part;
    log.effort += (0.4 - 0.05 * omega * omega) * part;
  }
  return log;
}

auto set(JointFile& joint, const char* term, const char* parameter, double value, double half_width) {
  const CatalogueTerm& of = joint.catalogue->term(term);
  for (std::size_t i = 0; i < of.coefficients.size(); ++i) {
    if (std::string(of.coefficients[i].name) == parameter) {
      joint.parameters.coefficients[of.first_coefficient + i] = value;
      joint.coefficient_ci95[of.first_coefficient + i] = Interval{value - half_width, value + half_width};
    }
  }
}

auto sprung_law(const AxisLog& log) -> EffortLaw {
  EffortLaw law;
  law.joint = JointFile(effort_law_catalogue(AxisKind::kRotary));
  law.joint.terms = {"inertia", "viscous_friction", "spring"};
  law.target = log.target;
  law.view = usual_view({log});
  const char* inertia = law.joint.catalogue->term("inertia").coefficients[0].name;
  const char* drag = law.joint.catalogue->term("viscous_friction").coefficients[0].name;
  set(law.joint, "inertia", inertia, 0.05, 0.001);
  set(law.joint, "viscous_friction", drag, 0.001, 0.002);
  set(law.joint, "spring", "linear", 0.4, 0.01);
  return law;
}

auto told_by(const std::vector<double>& hertz) -> Identifiability {
  const AxisLog log = sprung_log(hertz);
  return identifiability_of({log}, sprung_law(log));
}

TEST(Identifiability, OneSineCanNotTellInertiaFromASpring) {
  const Identifiability told = told_by({0.4});
  ASSERT_EQ(told.confused.size(), 1U);
  // k - I w^2 is known: estimates of both rise together.
  EXPECT_GT(told.confused[0].correlation, 0.999);
  EXPECT_NE(told.confused[0].sentence.find("a difference of inertia"), std::string::npos) << told.confused[0].sentence;
  EXPECT_NE(told.confused[0].sentence.find("this motion tells them apart"), std::string::npos);
  EXPECT_LT(told.parameters.front().own, 1e-3);
  EXPECT_NEAR(told.parameters[1].own, 1.0, 1e-2);  // drag is a quarter of a period away from both
}

TEST(Identifiability, SinesOfSeveralFrequenciesTellThemApart) {
  const Identifiability told = told_by({0.3, 1.1});
  EXPECT_TRUE(told.confused.empty());
  EXPECT_GT(told.parameters.front().own, 0.1);
  ASSERT_EQ(told.correlation.rows(), 3);
  EXPECT_NEAR(told.correlation.diagonal().minCoeff(), 1.0, 1e-9);
}

TEST(Identifiability, ContributionsAreSharesOfTheTarget) {
  const Identifiability told = told_by({0.3, 1.1});
  const auto omega = [](double hertz) { return 2.0 * std::numbers::pi * hertz; };
  const double inertia[] = {0.05 * omega(0.3) * omega(0.3), 0.05 * omega(1.1) * omega(1.1)};
  const double all = std::hypot(0.4 - inertia[0], 0.4 - inertia[1]);
  EXPECT_NEAR(told.parameters.front().share, std::hypot(inertia[0], inertia[1]) / all, 0.03);
}

TEST(CovarianceSection, ListsWhatOneSineDoesNotTell) {
  const std::string html = covariance_section(told_by({0.4}));
  for (const char* part : {"What this log can and can not tell", "inertia", "spring.linear",
                           "Correlation of the estimates", "this motion tells them apart", "its interval holds zero"}) {
    EXPECT_NE(html.find(part), std::string::npos) << part;
  }
  const std::string rich = covariance_section(told_by({0.3, 1.1}));
  EXPECT_EQ(rich.find("this motion tells them apart"), std::string::npos);
  EXPECT_TRUE(covariance_section({}).empty());
}

}  // namespace
}  // namespace capstan::tools
