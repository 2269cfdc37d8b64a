// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "capstan/tests/tools/synthetic_joint.hpp"
#include "capstan/tools/diagnose/diagnosis.hpp"
#include "capstan/tools/identify/term_catalogue.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

using test::Motion;
using test::SyntheticRequest;
using test::Truth;

auto small_request(Truth truth) -> SyntheticRequest {
  SyntheticRequest request;
  request.truth = truth;
  request.rate_hz = 100.0;
  request.cycle_s = 25.0;
  return request;
}

auto diagnosis_of(const SyntheticRequest& request, const std::string& base = {}) -> Diagnosis {
  DiagnoseOptions options;
  options.base_model = base;
  return diagnose({test::synthetic_log(request)}, options);
}

auto shape_of(const Diagnosis& d, const std::string& term) -> double {
  return d.law.parameters.shapes[catalogue_term(term).first_shape];
}

auto coefficient_of(const Diagnosis& d, const std::string& term, std::size_t i = 0) -> double {
  return d.law.parameters.coefficients[catalogue_term(term).first_coefficient + i];
}

void expect_named(const Diagnosis& d, const std::string& name, Eigen::Index repeats = 4) {
  EXPECT_EQ(d.verdict, Verdict::kEffect) << d.reason;
  ASSERT_EQ(d.effects.size(), 1U) << d.reason;
  EXPECT_EQ(d.effects[0].name, name);
  EXPECT_TRUE(d.effects[0].alternatives.empty());
  EXPECT_LT(d.ratio_ci95[1], 1.0);
  EXPECT_LT(d.after.rmse, d.before.rmse);
  EXPECT_EQ(d.repeats, repeats);
}

TEST(Diagnose, NothingIsNamedWhereNothingIsMissing) {
  for (const Motion motion : {Motion::kLadder, Motion::kSine}) {
    SyntheticRequest request = small_request(Truth::kNone);
    request.motion = motion;
    const Diagnosis d = diagnosis_of(request);
    EXPECT_EQ(d.verdict, Verdict::kNothingMissing) << d.reason;
    EXPECT_TRUE(d.effects.empty());
    EXPECT_EQ(d.before.rmse, d.after.rmse);
  }
}

TEST(Diagnose, ViscousDragIsNamedWithItsCoefficients) {
  const Diagnosis d = diagnosis_of(small_request(Truth::kViscous));
  expect_named(d, "transmission_viscous");
  EXPECT_NEAR(coefficient_of(d, "transmission_viscous", 0), -0.006, 0.001);
  EXPECT_NEAR(coefficient_of(d, "transmission_viscous", 1), -0.009, 0.001);
}

TEST(Diagnose, PretensionIsNamedWithItsContrast) {
  const Diagnosis d = diagnosis_of(small_request(Truth::kPretension));
  expect_named(d, "pretension_offset");
  EXPECT_NEAR(coefficient_of(d, "pretension_offset"), 0.006, 0.001);
}

TEST(Diagnose, PlayIsNamedWithItsWidth) {
  const Diagnosis d = diagnosis_of(small_request(Truth::kPlay));
  expect_named(d, "play");
  EXPECT_NEAR(shape_of(d, "play"), 0.008, 0.001);
  EXPECT_NEAR(coefficient_of(d, "play"), 1.08, 0.15);
}

TEST(Diagnose, ALateJointSensorIsNamedWithItsDelay) {
  SyntheticRequest request = small_request(Truth::kDelay);
  request.strength = 1.5;
  const Diagnosis d = diagnosis_of(request);
  expect_named(d, "transport_delay");
  EXPECT_NEAR(shape_of(d, "transport_delay"), 0.009, 0.0007);
}

TEST(Diagnose, TheMissingElongationIsNamedWhenTheBaseHasNone) {
  const Diagnosis d = diagnosis_of(small_request(Truth::kNone), "kinematic");
  ASSERT_FALSE(d.effects.empty()) << d.reason;
  EXPECT_EQ(d.effects[0].name, "tendon_elongation");
  EXPECT_NEAR(coefficient_of(d, "tendon_elongation", 0), -0.9, 0.1);
  EXPECT_NEAR(coefficient_of(d, "tendon_elongation", 1), -0.6, 0.1);
}

