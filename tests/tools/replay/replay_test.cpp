// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/replay/replay.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "capstan/tests/tools/synthetic_joint.hpp"
#include "capstan/tools/identify/force_section.hpp"
#include "capstan/tools/identify/term_catalogue.hpp"
#include "capstan/tools/replay/force_replay.hpp"
#include "capstan/tools/support/errors.hpp"

namespace capstan::tools {
namespace {

auto some_law() -> LawParameters<double> {
  LawParameters<double> law = rigid_law();
  law.coefficients[catalogue_term("tendon_elongation").first_coefficient] = -0.9;
  law.coefficients[catalogue_term("tendon_elongation").first_coefficient + 1] = -0.6;
  law.coefficients[catalogue_term("play").first_coefficient] = 1.0;
  law.shapes[catalogue_term("play").first_shape] = 0.01;
  law.shapes[catalogue_term("transport_delay").first_shape] = 0.0035;
  return law;
}

auto log_at(double rate_hz) -> AxisLog {
  test::SyntheticRequest request;
  request.rate_hz = rate_hz;
  request.cycle_s = 5.0;
  request.cycles = 1;
  return test::synthetic_log(request);
}

TEST(Replay, FixedPointFollowsDoubleWithinTheFirmwaresTolerance) {
  const AxisLog log = log_at(1000.0);
  const Replayed fixed = replay(log, some_law(), Arithmetic::kFixed);
  const Replayed exact = replay(log, some_law(), Arithmetic::kDouble);
  EXPECT_LT((fixed.q2 - exact.q2).cwiseAbs().maxCoeff(), 2e-5);
  EXPECT_GT((fixed.q2 - exact.q2).cwiseAbs().maxCoeff(), 0.0);
  EXPECT_EQ(fixed.saturated, 0);
}

TEST(Replay, ThePrintedLogReplaysToTheSameBits) {
  const AxisLog log = log_at(1000.0);
  const CsvLog csv = CsvLog::parse(test::log_text(log), "x.csv");
  const Replayed first = replay(read_axis(csv, {}), some_law(), Arithmetic::kFixed);
  const LogColumns columns = columns_of(0, first);
  const CsvLog written = CsvLog::parse(csv.text_with(columns.names, columns.values), "y.csv");
  const Eigen::VectorXd read_back = written.column("axis0/q2_est_rad");
  for (Eigen::Index i = 0; i < read_back.size(); ++i) {
    ASSERT_EQ(Q24::from_double(read_back[i]), Q24::from_double(first.q2[i])) << i;
  }
  const Replayed again = replay(read_axis(written, {}), some_law(), Arithmetic::kFixed);
  EXPECT_EQ(first.q2, again.q2);
}

TEST(Replay, OtherRatesAreRefusedInFixedPointAndServedInDouble) {
  const AxisLog log = log_at(250.0);
  try {
    replay(log, some_law(), Arithmetic::kFixed);
    FAIL();
  } catch (const Refusal& refusal) {
    EXPECT_NE(std::string(refusal.what()).find("--arithmetic double"), std::string::npos) << refusal.what();
  }
  EXPECT_EQ(replay(log, some_law(), Arithmetic::kDouble).q2.size(), log.samples());
}

TEST(Replay, TheSensorsDelayIsInTheReportedAngleOnly) {
  const AxisLog log = log_at(1000.0);
  LawParameters<double> law = some_law();
  const Replayed late = replay(log, law, Arithmetic::kDouble);
  law.shapes[catalogue_term("transport_delay").first_shape] = 0.0;
  const Replayed prompt = replay(log, law, Arithmetic::kDouble);
  EXPECT_EQ(late.q2, prompt.q2);
  EXPECT_NE(late.reported, prompt.reported);
  EXPECT_EQ(prompt.reported, prompt.q2);
}

TEST(Replay, NumbersAtTheEndOfTheRangeAreCounted) {
  AxisLog log = log_at(1000.0);
  log.q1_rad[100] = 1000.0;
  EXPECT_GT(replay(log, some_law(), Arithmetic::kFixed).saturated, 0);
}

/// A play of the torque in steps of the thesis's grid: what relays of one width answer.
auto grid_file() -> std::string {
  return "schema = \"capstan.joint/1\"\n[force]\nmodel = \"preisach\"\ninputs = [-0.1, 0, 0.1]\n"
         "forces = [[-0.05], [-0.05, 0.01], [-0.05, 0.03, 0.06]]\nrmse = { value = 0.0, unit = \"Nm\" }\nsamples = 1\n";
}

TEST(ForceReplay, FollowsTheGridOfItsFileUpAndDown) {
  const BoardForceLaw law = read_board_force_law(grid_file(), "joint.toml");
  ASSERT_EQ(law.parameters.kind, ForceLawKind::kPreisach);
  const Eigen::VectorXd tau{{-0.1, 0.0, 0.1, 0.0, -0.1, 0.05, 0.2}};
  // Up to a level: f_aa; from the top down to a level: the top's row; halfway: halfway.
  const Eigen::VectorXd expected{{-0.05, 0.01, 0.06, 0.03, -0.05, 0.035, 0.06}};
  for (const Arithmetic arithmetic : {Arithmetic::kDouble, Arithmetic::kFixed}) {
    const ReplayedForce replayed = replay_force(tau, law, arithmetic);
    EXPECT_LT((replayed.torque_nm - expected).cwiseAbs().maxCoeff(), 1e-6);
    EXPECT_EQ(replayed.unknown, 0) << "the first sample is the lower saturation";
    EXPECT_EQ(replayed.beyond, 1);
  }
}

TEST(ForceReplay, SaysWhichSamplesDependOnAPastThatItDoesNotKnow) {
  const BoardForceLaw law = read_board_force_law(grid_file(), "joint.toml");
  const ReplayedForce replayed = replay_force(Eigen::VectorXd{{0.0, 0.03, -0.02, 0.1, 0.0}}, law, Arithmetic::kFixed);
  EXPECT_EQ(replayed.unknown, 3);
}

TEST(ForceReplay, PullPushOfAFileLeavesTheMotorsFrictionAndOffsetOut) {
  const std::string text =
      "[force]\nmodel = \"pull_push\"\neta_top = { value = 0.0, unit = \"1\" }\neta_bottom = { value = 0.0, unit = "
      "\"1\" }\n"
      "pretension = { value = 5.0, unit = \"Nm\" }\nratio = { value = 2.0, unit = \"1\" }\nfriction = { value = "
      "0.003, "
      "unit = \"Nm\" }\noffset = { value = 0.01, unit = \"Nm\" }\nstiffness_top = { value = 1.0, unit = \"Nm/rad\" }\n"
      "stiffness_bottom = { value = 1.0, unit = \"Nm/rad\" }\n";
  EXPECT_TRUE(is_force_alone(text, "joint.toml"));
  const BoardForceLaw law = read_board_force_law(text, "joint.toml");
  const ReplayedForce replayed = replay_force(Eigen::VectorXd{{0.0, 0.2, 0.1}}, law, Arithmetic::kDouble);
  // No friction in the tendons: r2 / r1 times what is left of the torque.
  EXPECT_NEAR(replayed.torque_nm[1], 2.0 * (0.2 - 0.01 - 0.003), 1e-9);
  EXPECT_NEAR(replayed.torque_nm[2], 2.0 * (0.1 - 0.01 + 0.003), 1e-9);
}

TEST(ForceReplay, RefusesAModelThatNoBoardRuns) {
  EXPECT_THROW(static_cast<void>(read_board_force_law("[force]\nmodel = \"magic\"\n", "joint.toml")), BadInput);
}

}  // namespace
}  // namespace capstan::tools
