// SPDX-License-Identifier: Apache-2.0
// Diagnoses of made-up axes whose target is an effort.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "capstan/tests/tools/synthetic_effort.hpp"
#include "capstan/tools/diagnose/diagnosis.hpp"
#include "capstan/tools/diagnose/effort_delivery.hpp"
#include "capstan/tools/diagnose/held_terms.hpp"
#include "capstan/tools/diagnose/verdict.hpp"
#include "capstan/tools/identify/identify.hpp"
#include "capstan/tools/joint_file/effort_file.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/random.hpp"
#include "capstan/tools/support/statistics.hpp"

namespace capstan::tools {
namespace {

using test::EffortRequest;
using test::EffortTruth;

auto diagnosis_of(EffortTruth truth, std::uint64_t seed = 1) -> Diagnosis {
  EffortRequest request;
  request.truth = truth;
  request.seed = seed;
  return diagnose({test::synthetic_effort_log(request)}, {});
}

auto names_of(const Diagnosis& d) -> std::vector<std::string> {
  std::vector<std::string> names;
  for (const auto& effect : d.effects) {
    names.push_back(effect.name);
  }
  std::sort(names.begin(), names.end());
  return names;
}

auto coefficient_of(const Diagnosis& d, const std::string& term, std::size_t i = 0) -> double {
  return d.law.parameters.coefficients[d.law.catalogue->term(term).first_coefficient + i];
}

auto shape_of(const Diagnosis& d, const std::string& term) -> double {
  return d.law.parameters.shapes[d.law.catalogue->term(term).first_shape];
}

void expect_named(const Diagnosis& d, const std::vector<std::string>& names) {
  EXPECT_EQ(d.verdict, Verdict::kEffect) << d.reason;
  EXPECT_EQ(names_of(d), names) << d.reason;
  EXPECT_LT(d.ratio_ci95[1], 1.0);
  EXPECT_LT(d.after.rmse, d.before.rmse);
  EXPECT_EQ(d.base_model, "rigid_dynamics");
  EXPECT_EQ(d.unit, "Nm");
}

TEST(DiagnoseEffort, NothingIsNamedWhereNothingIsMissing) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Diagnosis d = diagnosis_of(EffortTruth::kNone, seed);
    EXPECT_EQ(d.verdict, Verdict::kNothingMissing) << d.reason;
    EXPECT_TRUE(d.effects.empty());
    EXPECT_NEAR(coefficient_of(d, "inertia"), 0.03, 0.001);
    EXPECT_NEAR(coefficient_of(d, "viscous_friction"), 0.05, 0.002);
  }
}

/// Friction that turns with the speed, a weight and an offset, in a motion of four cycles of 15 s, with noise of 2 mNm.
auto textbook_log(double offset, double weight) -> AxisLog {
  constexpr Eigen::Index kRows = 12000;
  constexpr double kTones[4][3] = {{0.9, 2.0, 0.0}, {0.5, 3.0, 1.0}, {0.4, 5.0, 2.0}, {0.1, 11.0, 0.0}};
  AxisLog log;
  log.name = "textbook.csv";
  log.target = "axis0/tau_Nm";
  log.period_s = 0.005;
  log.time_s = log.q1_rad = log.effort = log.tau_nm = Eigen::VectorXd::Zero(kRows);
  Random random(7);
  for (Eigen::Index i = 0; i < kRows; ++i) {
    const double t = log.period_s * static_cast<double>(i);
    double angle = 0.0, speed = 0.0, acceleration = 0.0;
    for (const auto& [size, harmonic, phase] : kTones) {
      const double rate = harmonic * 2.0 * 3.14159265358979 / 15.0;
      angle += size * std::sin(rate * t + phase);
      speed += size * rate * std::cos(rate * t + phase);
      acceleration -= size * rate * rate * std::sin(rate * t + phase);
    }
    log.time_s[i] = t;
    log.q1_rad[i] = 1e-5 * std::round(1e5 * angle);
    log.effort[i] = 2e-3 * acceleration + 0.01 * speed + std::copysign(0.05, speed) + offset +
                    weight * std::sin(angle) + 2e-3 * random.normal();
  }
  return log;
}