// A tendon of axis 0 runs over axis 2's pulley; axis 1 moves as well, and is looked at first.
TEST(Diagnose, AnAxisThatPullsFromFartherAwayIsPointedAtAndThenNamed) {
  AxisLog log = test::synthetic_log(small_request(Truth::kNone));
  const auto swing = [&log](double per_second) { return Eigen::VectorXd((per_second * log.time_s.array()).sin()); };
  const Eigen::VectorXd nearer = 0.4 * swing(0.83);
  const Eigen::VectorXd farther = 0.4 * swing(1.31);
  log.q2_rad += 0.02 * farther;
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(log.samples());
  log.side = {{"axis1/q1_rad", nearer}, {"axis2/q1_rad", farther}};
  log.others = {OtherAxis{1, nearer, none}};
  const Diagnosis first = diagnose({log}, {});
  EXPECT_EQ(first.verdict, Verdict::kUnknown) << first.reason;
  ASSERT_TRUE(first.next_experiment.has_value());
  EXPECT_NE(first.next_experiment->find("--coupled-to 2"), std::string::npos) << *first.next_experiment;
  log.others = {OtherAxis{2, farther, none}};
  const Diagnosis second = diagnose({log}, {});
  expect_named(second, "axis_coupling", 1);  // the cycles are none of the other axis
  EXPECT_NEAR(coefficient_of(second, "axis_coupling"), 0.02, 0.001);
}

TEST(Diagnose, EveryOtherEffectOfTheCatalogueIsNamedToo) {
  const std::pair<Truth, const char*> named[] = {{Truth::kAngleRipple, "angle_periodic"},
                                                 {Truth::kCreep, "viscoelastic_creep"},
                                                 {Truth::kHardening, "stiffness_hardening"},
                                                 {Truth::kPresliding, "presliding"},
                                                 {Truth::kDrift, "thermal_drift"}};
  for (const auto& [truth, name] : named) {
    SCOPED_TRACE(name);
    expect_named(diagnosis_of(small_request(truth)), name);
  }
}

TEST(Diagnose, AnEffectThatIsInNoListIsUnknown) {
  for (const Truth truth : {Truth::kTorqueRipple, Truth::kStickySpot, Truth::kCoulomb}) {
    const Diagnosis d = diagnosis_of(small_request(truth));
    EXPECT_EQ(d.verdict, Verdict::kUnknown) << test::truth_name(truth) << ": " << d.reason;
    EXPECT_TRUE(d.effects.empty());
    EXPECT_NE(d.law.status, LawStatus::kConfirmed);
    EXPECT_LE(d.after.rmse, d.before.rmse);
    EXPECT_GE(d.after.rmse, d.noise_floor);
  }
}

/// Holds the joint where it is between two shares of the log, with its sensor's noise.
void stick(AxisLog& log, double from, double to) {
  const auto rows = static_cast<double>(log.samples());
  const auto begin = static_cast<Eigen::Index>(from * rows);
  const auto stuck = static_cast<Eigen::Index>((to - from) * rows);
  Eigen::VectorXd noise = Eigen::VectorXd::Zero(stuck);
  for (Eigen::Index i = 0; i < stuck; ++i) {
    noise[i] = 1e-3 * std::sin(12.9898 * static_cast<double>(i * i % 9973));
  }
  log.q2_rad.segment(begin, stuck) = log.q2_rad[begin] + noise.array();
}

TEST(Diagnose, AJointThatSticksForASixthOfTheLogLacksSomethingThoughItsCyclesDifferByThat) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    SyntheticRequest request = small_request(Truth::kNone);
    request.motion = Motion::kMultisine;
    request.seed = seed;
    AxisLog log = test::synthetic_log(request);
    stick(log, 1.0 / 3.0, 0.5);
    const Diagnosis d = diagnose({log}, {});
    EXPECT_EQ(d.repeats, 4);
    EXPECT_NE(d.verdict, Verdict::kNothingMissing) << d.reason;
    EXPECT_GT(d.before.rmse, 0.1) << "the log shows no joint that sticks";
  }
}

