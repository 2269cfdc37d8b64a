// SPDX-License-Identifier: Apache-2.0
// Laws of efforts as a diagnosis delivers them.
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "capstan/tests/tools/diagnose/effort_diagnosis.hpp"
#include "capstan/tests/tools/synthetic_effort.hpp"
#include "capstan/tools/diagnose/diagnosis.hpp"
#include "capstan/tools/diagnose/effort_delivery.hpp"
#include "capstan/tools/diagnose/held_terms.hpp"
#include "capstan/tools/diagnose/verdict.hpp"
#include "capstan/tools/joint_file/effort_file.hpp"
#include "capstan/tools/support/statistics.hpp"

namespace capstan::tools {
namespace {

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

}  // namespace
}  // namespace capstan::tools
