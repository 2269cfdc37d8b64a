// SPDX-License-Identifier: Apache-2.0
// Diagnoses of made-up axes whose target is an effort.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "capstan/tests/tools/diagnose/effort_diagnosis.hpp"
#include "capstan/tests/tools/synthetic_effort.hpp"
#include "capstan/tools/diagnose/diagnosis.hpp"
#include "capstan/tools/identify/identify.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/random.hpp"

namespace capstan::tools {
namespace {

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