TEST(Diagnose, ALawWithoutANameWhoseGainIsNotSeenOnRowsSetAsideIsTheBaseLawOrSaysSo) {
  for (const double from : {0.5, 0.6, 0.8, 0.9}) {
    AxisLog log = test::synthetic_log(small_request(Truth::kPlay));
    stick(log, from, 1.0);
    const Diagnosis d = diagnose({log}, {});
    if (d.law.status == LawStatus::kBase) {
      EXPECT_EQ(d.law.terms, d.base.terms) << from;
      continue;
    }
    const bool warned = std::any_of(d.warnings.begin(), d.warnings.end(), [](const auto& warning) {
      return warning.find("an improvement is not certain") != std::string::npos;
    });
    EXPECT_LT(d.ratio_ci95[0], 1.0) << from;
    EXPECT_EQ(warned, d.ratio_ci95[1] >= 1.0) << from << ": " << d.reason;
  }
}

// What slipped comes after most of the rows to learn from, and a drift that is fast at the start says that as well.
TEST(Diagnose, AJointThatSlippedOnceGetsNoLawThatErrsMoreOverTheWholeLog) {
  AxisLog log = test::synthetic_log(small_request(Truth::kNone));
  log.q2_rad.tail(log.samples() * 2 / 5).array() += 0.2;
  const Diagnosis d = diagnose({log}, {});
  const auto left = [&d](const Eigen::VectorXd& estimate) { return (d.traces.measured - estimate).norm(); };
  EXPECT_LE(left(d.traces.after), left(d.traces.before));
  EXPECT_NE(d.verdict, Verdict::kNothingMissing);
}

// A camera that sinks by 20 mrad shows no more than that, and the law may lead to few times as much.
TEST(Diagnose, AStraightDriftLeadsNotFarBeyondTheLog) {
  AxisLog log = test::synthetic_log(small_request(Truth::kNone));
  log.q2_rad += Eigen::VectorXd::LinSpaced(log.samples(), 0.0, 0.02);
  const Diagnosis d = diagnose({log}, {});
  ASSERT_TRUE(d.law.has("thermal_drift")) << d.reason;
  EXPECT_LT(std::abs(coefficient_of(d, "thermal_drift")), 0.08);
}

TEST(Diagnose, AGapThatHasGrownSinceTheBaseLawIsFittedAndNotMissed) {
  SyntheticRequest request = small_request(Truth::kPlay);
  const Diagnosis healthy = diagnosis_of(request);
  expect_named(healthy, "play");
  request.strength = 2.0;
  request.seed = 2;
  DiagnoseOptions options;
  options.base_law = healthy.law;
  const Diagnosis now = diagnose({test::synthetic_log(request)}, options);
  EXPECT_EQ(now.verdict, Verdict::kNothingMissing) << now.reason;
  EXPECT_NEAR(shape_of(now, "play"), 2.0 * shape_of(healthy, "play"), 0.05 * shape_of(healthy, "play"));
}

// A board without a thermometer has a drift by time alone; what the temperature would do can neither be told nor
// matter.
TEST(Diagnose, ALawWithADriftIsAskedAgainOfItsOwnLog) {
  const AxisLog log = test::synthetic_log(small_request(Truth::kDrift));
  Diagnosis first = diagnose({log}, {});
  expect_named(first, "thermal_drift");
  EXPECT_TRUE(first.undetermined.empty()) << joined(first.undetermined);
  const CatalogueTerm& drift = first.law.catalogue->term("thermal_drift");
  const auto at = std::find_if(drift.coefficients.begin(), drift.coefficients.end(),
                               [](const auto& one) { return one.name == std::string("temperature"); });
  const auto temperature =
      drift.first_coefficient + static_cast<std::size_t>(std::distance(drift.coefficients.begin(), at));
  first.law.parameters.coefficients[temperature] = 0.003;  // found on another day, with a thermometer
  DiagnoseOptions options;
  options.base_law = first.law;
  const Diagnosis again = diagnose({log}, options);
  EXPECT_EQ(again.verdict, Verdict::kNothingMissing) << again.reason;
  EXPECT_LT(again.after.rmse, 1.1 * first.after.rmse);
  EXPECT_EQ(again.base.parameters.coefficients[temperature], 0.003);
  EXPECT_EQ(again.law.parameters.coefficients[temperature], 0.003);
}

TEST(Diagnose, TheSameLogAlwaysGetsTheSameAnswer) {
  const SyntheticRequest request = small_request(Truth::kPlay);
  EXPECT_EQ(diagnosis_json(diagnosis_of(request)), diagnosis_json(diagnosis_of(request)));
}

