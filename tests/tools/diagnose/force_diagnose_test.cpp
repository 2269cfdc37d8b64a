// SPDX-License-Identifier: Apache-2.0
// Diagnoses of made-up transmissions whose target is the joint's torque, from the motor's.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>

#include "capstan/tools/diagnose/diagnosis.hpp"
#include "capstan/tools/identify/force_catalogue.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/random.hpp"

namespace capstan::tools {
namespace {

constexpr double kPeriodS = 0.01;
constexpr Eigen::Index kCycle = 4000;
constexpr Eigen::Index kSamples = 4 * kCycle;
constexpr double kNoiseNm = 2e-4;

auto wave(Eigen::Index i, double periods, double phase) -> double {
  return std::sin(2.0 * std::numbers::pi * periods * static_cast<double>(i) / static_cast<double>(kCycle) + phase);
}

/// Four equal cycles of motor torque, joint torque to be filled in.
auto bench(const std::function<double(Eigen::Index)>& torque) -> AxisLog {
  AxisLog log;
  log.name = "bench";
  log.target = "axis0/tau_out_Nm";
  log.period_s = kPeriodS;
  log.has_torque = true;
  log.time_s = Eigen::VectorXd::LinSpaced(kSamples, 0.0, kPeriodS * static_cast<double>(kSamples - 1));
  log.tau_nm.resize(kSamples);
  for (Eigen::Index i = 0; i < kSamples; ++i) {
    log.tau_nm[i] = torque(i);
  }
  log.q1_rad = 2.0 * log.tau_nm;
  log.effort = Eigen::VectorXd::Zero(kSamples);
  return log;
}

/// A joint of many slack springs side by side: plays of all widths up to 0.1 N m, so a Preisach joint whose table has
/// kinks.
auto preisach_bench() -> AxisLog {
  AxisLog log =
      bench([](Eigen::Index i) { return 0.072 * wave(i, 2, 0.0) + 0.048 * wave(i, 5, 1.0) + 0.036 * wave(i, 3, 4.0); });
  std::array<double, 50> plays{};
  for (Eigen::Index i = 0; i < kSamples; ++i) {
    double sum = 0.0;
    for (std::size_t k = 0; k < plays.size(); ++k) {
      const double width = 0.1 * (static_cast<double>(k) + 0.5) / static_cast<double>(plays.size());
      plays[k] = std::clamp(plays[k], log.tau_nm[i] - width, log.tau_nm[i] + width);
      sum += plays[k] / static_cast<double>(plays.size());
    }
    log.effort[i] = 0.7 * sum + 0.05 * log.tau_nm[i];
    log.q1_rad[i] = 2.0 * log.tau_nm[i] + 0.5 * sum;
  }
  return log;
}

/// Joint torque while both tendons move, the motor pulling with x: (2.11), (2.16), (2.19) solved as they stand.
auto line(double x, double eta, double pretension) -> double {
  const double decay = std::exp(-eta);
  const double mean = (1.0 - decay) / eta;
  double pushed = (pretension - mean * x) / (mean * decay + mean);  // t = x + B decay in mean t + mean B = I'
  double pulled = x + pushed * decay;
  if (pushed < 0.0) {
    pushed = 0.0;
    pulled = x;
  } else if (pulled < 0.0) {
    pulled = 0.0;
    pushed = -x / decay;
  }
  return decay * pulled - pushed;
}

/// Two tendons with friction, slow triangles of three heights that make each go slack.
auto pull_push_bench() -> AxisLog {
  constexpr double kEta = 1.1;
  constexpr double kPretensionNm = 0.05;
  AxisLog log = bench([](Eigen::Index i) {
    const double height = 0.25 - 0.04 * static_cast<double>(i % kCycle * 4 / kCycle % 3);
    return height * 2.0 / std::numbers::pi * std::asin(0.9999 * wave(i, 4, 0.3));
  });
  double out = 0.0;
  for (Eigen::Index i = 1; i < kSamples; ++i) {
    const double x = log.tau_nm[i];
    const bool forward = x > log.tau_nm[i - 1];
    out = forward ? std::max(out, line(x, kEta, kPretensionNm)) : std::min(out, -line(-x, kEta, kPretensionNm));
    log.effort[i] = 0.9 * out;
  }
  return log;
}

/// The bench with an effect of this rms, N m, and the sensors' noise.
auto diagnosed(AxisLog log, const std::string& base, const std::function<double(Eigen::Index)>& effect, double size_nm)
    -> Diagnosis {
  Eigen::VectorXd values(kSamples);
  for (Eigen::Index i = 0; i < kSamples; ++i) {
    values[i] = effect(i);
  }
  const double spread = std::sqrt((values.array() - values.mean()).square().mean());
  Random random(5);
  for (Eigen::Index i = 0; i < kSamples; ++i) {
    log.effort[i] += (spread > 0.0 ? size_nm / spread * values[i] : 0.0) + kNoiseNm * random.normal();
    log.tau_nm[i] += 5e-5 * random.normal();
  }
  DiagnoseOptions options;
  options.base_model = base;
  return diagnose({log}, options);
}

auto nothing(Eigen::Index /*i*/) -> double {
  return 0.0;
}
auto warm_up(Eigen::Index i) -> double {
  return 1.0 - std::exp(-static_cast<double>(i) / 9000.0);
}
auto jump(Eigen::Index i) -> double {
  return i > 5500 ? 1.0 : 0.0;
}

void expect_named(const Diagnosis& d, const std::string& name) {
  EXPECT_EQ(d.verdict, Verdict::kEffect) << d.reason;
  ASSERT_EQ(d.effects.size(), 1U) << d.reason;
  EXPECT_EQ(d.effects.front().name, name) << d.reason;
  EXPECT_TRUE(d.effects.front().alternatives.empty());
  EXPECT_LT(d.after.rmse, 0.6 * d.before.rmse);
  EXPECT_EQ(d.unit, "Nm");
}

TEST(DiagnoseForce, NothingIsNamedWhereTheForceLawIsWhole) {
  for (const auto& [base, log] : {std::pair{"preisach", preisach_bench()}, std::pair{"pull_push", pull_push_bench()}}) {
    const Diagnosis d = diagnosed(log, base, nothing, 0.0);
    EXPECT_EQ(d.verdict, Verdict::kNothingMissing) << base << ": " << d.reason;
    EXPECT_EQ(d.base_model, base);
    EXPECT_EQ(d.target, "axis0/tau_out_Nm");
    EXPECT_LT(d.before.relative_percent, 2.0) << base;
  }
}

TEST(DiagnoseForce, PullPushParametersAreThoseOfTheBench) {
  const Diagnosis d = diagnosed(pull_push_bench(), "pull_push", nothing, 0.0);
  const auto& term = d.base.catalogue->term("pull_push");
  const auto shape = [&](std::size_t i) { return d.base.parameters.shapes[term.first_shape + i]; };
  EXPECT_NEAR(d.base.parameters.coefficients[term.first_coefficient], 0.9, 0.01);
  EXPECT_NEAR(shape(0), 1.1, 0.02);
  EXPECT_NEAR(shape(1), 1.1, 0.02);
  EXPECT_NEAR(shape(2), 0.05, 0.002);
}

TEST(DiagnoseForce, WhatFrictionAndWarmthTakeIsNamed) {
  const AxisLog preisach = preisach_bench();
  const auto speed = [&](Eigen::Index i) { return i > 0 ? preisach.q1_rad[i - 1] - preisach.q1_rad[i] : 0.0; };
  expect_named(diagnosed(preisach, "preisach", speed, 0.004), "viscous_friction");
  expect_named(diagnosed(preisach, "preisach", warm_up, 0.003), "thermal_drift");
  // Where its pieces meet, a law that a drift has bent a little leaves something that comes back every cycle.
  const Diagnosis d = diagnosed(pull_push_bench(), "pull_push", warm_up, 0.001);
  ASSERT_EQ(d.effects.size(), 1U) << d.reason;
  EXPECT_EQ(d.effects.front().name, "thermal_drift") << d.reason;
  EXPECT_LT(d.after.rmse, 0.6 * d.before.rmse);
}

TEST(DiagnoseForce, AnEffectInNoListIsNotNamed) {
  for (const auto& [base, log] : {std::pair{"preisach", preisach_bench()}, std::pair{"pull_push", pull_push_bench()}}) {
    const Diagnosis d = diagnosed(log, base, jump, 0.003);
    EXPECT_EQ(d.verdict, Verdict::kUnknown) << base << ": " << d.reason;
    EXPECT_TRUE(d.effects.empty());
  }
}

TEST(DiagnoseForce, ALogThatGivesAForceLawNoStartIsUnfitWithACure) {
  const Diagnosis d = diagnosed(
      bench([](Eigen::Index i) { return 0.1 + 0.05 * wave(i, 4, 0.0); }), "pull_push",
      [](Eigen::Index i) { return 3.0 + wave(i, 4, 0.0); }, 0.05);
  EXPECT_EQ(d.verdict, Verdict::kDataUnfit);
  EXPECT_NE(d.reason.find("record slow triangles"), std::string::npos) << d.reason;
  EXPECT_TRUE(d.next_experiment.has_value());
}

TEST(ForceCatalogue, WhatAGridHidesFallsToNothingOnItsOwnJoints) {
  AxisLog log = preisach_bench();
  log.effort = log.tau_nm;
  LawForm form = force_form("preisach", {log});
  const LawDesign design({log}, ConditionerShape<double>{});
  const Eigen::MatrixXd columns = law_columns(design, form);
  // Relays spread evenly over the whole triangle: both grids are exact, and a single cell is what only the finer can
  // do.
  Eigen::VectorXd even = Eigen::VectorXd::Zero(columns.rows());
  Eigen::Index column = 1;
  for (int row = 0; row < 10; ++row) {
    for (int cell = 0; cell <= row; ++cell, ++column) {
      even += (row == cell ? 0.5 : 1.0) * columns.col(column);
    }
  }
  const double scale = even.maxCoeff() - even.minCoeff();
  EXPECT_LT(hidden_by_grid(design, form, even).cwiseAbs().maxCoeff(), 0.02 * scale);
  EXPECT_GT(hidden_by_grid(design, form, columns.col(20)).cwiseAbs().maxCoeff(), 0.1);
}

}  // namespace
}  // namespace capstan::tools
