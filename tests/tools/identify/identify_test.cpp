// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/identify/identify.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "capstan/tests/tools/synthetic_joint.hpp"
#include "capstan/tools/identify/settled.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/statistics.hpp"

namespace capstan::tools {
namespace {

using test::Motion;
using test::SyntheticRequest;
using test::Truth;

auto form_of(const std::string& model) -> LawForm {
  LawForm form;
  form.terms = terms_of_model(model);
  return form;
}

TEST(Identify, RecoversTheRatioTheOffsetAndBothElongations) {
  SyntheticRequest request;
  request.counts_per_turn = 4e6;  // so that the causal switch is not late
  request.cycles = 2;
  const Identification result = identify({test::synthetic_log(request)}, form_of("pseudo_kinematic"));
  const auto& c = result.joint.parameters.coefficients;
  EXPECT_NEAR(c[catalogue_term("motor_angle").first_coefficient], 1.08, 0.002);
  EXPECT_NEAR(c[catalogue_term("joint_offset").first_coefficient], 0.03, 0.001);
  EXPECT_NEAR(c[catalogue_term("tendon_elongation").first_coefficient], -0.9, 0.03);
  EXPECT_NEAR(c[catalogue_term("tendon_elongation").first_coefficient + 1], -0.6, 0.03);
  EXPECT_TRUE(result.undetermined.empty());
  EXPECT_LT(result.joint.fit->rmse, 0.0013);
}

/// Adds motors that pull at the joint by (6.8), each with its own motion, and says so in the log.
void couple(AxisLog& log, std::size_t others) {
  for (std::size_t slot = 0; slot < others; ++slot) {
    const double n = static_cast<double>(slot + 1);
    OtherAxis other{static_cast<int>(slot) + 1, Eigen::VectorXd(log.samples()), Eigen::VectorXd(log.samples())};
    for (Eigen::Index i = 0; i < log.samples(); ++i) {
      const double phase = 2.0 * std::numbers::pi * (0.13 + 0.071 * n) * log.time_s[i];
      const bool forward = std::cos(phase) >= 0.0;
      other.q1_rad[i] = 1.5 * std::sin(phase);
      other.tau_nm[i] = 0.02 * std::sin(2.7 * phase + n) + (forward ? 0.03 : -0.03);
      log.q2_rad[i] += 0.1 * n * other.q1_rad[i] + (forward ? -0.2 : 0.3) * n * other.tau_nm[i];
    }
    log.others.push_back(std::move(other));
  }
  log.others_asked = others;
}

TEST(Identify, ARowOfTheCoupledLawHasATermForEachJointThatWasAskedFor) {
  AxisLog log = test::synthetic_log({});
  couple(log, 3);
  const LawForm form = form_of_model("multi_dof", {log});
  const Identification result = identify({log}, form);
  EXPECT_TRUE(result.undetermined.empty());
  double n = 0.0;
  for (const char* term : {"axis_coupling", "axis_coupling_2", "axis_coupling_3"}) {
    n += 1.0;
    ASSERT_TRUE(result.joint.has(term)) << term;
    const std::size_t at = catalogue_term(term).first_coefficient;
    const auto& c = result.joint.parameters.coefficients;
    EXPECT_NEAR(c[at], 0.1 * n, 0.003) << term;
    EXPECT_NEAR(c[at + 1], -0.2 * n, 0.03 * n) << term;
    EXPECT_NEAR(c[at + 2], 0.3 * n, 0.03 * n) << term;
  }
  EXPECT_EQ(result.joint.coupled_to, (std::vector<int>{1, 2, 3}));
  log.others_asked = 0;  // of those that merely move, the first is taken
  EXPECT_FALSE(form_of_model("multi_dof", {log}).has("axis_coupling_2"));
}

TEST(Identify, TheReportedErrorIsThatOfTheCausalLawFromWhereTheJointHasSettled) {
  const std::vector<AxisLog> logs = {test::synthetic_log({})};
  const Identification result = identify(logs, form_of("pseudo_kinematic"));
  const Eigen::VectorXd& measured = logs[0].q2_rad;
  const Eigen::VectorXd estimate = simulate(logs, motion_parameters(result.joint));
  const Eigen::Index rows = measured.size() - settled_rows(logs[0].q1_rad, {{0, measured.size()}})[0].begin;
  EXPECT_LT(rows, measured.size());
  EXPECT_EQ(result.joint.fit->samples, rows);
  EXPECT_DOUBLE_EQ(result.joint.fit->rmse, rms(measured.tail(rows) - estimate.tail(rows)));
  EXPECT_DOUBLE_EQ(result.joint.fit->gof_percent, goodness_of_fit_percent(measured.tail(rows), estimate.tail(rows)));
}

TEST(Identify, ElongationsAreUndeterminedWithoutTorqueAndNamed) {
  AxisLog log = test::synthetic_log({});
  log.tau_nm.setZero();
  const Identification result = identify({log}, form_of("pseudo_kinematic"));
  EXPECT_EQ(result.undetermined, (std::vector<std::string>{"tendon_elongation.top", "tendon_elongation.bottom"}));
}

TEST(Identify, ColumnsThatCopyEachOtherAreUndetermined) {
  AxisLog log = test::synthetic_log({});
  // Torque that follows the angle exactly in both directions: the two elongations together copy the ratio.
  log.tau_nm = 0.02 * log.q1_rad;
  const Identification result = identify({log}, form_of("pseudo_kinematic"));
  EXPECT_EQ(result.undetermined.size(), 3U);
}

TEST(Identify, AForbiddenSignIsHeldAtZeroAndSaidSo) {
  AxisLog log = test::synthetic_log({});
  log.tau_nm = -log.tau_nm;
  const Identification result = identify({log}, form_of("pseudo_kinematic"));
  const std::size_t at = catalogue_term("tendon_elongation").first_coefficient;
  EXPECT_EQ(result.joint.parameters.coefficients[at], 0.0);
  const bool said = std::any_of(result.notes.begin(), result.notes.end(),
                                [](const auto& note) { return note.find("tau_Nm=COLUMN*-1") != std::string::npos; });
  EXPECT_TRUE(said);
}

/// Of the direction switch that the fit chooses, in counts of an encoder with 8192.
auto threshold_in_counts(const AxisLog& log, std::vector<std::string>& notes) -> double {
  const auto shape = choose_conditioner({log}, form_of("pseudo_kinematic"), notes);
  return shape.direction_threshold_rad / (2.0 * std::numbers::pi / 8192.0);
}

auto log_of_a_coarse_encoder() -> AxisLog {
  SyntheticRequest request;
  request.counts_per_turn = 8192.0;
  return test::synthetic_log(request);
}

TEST(Identify, OneCountBackIsATurnWhereTheEncoderWasNotSeenToTremble) {
  std::vector<std::string> notes;
  const double counts = threshold_in_counts(log_of_a_coarse_encoder(), notes);
  EXPECT_GT(counts, 0.5);
  EXPECT_LT(counts, 1.0);
  EXPECT_NE(notes.at(0).find("direction threshold"), std::string::npos);
  EXPECT_NE(notes.at(0).find("the encoder showed no jitter"), std::string::npos) << notes.at(0);
}

TEST(Identify, OneCountBackIsNoTurnWhereTheEncoderTrembledOnce) {
  AxisLog log = log_of_a_coarse_encoder();
  Eigen::Index at = 2000;
  while (log.q1_rad.segment(at - 5, 11).maxCoeff() > log.q1_rad.segment(at - 5, 11).minCoeff()) {
    ++at;  // to where it rests
  }
  log.q1_rad[at] += 2.0 * std::numbers::pi / 8192.0;
  log.q1_rad[at + 2] -= 2.0 * std::numbers::pi / 8192.0;
  std::vector<std::string> notes;
  const double counts = threshold_in_counts(log, notes);
  EXPECT_GT(counts, 1.0);
  EXPECT_LT(counts, 50.0);
}

TEST(Identify, OneCountBackIsNoTurnWhereTooFewEdgesWereCrossedSlowlyToKnow) {
  AxisLog log = log_of_a_coarse_encoder();
  for_each_signal(log, [](auto& signal) {  // a twentieth of the rate: then the motor leaps over most counts
    const Eigen::VectorXd all = signal;
    signal = all(Eigen::seq(0, Eigen::last, 20));
  });
  log.period_s *= 20.0;
  std::vector<std::string> notes;
  EXPECT_GT(threshold_in_counts(log, notes), 1.0);
}

TEST(Identify, AForceLawIsOneTermAndUnknownModelsAreBadInput) {
  EXPECT_EQ(terms_of_model("preisach"), std::vector<std::string>{"preisach"});
  EXPECT_THROW(terms_of_model("nonsense"), BadInput);
  try {
    terms_of_model("dynamic");
  } catch (const Refusal& refusal) {
    EXPECT_NE(std::string(refusal.what()).find("kinematic, pseudo_kinematic and rigid_dynamics"), std::string::npos);
  }
}

TEST(RefineShapes, FindsAWidthFromANeighbourOfIt) {
  SyntheticRequest request;
  request.truth = Truth::kPlay;
  request.strength = 2.0;
  request.counts_per_turn = 4e6;
  const std::vector<AxisLog> logs = {test::synthetic_log(request)};
  LawForm form = form_of("pseudo_kinematic");
  form.terms.push_back("play");
  form.set_shapes(catalogue_term("play"), {0.024});
  const LawDesign design(logs, ConditionerShape<double>{});
  const LawForm refined = refine_shapes(design, stacked_target(logs), even_blocks(design.log_rows(), 10), form);
  EXPECT_NEAR(refined.shapes_of(catalogue_term("play"))[0], 0.016, 0.0006);
}

}  // namespace
}  // namespace capstan::tools