TEST(Diagnose, AShortOrOneWayLogIsUnfitAndSaysWhatToRecord) {
  SyntheticRequest request = small_request(Truth::kNone);
  request.cycle_s = 0.6;
  request.cycles = 1;
  Diagnosis d = diagnosis_of(request);
  EXPECT_EQ(d.verdict, Verdict::kDataUnfit);
  EXPECT_EQ(d.law.status, LawStatus::kBase) << "a log without a law was said to have a confirmed one";
  EXPECT_GT(d.after.rmse, 0.0) << "no law leaves the whole target";
  ASSERT_TRUE(d.next_experiment.has_value());
  AxisLog log = test::synthetic_log(small_request(Truth::kNone));
  log.q1_rad = Eigen::VectorXd::LinSpaced(log.samples(), 0.0, 1.0);
  log.q2_rad = 1.1 * log.q1_rad;
  for (const double way : {1.0, -1.0}) {  // backward from the first row on is no reversal either
    AxisLog one_way = log;
    one_way.q1_rad *= way;
    one_way.q2_rad *= way;
    d = diagnose({one_way}, {});
    EXPECT_EQ(d.verdict, Verdict::kDataUnfit);
    EXPECT_NE(d.reason.find("never reverses"), std::string::npos);
  }
}

TEST(Diagnose, ALawThatTheLogCanNotDetermineIsNotIdentifiable) {
  AxisLog log = test::synthetic_log(small_request(Truth::kNone));
  log.tau_nm.setZero();
  DiagnoseOptions options;
  options.base_model = "pseudo_kinematic";
  const Diagnosis d = diagnose({log}, options);
  EXPECT_EQ(d.verdict, Verdict::kNotIdentifiable);
  EXPECT_NE(d.reason.find("tendon_elongation.top"), std::string::npos) << d.reason;
}

TEST(Diagnose, WithoutTorqueTheBaseIsKinematic) {
  AxisLog log = test::synthetic_log(small_request(Truth::kNone));
  log.has_torque = false;
  log.tau_nm.setZero();
  EXPECT_EQ(diagnose({log}, {}).base_model, "kinematic");
}

TEST(Diagnose, AForceLawDoesNotExplainAJointAngle) {
  EXPECT_THROW(diagnosis_of(small_request(Truth::kNone), "preisach"), BadInput);
  EXPECT_THROW(diagnosis_of(small_request(Truth::kNone), "pull_push"), BadInput);
}

// Decisions are taken on means over several samples; the floor stands beside errors of single ones.
TEST(Diagnose, TheNoiseFloorIsThatOfSingleSamplesWithoutRepeatsToo) {
  SyntheticRequest request = small_request(Truth::kViscous);
  request.cycles = 1;
  request.cycle_s = 60.0;
  request.rate_hz = 1000.0;
  const Diagnosis d = diagnosis_of(request);
  EXPECT_NE(d.floor_from, "repeats");
  EXPECT_NEAR(d.noise_floor, request.noise_rad, 0.07 * request.noise_rad);
}

TEST(Diagnose, WhatALateEncoderOwesHasNoNameAndAFineOneOwesNothing) {
  const auto said = [](double counts_per_turn) {
    SyntheticRequest request = small_request(Truth::kNone);
    request.counts_per_turn = counts_per_turn;
    const Diagnosis d = diagnosis_of(request);
    EXPECT_TRUE(d.effects.empty()) << d.reason;
    return std::any_of(d.warnings.begin(), d.warnings.end(),
                       [](const auto& warning) { return warning.find("just after reversals") != std::string::npos; });
  };
  static_cast<void>(said(2048.0));
  EXPECT_FALSE(said(4e6));
}

