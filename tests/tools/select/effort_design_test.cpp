// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/select/effort_design.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "capstan/tools/select/effort_catalogue.hpp"

namespace capstan::tools {
namespace {

constexpr Eigen::Index kRows = 400;
constexpr double kPeriodS = 0.01;

/// q = sin 3 t, torque a ramp of 1 per second.
auto sine_log() -> AxisLog {
  AxisLog log;
  log.period_s = kPeriodS;
  const Eigen::ArrayXd t = Eigen::ArrayXd::LinSpaced(kRows, 0.0, kPeriodS * (kRows - 1));
  log.time_s = t.matrix();
  log.q1_rad = (3.0 * t).sin().matrix();
  log.tau_nm = t.matrix();
  log.effort = Eigen::VectorXd::Zero(kRows);
  return log;
}

constexpr EffortView kView = {.window_s = 0.05, .standstill = 0.1};

TEST(EffortDesign, MotionIsThatOfTheLocalCubic) {
  const EffortDesign design({sine_log()}, kView);
  for (const std::size_t i : {std::size_t{50}, std::size_t{123}, std::size_t{300}}) {
    const double t = kPeriodS * static_cast<double>(i);
    const auto& sample = design.samples()[0][i];
    EXPECT_NEAR(sample.q1, std::sin(3.0 * t), 1e-6);
    EXPECT_NEAR(sample.dq1, 3.0 * std::cos(3.0 * t), 1e-3);
    EXPECT_NEAR(sample.ddq1, -9e-3 * std::sin(3.0 * t), 1e-4);  // krad/s2
    EXPECT_EQ(sample.tau, t);
    EXPECT_EQ(sample.warmth, 0.0);
  }
}

TEST(EffortDesign, TheDirectionStaysAtAStandstill) {
  const EffortDesign design({sine_log()}, kView);
  // cos 3 t passes from positive to negative at t = pi / 6; the speed is below 0.1 for 0.011 s to either side.
  const auto forward_at = [&](double t) { return design.samples()[0][static_cast<std::size_t>(t / kPeriodS)].forward; };
  EXPECT_TRUE(forward_at(0.3));
  EXPECT_TRUE(forward_at(0.53));
  EXPECT_FALSE(forward_at(0.6));
  EXPECT_FALSE(forward_at(1.5));
  EXPECT_TRUE(forward_at(1.7));
}

TEST(EffortDesign, AMotorThatStandsHasNoSpeedNotEvenARoundedOne) {
  AxisLog log = sine_log();
  log.q1_rad.tail(200).setConstant(-0.5121 * (1.0 + 1e-6));
  const EffortDesign design({log}, kView);
  for (std::size_t i = 210; i < 400; ++i) {  // a window beyond the first
    const auto& sample = design.samples()[0][i];
    ASSERT_EQ(sample.dq1, 0.0) << "drag that grows with a small power of the speed would be large at " << i;
    ASSERT_EQ(sample.ddq1, 0.0);
    ASSERT_EQ(sample.q1, log.q1_rad[399]);
  }
}

TEST(EffortDesign, DryFrictionLetsGoAtAStandstillWhereTheViewSaysSo) {
  AxisLog log = sine_log();
  log.q1_rad.tail(200).setConstant(log.q1_rad[199]);
  EffortView view = kView;
  EXPECT_EQ(EffortDesign({log}, view).samples()[0].back().grip, 1.0);
  view.letting_go_s = 0.1;
  const EffortDesign lets_go({log}, view);
  EXPECT_LT(lets_go.samples()[0].back().grip, 0.01);
  EXPECT_EQ(lets_go.samples()[0][100].grip, 1.0);
}

TEST(EffortDesign, ATorqueThatIsLateIsMovedBetweenSamplesAndHeldAtTheEnds) {
  EffortView view = kView;
  view.skew_s = 0.025;  // two samples and a half
  const Samples later = EffortDesign({sine_log()}, view).samples()[0];
  EXPECT_NEAR(later[100].tau, 1.0 - 0.025, 1e-12);
  EXPECT_EQ(later[1].tau, 0.0);
  view.skew_s = -0.025;
  const Samples earlier = EffortDesign({sine_log()}, view).samples()[0];
  EXPECT_NEAR(earlier[100].tau, 1.0 + 0.025, 1e-12);
  EXPECT_NEAR(earlier.back().tau, kPeriodS * (kRows - 1), 1e-12);
}

TEST(EffortDesign, WarmthIsWhatIsBeyond25Degrees) {
  AxisLog log = sine_log();
  log.temperature_c = Eigen::VectorXd::Constant(kRows, 31.0);
  EXPECT_NEAR(EffortDesign({log}, kView).samples()[0][7].warmth, 6.0, 1e-12);
}

TEST(EffortDesign, KnowsTheAxesWhoseAnglesAllLogsHave) {
  AxisLog log = sine_log();
  const Eigen::VectorXd angle = log.q1_rad;
  for (const char* name : {"axis1/q1_rad", "axis7/q1_m", "axis2/q2_rad", "axis3", "temperature_C", "axis12/q1_rad"}) {
    log.side.push_back({name, angle});
  }
  const EffortDesign design({log}, kView);
  ASSERT_EQ(design.others().size(), 2u);  // of axis0 to axis7
  EXPECT_EQ(design.others()[0].axis, 1);
  EXPECT_FALSE(design.others()[0].linear);
  EXPECT_NEAR(design.others()[0].range, 2.0, 1e-3);
  EXPECT_EQ(design.others()[1].axis, 7);
  EXPECT_TRUE(design.others()[1].linear);
  AxisLog without = sine_log();
  without.side.push_back({"axis7/q1_m", angle});
  const EffortDesign of_both({log, without}, kView);
  ASSERT_EQ(of_both.others().size(), 1u);
  EXPECT_EQ(of_both.others()[0].axis, 7);
}

TEST(EffortDesign, AnAxisThatRestsInOneLogStandsThereAndMovesInTheOther) {
  AxisLog moves = sine_log();
  moves.side.push_back({"axis2/q1_rad", moves.q1_rad});
  moves.side.push_back({"axis3/q1_rad", Eigen::VectorXd::Constant(kRows, 0.3)});
  AxisLog rests = sine_log();
  rests.side.push_back({"axis2/q1_rad", Eigen::VectorXd::Constant(kRows, 0.3)});
  rests.side.push_back({"axis3/q1_rad", Eigen::VectorXd::Constant(kRows, 0.3)});
  const EffortDesign design({moves, rests}, kView);
  ASSERT_EQ(design.others().size(), 1u) << "axis 3 rests in both, so nothing is asked of it";
  EXPECT_EQ(design.others()[0].axis, 2);
  const Catalogue& catalogue = effort_law_catalogue(AxisKind::kRotary);
  const Eigen::MatrixXd coupling = design.columns(catalogue.term("axis_coupling_axis2"), {});
  EXPECT_GT(coupling.topRows(kRows).col(3).norm(), 0.0);
  const Eigen::MatrixXd at_rest = coupling.bottomRows(kRows).rowwise() - coupling.row(kRows);
  EXPECT_LT(at_rest.cwiseAbs().maxCoeff(), 1e-12) << "no speed, no acceleration and no direction that comes and goes";
  const Eigen::MatrixXd posture = design.columns(catalogue.term("posture_coupling_axis2"), {});
  EXPECT_NEAR(posture(kRows + 123, 12), std::cos(std::sin(3.69) + 0.3), 1e-3) << "at the angle where it stands";
}

TEST(EffortDesign, AnAxisThatTremblesInOneLogStandsByWhatItDoesInTheOthers) {
  AxisLog moves = sine_log();
  moves.side.push_back({"axis2/q1_rad", moves.q1_rad});
  AxisLog trembles = sine_log();
  Eigen::VectorXd count = Eigen::VectorXd::Zero(kRows);
  for (Eigen::Index i = 0; i < kRows; i += 40) {
    count[i] = 1e-4;
  }
  trembles.side.push_back({"axis2/q1_rad", count});
  const EffortDesign design({moves, trembles}, kView);
  constexpr Eigen::Index kDry = 2;  // goes with the direction
  const Eigen::VectorXd direction =
      design.columns(effort_law_catalogue(AxisKind::kRotary).term("axis_coupling_axis2"), {}).col(kDry);
  EXPECT_LT(direction.head(kRows).minCoeff(), direction.head(kRows).maxCoeff());
  EXPECT_EQ(direction.tail(kRows).minCoeff(), direction.tail(kRows).maxCoeff());
}

TEST(EffortDesign, AnotherAxissTermSeesThatAxisOrNothing) {
  AxisLog log = sine_log();
  log.side.push_back({"axis2/q1_rad", (2.0 * log.q1_rad.array()).matrix()});
  const EffortDesign design({log}, kView);
  const Catalogue& catalogue = effort_law_catalogue(AxisKind::kRotary);
  const Eigen::MatrixXd known = design.columns(catalogue.term("axis_coupling_axis2"), {});
  ASSERT_EQ(known.cols(), 4);
  // Acceleration in SI: -18 sin 3 t.
  EXPECT_NEAR(known(123, 3), -18.0 * std::sin(3.69), 0.1);
  EXPECT_EQ(design.columns(catalogue.term("axis_coupling_axis3"), {}).norm(), 0.0);  // at rest at its zero
}

TEST(EffortDesign, ATermOfTwoJointsSeesBothAtTheSameTime) {
  AxisLog log = sine_log();
  log.side.push_back({"axis2/q1_rad", (2.0 * log.time_s.array()).cos().matrix()});
  const EffortDesign design({log, log}, kView);
  const Catalogue& catalogue = effort_law_catalogue(AxisKind::kRotary);
  const Eigen::MatrixXd known = design.columns(catalogue.term("posture_coupling_axis2"), {});
  ASSERT_EQ(known.rows(), 2 * kRows);
  ASSERT_EQ(known.cols(), 16);
  const double t = 1.23;
  const double sum = std::sin(3.0 * t) + std::cos(2.0 * t);
  EXPECT_NEAR(known(123, 12), std::cos(sum), 1e-4);
  EXPECT_NEAR(known(123 + kRows, 13), std::sin(sum), 1e-4);
  EXPECT_EQ(design.columns(catalogue.term("posture_coupling_axis3"), {}).norm(), 0.0);
}

TEST(EffortDesign, EverySoManySamplesOfEachLogAreSeenAndAveragedWhereTheViewSaysSo) {
  const AxisLog log = sine_log();
  Eigen::VectorXd signal(2 * kRows);
  signal << log.tau_nm, -log.tau_nm;
  for (const bool averaged : {false, true}) {
    EffortView view = kView;
    view.averaged = averaged;
    const EffortDesign design({log, log}, view);
    EXPECT_EQ(design.rows(), 2 * kRows);
    const Eigen::VectorXd seen = design.seen(signal, 7);  // 0, 7, .. 399: 58 of each
    ASSERT_EQ(seen.size(), 2 * 58);
    EXPECT_NEAR(seen[3], 0.21, 1e-9);  // a ramp is a cubic
    EXPECT_NEAR(seen[58 + 3], -0.21, 1e-9);
  }
}

TEST(EffortDesign, AnOutputTermActsOnEachLogForItself) {
  const AxisLog log = sine_log();
  const EffortDesign design({log, log}, kView);
  Eigen::VectorXd signal(2 * kRows);
  signal << log.tau_nm, (10.0 + log.tau_nm.array()).matrix();
  const Eigen::VectorXd late =
      design.passed_through(effort_law_catalogue(AxisKind::kRotary).term("transport_delay"), {2.0 * kPeriodS}, signal);
  EXPECT_NEAR(late[100], 0.98, 1e-9);
  EXPECT_GE(late[kRows], 9.9);  // nothing of the first log
}

TEST(EffortDesign, ALogShorterThanItsWindowIsSeenThroughAShorterOne) {
  AxisLog log = sine_log();
  for (auto* signal : {&log.time_s, &log.q1_rad, &log.tau_nm, &log.effort}) {
    signal->conservativeResize(7);
  }
  EffortView view = kView;
  view.window_s = 1.0;
  view.averaged = true;
  const EffortDesign design({log}, view);
  EXPECT_NEAR(design.samples()[0][3].q1, log.q1_rad[3], 1e-5);
  EXPECT_EQ(design.seen(log.tau_nm).size(), 7);
}

TEST(UsualView, StandsStillBelowTwoPercentOfTheFastestLogsSpeed) {
  AxisLog fast = sine_log();
  fast.q1_rad *= 2.0;
  const EffortView view = usual_view({sine_log(), fast});
  EXPECT_NEAR(view.standstill, 0.02 * 6.0, 1e-3);
  EXPECT_TRUE(view.averaged);
  AxisLog gear = sine_log();
  gear.has_torque = true;
  EXPECT_FALSE(usual_view({gear}).averaged);  // its torque is an input, sample by sample
}

}  // namespace
}  // namespace capstan::tools