// Seen through 0.12 s a law that is grown leaves less than the named one through its own view of 15 ms, where the noise
// is larger; and beside friction a spring explains more than the weight as long as the offset is missing.
TEST(DiagnoseEffort, TextbookFrictionWeightAndOffsetAreNamedWithTheirSizes) {
  for (const auto& [offset, weight] : {std::pair{0.0, 0.0}, {0.02, 0.1}}) {
    const Diagnosis d = diagnose({textbook_log(offset, weight)}, {});
    EXPECT_EQ(d.verdict, Verdict::kEffect) << d.reason;
    EXPECT_EQ(d.law.status, LawStatus::kConfirmed);
    const std::vector<std::string> all = {"coulomb_friction", "gravity", "offset"};
    EXPECT_EQ(names_of(d), weight > 0.0 ? all : std::vector<std::string>{"coulomb_friction"}) << d.reason;
    EXPECT_NEAR(coefficient_of(d, "inertia"), 2e-3, 1e-4);
    EXPECT_NEAR(coefficient_of(d, "viscous_friction"), 0.01, 3e-4);
    EXPECT_NEAR(coefficient_of(d, "coulomb_friction"), 0.05, 5e-4);
    EXPECT_NEAR(weight > 0.0 ? coefficient_of(d, "gravity") : 0.0, weight, 1e-3);
    EXPECT_NEAR(offset > 0.0 ? coefficient_of(d, "offset") : 0.0, offset, 1e-3);
  }
}

TEST(DiagnoseEffort, CoulombFriction) {
  const Diagnosis d = diagnosis_of(EffortTruth::kCoulomb);
  expect_named(d, {"coulomb_friction"});
  EXPECT_NEAR(coefficient_of(d, "coulomb_friction"), 0.05, 0.002);
}

TEST(DiagnoseEffort, FrictionAsymmetryBesideCoulombs) {
  const Diagnosis d = diagnosis_of(EffortTruth::kAsymmetry);
  expect_named(d, {"coulomb_friction", "friction_asymmetry"});
  EXPECT_EQ(d.effects.front().name, "coulomb_friction");
  EXPECT_NEAR(coefficient_of(d, "friction_asymmetry", 0), 0.02, 0.003);
  EXPECT_NEAR(coefficient_of(d, "friction_asymmetry", 1), 0.03, 0.004);
}

TEST(DiagnoseEffort, StribeckBesideCoulombs) {
  const Diagnosis d = diagnosis_of(EffortTruth::kStribeck);
  expect_named(d, {"coulomb_friction", "stribeck_friction"});
  EXPECT_NEAR(shape_of(d, "stribeck_friction"), 0.25, 0.06);
}

TEST(DiagnoseEffort, FrictionBehindASlackAndBehindABristleIsPlayFriction) {
  const Diagnosis slack = diagnosis_of(EffortTruth::kSlack);
  expect_named(slack, {"play_friction"});
  EXPECT_NEAR(shape_of(slack, "play_friction"), 0.06, 0.01);
  EXPECT_NEAR(coefficient_of(slack, "play_friction", 1), 0.05, 0.01);
  expect_named(diagnosis_of(EffortTruth::kBristle), {"play_friction"});
}

TEST(DiagnoseEffort, Offset) {
  const Diagnosis d = diagnosis_of(EffortTruth::kOffset);
  expect_named(d, {"offset"});
  EXPECT_NEAR(coefficient_of(d, "offset"), 0.03, 0.002);
}

TEST(DiagnoseEffort, Gravity) {
  const Diagnosis d = diagnosis_of(EffortTruth::kGravity);
  expect_named(d, {"gravity"});
  EXPECT_NEAR(coefficient_of(d, "gravity", 0), 0.04, 0.003);
  EXPECT_NEAR(coefficient_of(d, "gravity", 1), -0.02, 0.003);
}

// Its drag at top speed is that of what was made up: 0.03 q1' |q1'|.
TEST(DiagnoseEffort, DragByThePowerOfTheSpeed) {
  const Diagnosis d = diagnosis_of(EffortTruth::kQuadraticDrag);
  expect_named(d, {"power_law_friction"});
  EXPECT_NEAR(shape_of(d, "power_law_friction"), 2.0, 0.1);
  const double speed = d.law.parameters.shapes[d.law.catalogue->term("power_law_friction").first_shape + 1];
  EXPECT_NEAR(coefficient_of(d, "power_law_friction"), 0.03 * speed * speed, 0.003 * speed * speed);
}

