// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "capstan/tools/identify/force_fit.hpp"

namespace capstan::tools {
namespace {

constexpr Eigen::Index kRows = 4000;
const PreisachTable kNoTable{};

auto parameters() -> ForceLawParameters<double> {
  ForceLawParameters<double> law;
  law.kind = ForceLawKind::kPullPush;
  law.pull_push.eta_top = law.pull_push.eta_bottom = 0.5;
  law.pull_push.pretension_nm = 0.2;
  return law;
}

/// A torque of +-1 Nm, and what the law itself makes of it, but for an error: `near_nm` within 0.2 Nm of the torque's
/// way since it turned, `far_nm` beyond.
auto log_with(double near_nm, double far_nm) -> AxisLog {
  AxisLog log;
  log.time_s = Eigen::VectorXd::LinSpaced(kRows, 0.0, 40.0);
  log.q1_rad = Eigen::VectorXd::Zero(kRows);
  log.tau_nm.resize(kRows);
  for (Eigen::Index i = 0; i < kRows; ++i) {  // a triangle: a twentieth of a turn, which counts as noise, is soon over
    const double phase = static_cast<double>(i % 400) / 400.0;
    log.tau_nm[i] = phase < 0.5 ? 4.0 * phase - 1.0 : 3.0 - 4.0 * phase;
  }
  log.effort.resize(kRows);
  ForceLaw<double, kMostPreisachLevels, 16> law;
  law.become(parameters(), kNoTable);
  double turned = 0.0;
  bool forward = true;
  for (Eigen::Index i = 0; i < kRows; ++i) {
    const bool now = i == 0 || log.tau_nm[i] > log.tau_nm[i - 1];
    turned = now != forward ? log.tau_nm[i - 1] : turned;
    forward = now;
    const double error = std::abs(log.tau_nm[i] - turned) < 0.2 ? near_nm : far_nm;
    log.effort[i] = law.update(log.tau_nm[i]).force + (i % 2 == 0 ? error : -error);
  }
  return log;
}

TEST(ForceErrorBar, IsWhatNinetyFiveOfAHundredKeepWithinAndWhatOtherLoopsAdd) {
  const auto bar = force_error_bar({log_with(0.01, 0.01)}, parameters(), kNoTable);
  ASSERT_TRUE(bar);
  EXPECT_NEAR(bar->values[0], 1.2 * 0.01, 1e-9);
  EXPECT_NEAR(bar->values[1], 1.2 * 0.01, 1e-9);
  EXPECT_NEAR(bar->values[3], 1.05, 1e-3);  // a board may go a little further than its logs
}

TEST(ForceErrorBar, IsWiderNearATurnWhereTheLawIsWorseThere) {
  const auto bar = force_error_bar({log_with(0.05, 0.01)}, parameters(), kNoTable);
  ASSERT_TRUE(bar);
  EXPECT_NEAR(bar->values[0], 1.2 * 0.01, 1e-3);
  EXPECT_NEAR(bar->values[1], 1.2 * 0.05, 1e-3);
  EXPECT_NEAR(bar->values[2], 0.2, 0.011);  // a tenth of the torque's range
}

TEST(ForceErrorBar, IsOfAllLogsTogether) {
  const auto bar = force_error_bar({log_with(0.01, 0.01), log_with(0.03, 0.03)}, parameters(), kNoTable);
  ASSERT_TRUE(bar);
  EXPECT_NEAR(bar->values[0], 1.2 * 0.03, 1e-9);  // half of the samples err by as much
}

TEST(ForceErrorBar, OfNoLawOrTooFewSamplesIsNone) {
  EXPECT_FALSE(force_error_bar({log_with(0.01, 0.01)}, ForceLawParameters<double>{}, kNoTable));
  AxisLog few = log_with(0.01, 0.01);
  for (auto* signal : {&few.time_s, &few.q1_rad, &few.tau_nm, &few.effort}) {
    signal->conservativeResize(50);
  }
  EXPECT_FALSE(force_error_bar({few}, parameters(), kNoTable));
}

}  // namespace
}  // namespace capstan::tools