// The other axis is driven against a spring alone: its torque is its angle, and no fit can tell which of them pulls.
TEST(Diagnose, ParametersOfAnEffectThatTheLogCanNotTellApartAreNamedAndNotPrinted) {
  AxisLog log = test::synthetic_log(small_request(Truth::kNone));
  const Eigen::VectorXd swing = 0.4 * (0.83 * log.time_s.array()).sin();
  log.q2_rad += 0.02 * swing;
  log.others = {OtherAxis{1, swing, 0.04 * swing}};
  const Diagnosis d = diagnose({log}, {});
  ASSERT_EQ(d.effects.size(), 1U) << d.reason;
  EXPECT_EQ(d.effects[0].name, "axis_coupling");
  EXPECT_EQ(d.undetermined,
            (std::vector<std::string>{"axis_coupling.angle", "axis_coupling.top", "axis_coupling.bottom"}));
  EXPECT_TRUE(std::any_of(d.warnings.begin(), d.warnings.end(), [](const auto& warning) {
    return warning.find("cannot determine axis_coupling.angle") != std::string::npos;
  }));
  const auto json = nlohmann::json::parse(diagnosis_json(d));
  EXPECT_TRUE(json.at("effects").at(0).at("parameters").at("angle").at("value").is_null());
  // What they come to together is known, and small enough for a board.
  const double together = coefficient_of(d, "axis_coupling", 0) + 0.04 * coefficient_of(d, "axis_coupling", 1);
  EXPECT_NEAR(together, 0.02, 0.001);
  EXPECT_LT(std::abs(coefficient_of(d, "axis_coupling", 0)), 0.021);
}

TEST(DiagnosisJson, HasEveryFieldOfTheContract) {
  const Diagnosis d = diagnosis_of(small_request(Truth::kPlay));
  const auto json = nlohmann::json::parse(diagnosis_json(d));
  EXPECT_EQ(json.at("schema"), "capstan.diagnosis/2");
  EXPECT_EQ(json.at("log").at("samples"), 10000);
  EXPECT_NEAR(json.at("log").at("rate_hz").get<double>(), 100.0, 1e-6);
  EXPECT_EQ(json.at("log").at("repeats"), 4);
  EXPECT_TRUE(json.at("log").at("warnings").is_array());
  EXPECT_EQ(json.at("target"), "axis0/q2_rad");
  EXPECT_EQ(json.at("base").at("model"), "pseudo_kinematic");
  const auto& beta = json.at("base").at("parameters").at("beta");
  EXPECT_EQ(beta.at("unit"), "1");
  EXPECT_LT(beta.at("ci95").at(0).get<double>(), beta.at("value").get<double>());
  EXPECT_GT(beta.at("ci95").at(1).get<double>(), beta.at("value").get<double>());
  EXPECT_EQ(json.at("verdict"), "effect");
  const auto& effect = json.at("effects").at(0);
  EXPECT_EQ(effect.at("name"), "play");
  EXPECT_TRUE(effect.at("alternatives").empty());
  EXPECT_EQ(effect.at("parameters").at("half_width").at("unit"), "rad");
  EXPECT_TRUE(effect.at("evidence").is_object());
  EXPECT_GT(json.at("before").at("rmse").get<double>(), json.at("after").at("rmse").get<double>());
  EXPECT_LT(json.at("before").at("gof_percent").get<double>(), json.at("after").at("gof_percent").get<double>());
  EXPECT_LT(json.at("ratio_ci95").at(0).get<double>(), json.at("ratio_ci95").at(1).get<double>());
  // The noise that the log was made with.
  EXPECT_NEAR(json.at("noise_floor").get<double>(), 0.001, 0.00007);
  EXPECT_TRUE(json.at("next_experiment").is_null());
  EXPECT_EQ(json.at("law").at("status"), "confirmed");
  EXPECT_TRUE(json.at("law").at("file").is_null());
  EXPECT_EQ(json.at("floor_from"), "repeats");
  EXPECT_TRUE(json.at("unnamed").is_null());
  EXPECT_TRUE(json.at("candidates").is_array());
  EXPECT_EQ(json.at("stability").at("halves"), 2);
  EXPECT_TRUE(json.at("test").empty());
  EXPECT_TRUE(json.at("detectable").at(0).at("rmse").is_number());
}

TEST(Diagnose, ALogSetAsideIsJudgedWithAZeroOfItsOwn) {
  DiagnoseOptions options;
  options.test_logs = {test::synthetic_log(small_request(Truth::kPlay))};
  options.test_logs.front().q2_rad.array() += 0.5;
  const Diagnosis d = diagnose({test::synthetic_log(small_request(Truth::kPlay))}, options);
  ASSERT_EQ(d.tested.size(), 1U);
  EXPECT_LT(d.tested[0].after.rmse, 0.7 * d.tested[0].before.rmse);
  EXPECT_NEAR(d.tested[0].after.rmse, d.after.rmse, 0.3 * d.after.rmse);
}

}  // namespace
}  // namespace capstan::tools