// Of 0.006 q1^3, from one middle of the motion or the other.
TEST(DiagnoseEffort, ASpringThatHardens) {
  const Diagnosis d = diagnosis_of(EffortTruth::kHardSpring);
  expect_named(d, {"spring"});
  const std::size_t centre = d.law.catalogue->term("spring").first_shape;
  const double span = d.law.parameters.shapes[centre + 1];
  EXPECT_NEAR(coefficient_of(d, "spring", 1), 0.006 * std::pow(span, 3), 0.0006 * std::pow(span, 3));
}

/// A motion over 3.4 rad whose effort has a weight, or pulls back to a rest, and maybe friction that goes with it.
auto loaded_log(auto&& load) -> AxisLog {
  EffortRequest request;
  AxisLog log = test::synthetic_effort_log(request);
  for (Eigen::Index i = 0; i < log.samples(); ++i) {
    const Eigen::Index before = std::max<Eigen::Index>(i - 1, 0);
    const Eigen::Index behind = std::min(i + 1, log.samples() - 1);
    log.effort[i] += load(log.q1_rad[i], log.q1_rad[behind] >= log.q1_rad[before] ? 1.0 : -1.0);
  }
  return log;
}

TEST(DiagnoseEffort, ASpringKnowsItsRestBesideTheMiddleOfTheMotion) {
  const Diagnosis linear = diagnose({loaded_log([](double q, double) { return 0.04 * (q - 0.6); })}, {});
  expect_named(linear, {"spring"});
  EXPECT_TRUE(linear.law.has("offset")) << "where it rests";
  const Diagnosis hard =
      diagnose({loaded_log([](double q, double) { return 0.04 * (q - 0.6) + 0.02 * std::pow(q - 0.6, 3); })}, {});
  expect_named(hard, {"spring"});
  EXPECT_NEAR(shape_of(hard, "spring"), 0.6, 0.1);
}

TEST(DiagnoseEffort, FrictionWithTheWeightThatIsCarried) {
  const Diagnosis d = diagnose({loaded_log([](double q, double side) {
                                 const double weight = std::sin(q - 0.4);
                                 return 0.08 * weight + 0.03 * side * std::abs(weight);
                               })},
                               {});
  expect_named(d, {"gravity", "load_friction"});
  EXPECT_NEAR(coefficient_of(d, "load_friction"), 0.03, 0.003);
  EXPECT_NEAR(shape_of(d, "load_friction"), 0.4, 0.05);
  ASSERT_TRUE(d.effort_law);
  EXPECT_TRUE(d.effort_law->joint.has("load_friction")) << "a board runs it";
}

TEST(DiagnoseEffort, Ripple) {
  const Diagnosis d = diagnosis_of(EffortTruth::kRipple);
  expect_named(d, {"angle_periodic"});
  EXPECT_NEAR(shape_of(d, "angle_periodic"), 9.0, 0.1);
}

TEST(DiagnoseEffort, ALateEffortSensor) {
  const Diagnosis d = diagnosis_of(EffortTruth::kDelay);
  expect_named(d, {"transport_delay"});
  EXPECT_NEAR(shape_of(d, "transport_delay"), 0.014, 0.002);
}

// Seen for two of its time constants, warming is named or said to be unknown, and never called anything else. An offset
// is part of it: the effort begins away from where it ends.
TEST(DiagnoseEffort, WarmingUpIsNamedOrUnknown) {
  int named = 0;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const Diagnosis d = diagnosis_of(EffortTruth::kWarmUp, seed);
    for (const auto& name : names_of(d)) {
      EXPECT_TRUE(name == "thermal_drift" || name == "offset") << d.reason;
      named += name == "thermal_drift" ? 1 : 0;
    }
    EXPECT_TRUE(d.verdict == Verdict::kEffect || d.verdict == Verdict::kUnknown) << d.reason;
  }
  EXPECT_GE(named, 1);
}

class UnlistedEffort : public testing::TestWithParam<EffortTruth> {};

