// SPDX-License-Identifier: Apache-2.0
// Diagnoses of made-up transmissions whose target is the joint's torque, from the motor's.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <numbers>

#include "capstan/tools/diagnose/diagnosis.hpp"
#include "capstan/tools/diagnose/effort_delivery.hpp"
#include "capstan/tools/identify/force_catalogue.hpp"
#include "capstan/tools/identify/force_section.hpp"
#include "capstan/tools/jobs/diagnose_job.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/random.hpp"
#include "capstan/tools/support/statistics.hpp"
#include "capstan/tools/support/text.hpp"

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

/// A motor behind a gear that rubs, and gives less the more it is asked for.
auto gear_bench() -> AxisLog {
  AxisLog log =
      bench([](Eigen::Index i) { return 0.5 * wave(i, 7, 0.0) + 0.4 * wave(i, 17, 1.0) + 0.3 * wave(i, 11, 4.0); });
  for (Eigen::Index i = 0; i < kSamples; ++i) {
    log.q1_rad[i] = wave(i, 5, 0.7) + 0.4 * wave(i, 13, 2.0);
    const double driven = 2.0 * log.tau_nm[i];
    const bool forward = i > 0 && log.q1_rad[i] > log.q1_rad[i - 1];
    log.effort[i] = driven - 0.1 * driven * std::abs(driven) - (forward ? 0.1 : -0.1);
  }
  return log;
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
  // No file holds a pull-push law with a drift: what is told and written is the law without.
  EXPECT_EQ(d.law.terms, std::vector<std::string>{"pull_push"});
  EXPECT_EQ(d.after.rmse, d.before.rmse);
  EXPECT_TRUE(std::any_of(d.warnings.begin(), d.warnings.end(), [](const auto& warning) {
    return warning.find("no file holds a pull-push law with thermal_drift") != std::string::npos;
  }));
  ASSERT_TRUE(d.found);
  AxisLog log = pull_push_bench();
  log.effort = d.traces.measured;
  log.tau_nm = d.traces.load;
  const auto left = [&](const Eigen::VectorXd& estimate) { return rms(log.effort - estimate); };
  EXPECT_LT(left(estimates({log}, LawDesign({log}, d.found->parameters.conditioner), *d.found)),
            0.6 * left(d.traces.before));
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

auto text_of(const ForceFit& fit) -> std::string {
  std::string text;
  for (const auto& one : fit.parameters) {
    text += one.name + " " + std::to_string(one.value) + "\n";
  }
  return text;
}

// A law that is grown knows no tendons. Where what was asked for does as well, it is what is told, written and judged.
TEST(DeliveredForceLaw, IsTheOneThatWasAskedForWhereNoOtherErrsClearlyLess) {
  Diagnosis d = diagnosed(pull_push_bench(), "pull_push", nothing, 0.0);
  EXPECT_FALSE(d.effort_law);
  ASSERT_TRUE(d.pull_push);
  EXPECT_EQ(d.law.terms, std::vector<std::string>{"pull_push"});
  EXPECT_EQ(d.law.status, LawStatus::kBase);
  EXPECT_EQ(d.before.rmse, d.after.rmse);
  EXPECT_LT(d.after.relative_percent, 2.0);
  EXPECT_EQ(d.ratio_ci95, (Interval{1.0, 1.0}));
  const auto& term = d.law.catalogue->term("pull_push");
  EXPECT_EQ(d.law.parameters.coefficients[term.first_coefficient], d.pull_push->law.ratio);
  EXPECT_EQ(d.base.parameters.shapes[term.first_shape], d.pull_push->law.eta_top);
  const auto json = nlohmann::json::parse(diagnosis_json(d));
  EXPECT_EQ(json["base"]["model"], "pull_push");
  EXPECT_EQ(json["base"]["parameters"]["eta_top"]["value"].get<double>(), d.pull_push->law.eta_top);
  EXPECT_EQ(json["law"]["terms"], nlohmann::json({"pull_push"}));
  EXPECT_EQ(json["reason"], d.reason);
  const std::string file = testing::TempDir() + "capstan_delivered_force_law.toml";
  EXPECT_EQ(write_law(d, file), "base");
  const PullPushFit written = read_pull_push(read_text_file(file), file);
  EXPECT_EQ(text_of(written), text_of(*d.pull_push));
  EXPECT_NEAR(rms(d.traces.measured - joint_torque_by(written, d.traces.load)), d.after.rmse, 0.2 * d.after.rmse);
  std::filesystem::remove(file);
}

// No file holds a law that its logs do not determine, and a grown law that errs more is no answer to that.
TEST(DeliveredForceLaw, IsNotAWorseOneWhereTheOneAskedForIsNotDetermined) {
  const Diagnosis whole = diagnosed(pull_push_bench(), "pull_push", nothing, 0.0);
  AxisLog log = pull_push_bench();
  log.q1_rad.tail(kSamples / 2).array() += 100.0;  // which hides the strokes from identify
  Diagnosis d = whole;
  d.pull_push.reset();
  deliver_effort_law({log}, d);
  EXPECT_FALSE(d.effort_law);
  EXPECT_FALSE(d.pull_push);
  EXPECT_EQ(d.law.terms, std::vector<std::string>{"pull_push"});
  EXPECT_EQ(d.after.rmse, whole.after.rmse);
  EXPECT_TRUE(std::any_of(d.warnings.begin(), d.warnings.end(), [](const auto& warning) {
    return warning.find("no file holds the pull-push law of these logs: ") == 0;
  }));
  EXPECT_EQ(write_law(d, testing::TempDir() + "capstan_no_law.toml"), "");
}

TEST(DeliveredForceLaw, OfAGearIsOneLawInNamesFileJsonAndErrors) {
  const AxisLog log = gear_bench();
  const Diagnosis d = diagnosed(log, "pull_push", nothing, 0.0);
  ASSERT_TRUE(d.effort_law) << d.reason;
  EXPECT_EQ(d.law.status, LawStatus::kProvisional);
  EXPECT_EQ(d.effort_law->status, "provisional");
  EXPECT_EQ(d.law.terms, d.effort_law->joint.terms);
  EXPECT_EQ(d.law.parameters.coefficients, d.effort_law->joint.parameters.coefficients);
  for (const auto& effect : d.effects) {
    EXPECT_TRUE(d.law.has(effect.name)) << effect.name;
  }
  EXPECT_NE(d.verdict, Verdict::kEffect) << "names and nothing else: " << d.reason;
  EXPECT_NE(d.verdict, Verdict::kNothingMissing);
  EXPECT_LT(d.ratio_ci95[1], 0.9);
  EXPECT_EQ(d.base.terms, std::vector<std::string>{"pull_push"});
  const Eigen::VectorXd left =
      EffortDesign({log}, d.effort_law->view).seen(log.effort) - run_effort_law({log}, *d.effort_law);
  EXPECT_NEAR(rms(left), d.after.rmse, 0.3 * d.after.rmse);
  const auto json = nlohmann::json::parse(diagnosis_json(d));
  EXPECT_EQ(json["law"]["terms"].get<std::vector<std::string>>(), d.law.terms);
  EXPECT_EQ(json["base"]["model"], "pull_push");
  EXPECT_TRUE(json["base"]["parameters"].contains("eta_top"));
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