TEST_P(UnlistedEffort, IsNeverGivenAName) {
  constexpr std::uint64_t kSeeds = 8;  // more of them: tools/blind_benchmark --family effort
  std::size_t seen = 0;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const Diagnosis d = diagnosis_of(GetParam(), seed);
    const bool honest = d.verdict == Verdict::kUnknown || d.verdict == Verdict::kEffectPlusUnlisted;
    EXPECT_TRUE(honest) << test::truth_name(GetParam()) << " seed " << seed << ": " << d.reason;
    EXPECT_TRUE(d.effects.empty()) << test::truth_name(GetParam()) << " seed " << seed << ": " << d.reason;
    seen += honest ? 1 : 0;
  }
  EXPECT_EQ(seen, kSeeds);
}

INSTANTIATE_TEST_SUITE_P(Two, UnlistedEffort, testing::Values(EffortTruth::kStickySpot, EffortTruth::kRelaxation));

// Inertia and drag can not be negative, so the law is nought, and a delay of it changes nothing.
TEST(DiagnoseEffort, AnEffortLoggedWithTheWrongSignIsGivenNoName) {
  AxisLog log = test::synthetic_effort_log({});
  log.effort = -log.effort;
  const Diagnosis d = diagnose({log}, {});
  EXPECT_TRUE(is_refusal(d.verdict)) << d.reason;
  EXPECT_TRUE(d.effects.empty());
}

TEST(DiagnoseEffort, BasesOfTheOtherFamilyAreBadInput) {
  DiagnoseOptions options;
  options.base_model = "pseudo_kinematic";
  EXPECT_THROW(diagnose({test::synthetic_effort_log({})}, options), BadInput);
}

auto error_over(const EffortLaw& law, const AxisLog& log) -> double {
  return rms(EffortDesign({log}, law.view).seen(log.effort) - run_effort_law({log}, law));
}

TEST(DeliveredEffortLaw, OfWhatHasNoNameIsOneLawInFileJsonAndErrors) {
  EffortRequest request;
  request.truth = EffortTruth::kRelaxation;
  const AxisLog log = test::synthetic_effort_log(request);
  DiagnoseOptions options;
  options.test_logs = {log};
  const Diagnosis d = diagnose({log}, options);
  ASSERT_TRUE(d.effort_law.has_value());
  EXPECT_EQ(d.law.status, LawStatus::kProvisional);
  EXPECT_EQ(d.effort_law->status, "provisional");
  EXPECT_EQ(d.effort_law->joint.terms, d.law.terms);
  EXPECT_EQ(d.effort_law->joint.parameters.coefficients, d.law.parameters.coefficients);
  EXPECT_EQ(d.base.terms, (std::vector<std::string>{"inertia", "viscous_friction"}));
  EXPECT_LT(d.after.rmse, 0.8 * d.before.rmse);
  EXPECT_LT(d.ratio_ci95[1], 1.0);
  ASSERT_TRUE(d.unnamed.has_value());
  EXPECT_NEAR(error_over(*d.effort_law, log), d.after.rmse, 0.5 * d.after.rmse);
  ASSERT_EQ(d.tested.size(), 1U);
  EXPECT_NEAR(d.tested[0].after.rmse, error_over(*d.effort_law, log), 1e-9);
  const auto json = nlohmann::json::parse(diagnosis_json(d));
  EXPECT_EQ(json["law"]["status"], "provisional");
  EXPECT_EQ(json["law"]["terms"].get<std::vector<std::string>>(), d.law.terms);
  EXPECT_EQ(json["after"]["rmse"].get<double>(), d.after.rmse);
  EXPECT_EQ(json["before"]["rmse"].get<double>(), d.before.rmse);
}

TEST(DeliveredEffortLaw, OfNamedEffectsIsTheNamedLawInAFormThatRuns) {
  for (const EffortTruth truth : {EffortTruth::kCoulomb, EffortTruth::kDelay}) {
    EffortRequest request;
    request.truth = truth;
    const AxisLog log = test::synthetic_effort_log(request);
    const Diagnosis d = diagnose({log}, {});
    ASSERT_EQ(d.verdict, Verdict::kEffect) << d.reason;
    ASSERT_TRUE(d.effort_law.has_value());
    EXPECT_TRUE(d.effort_law->joint.has(d.effects.front().name));
    EXPECT_EQ(d.effort_law->joint.terms.size(), d.law.terms.size());
    EXPECT_LT(error_over(*d.effort_law, log), 0.5 * d.before.rmse);
    const EffortLaw read = parse_effort_file(effort_file_text(*d.effort_law), "law.toml");
    EXPECT_NEAR(error_over(read, log), error_over(*d.effort_law, log), 1e-6);
  }
}

// An effect's law, a base law and one without names alike: what --test says is what a replay of the file leaves.
TEST(DeliveredEffortLaw, IsJudgedOnAnotherLogAsItsFileRuns) {
  for (const EffortTruth truth :
       {EffortTruth::kNone, EffortTruth::kGravity, EffortTruth::kHardSpring, EffortTruth::kRelaxation}) {
    EffortRequest request;
    request.truth = truth;
    const AxisLog log = test::synthetic_effort_log(request);
    request.seed = 2;
    DiagnoseOptions options;
    options.test_logs = {test::synthetic_effort_log(request)};
    const Diagnosis d = diagnose({log}, options);
    ASSERT_TRUE(d.effort_law.has_value());
    ASSERT_EQ(d.tested.size(), 1U);
    EXPECT_NEAR(d.tested[0].after.rmse, error_over(*d.effort_law, options.test_logs[0]), 1e-9) << d.reason;
    EffortLaw base = runnable_law(d.base, {log});
    base.view = d.effort_law->view;
    EXPECT_NEAR(d.tested[0].before.rmse, error_over(base, options.test_logs[0]), 1e-9) << d.reason;
  }
}

TEST(DeliveredEffortLaw, HoldsWhateverIsToldAsAName) {
  EffortRequest request;
  request.truth = EffortTruth::kGravity;
  AxisLog log = test::synthetic_effort_log(request);
  Diagnosis d = diagnose({log}, {});
  ASSERT_EQ(names_of(d), (std::vector<std::string>{"gravity"}));
  log.effort.array() += 0.2 * log.q1_rad.array().cube();
  d.after.rmse = 2.0 * d.noise_floor;
  d.effects.front().name = "thermal_drift";  // which the grown law explains by what it really is
  deliver_effort_law({log}, d);
  EXPECT_EQ(d.verdict, Verdict::kUnknown);
  EXPECT_TRUE(d.effects.empty());
  EXPECT_NE(d.reason.find("by other terms than thermal_drift, so it is not named"), std::string::npos) << d.reason;
}

TEST(DeliveredEffortLaw, IsNotSaidToLackWhatItHolds) {
  Diagnosis d = diagnosis_of(EffortTruth::kQuadraticDrag);
  ASSERT_TRUE(d.effort_law && d.effort_law->joint.has("power_law_friction"));
  const auto said = [&d](const std::string& unlisted) {
    d.unlisted = unlisted;
    d.reason = reason_without_name(unlisted);
    d.next_experiment = "Ask again.";
    say_what_is_held(d);
    return d.reason;
  };
  EXPECT_NE(
      said("shear_thinning").find("most like shear_thinning, which the delivered law holds as power_law_friction."),
      std::string::npos);
  EXPECT_NE(said("wear").find("most like wear, which this version can not add."), std::string::npos);
  EXPECT_NE(said("axis1/q1_rad").find("can not add"), std::string::npos);
  EXPECT_EQ(d.next_experiment, "Ask again.");
  d.effort_law->joint.terms.emplace_back("axis_coupling_axis1");
  EXPECT_NE(said("axis1/q1_rad").find("the delivered law holds as axis_coupling."), std::string::npos);
  EXPECT_NE(d.next_experiment, "Ask again.") << "that axis is asked already";
  d.reason = "Another reason.";
  say_what_is_held(d);
  EXPECT_EQ(d.reason, "Another reason.");
}

TEST(DeliveredEffortLaw, OfNamesThatLeaveMuchIsTheGrownLaw) {
  EffortRequest request;
  request.truth = EffortTruth::kGravity;
  AxisLog log = test::synthetic_effort_log(request);
  const Diagnosis complete = diagnose({log}, {});
  ASSERT_EQ(complete.verdict, Verdict::kEffect) << complete.reason;
  EXPECT_EQ(complete.effort_law->status, "confirmed");
  log.effort.array() += 0.2 * log.q1_rad.array().cube();  // the names stay as they were found, and leave this
  Diagnosis d = complete;
  deliver_effort_law({log}, d);
  EXPECT_EQ(d.effort_law->status, "confirmed");  // what it left was noise, it said
  d.after.rmse = 2.0 * d.noise_floor;
  deliver_effort_law({log}, d);
  EXPECT_EQ(d.verdict, Verdict::kEffectPlusUnlisted);
  EXPECT_EQ(names_of(d), (std::vector<std::string>{"gravity"}));
  EXPECT_NE(d.reason.find("The law lacks gravity; a law with more"), std::string::npos) << d.reason;
  EXPECT_EQ(d.effort_law->status, "provisional");
  EXPECT_EQ(d.law.terms, d.effort_law->joint.terms);
  EXPECT_LT(error_over(*d.effort_law, log), 0.5 * error_over(runnable_law(complete.law, {log}), log));
}

// The law that runs sees what the other axis does as the search saw it.
TEST(DeliveredEffortLaw, OfACouplingHoldsTheOtherAxis) {
  EffortRequest request;
  AxisLog log = test::synthetic_effort_log(request);
  request.seed = 4;
  OtherAxis other{1, test::synthetic_effort_log(request).q1_rad, Eigen::VectorXd::Zero(log.samples())};
  const Eigen::Index inner = log.samples() - 2;
  log.effort += 0.02 * other.q1_rad;
  log.effort.segment(1, inner) += 0.01 / (2.0 * log.period_s) * (other.q1_rad.tail(inner) - other.q1_rad.head(inner));
  log.others = {other};
  log.side = {{"axis1/q1_rad", other.q1_rad}};
  const Diagnosis d = diagnose({log}, {});
  expect_named(d, {"axis_coupling"});
  EXPECT_EQ(d.law.status, LawStatus::kConfirmed);
  EXPECT_NEAR(coefficient_of(d, "axis_coupling", 0), 0.02, 0.002);
  EXPECT_NEAR(coefficient_of(d, "axis_coupling", 3), 0.01, 0.001);
  EXPECT_LT(error_over(*d.effort_law, log), 0.3 * d.before.rmse);  // all of it where the other axis is not seen
}

TEST(DeliveredEffortLaw, WithoutMotionOrWithAFewRowsThereIsNone) {
  AxisLog log = test::synthetic_effort_log({});
  EXPECT_TRUE(can_select_effort_law({log}));
  AxisLog still = log;
  still.q1_rad.setConstant(0.3);
  EXPECT_FALSE(can_select_effort_law({still}));
  for_each_signal(
      log, [](Eigen::VectorXd& signal) { signal.conservativeResize(std::min<Eigen::Index>(signal.size(), 100)); });
  EXPECT_FALSE(can_select_effort_law({log}));
}

TEST(DiagnoseEffort, InertiaAloneIsABaseToo) {
  const std::vector<AxisLog> logs = {test::synthetic_effort_log({})};
  EXPECT_EQ(form_of_model("inertia", logs).terms, (std::vector<std::string>{"inertia"}));
  DiagnoseOptions options;
  options.base_model = "inertia";
  const Diagnosis d = diagnose(logs, options);
  EXPECT_EQ(d.base.terms, (std::vector<std::string>{"inertia"}));
  EXPECT_EQ(names_of(d), (std::vector<std::string>{"viscous_friction"})) << d.reason;
  EXPECT_LT(d.after.rmse, 0.5 * d.before.rmse);
}

TEST(IdentifyEffort, RecoversInertiaAndDragWithUnits) {
  const std::vector<AxisLog> logs = {test::synthetic_effort_log({})};
  const Identification result = identify(logs, form_of_model("rigid_dynamics", logs));
  const Catalogue& catalogue = *result.joint.catalogue;
  EXPECT_NEAR(result.joint.parameters.coefficients[catalogue.term("inertia").first_coefficient], 0.03, 0.0005);
  EXPECT_NEAR(result.joint.parameters.coefficients[catalogue.term("viscous_friction").first_coefficient], 0.05, 0.001);
  EXPECT_STREQ(catalogue.term("inertia").coefficients[0].unit, "kgm2");
  EXPECT_TRUE(result.undetermined.empty());
  EXPECT_FALSE(result.joint.steady_torque.has_value());
  EXPECT_THROW(motion_parameters(result.joint), Refusal);
}

}  // namespace
}  // namespace capstan::tools
