// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/diagnose/one_law.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "capstan/tools/diagnose/diagnosis.hpp"
#include "capstan/tools/identify/law_fit.hpp"
#include "capstan/tools/support/random.hpp"
#include "capstan/tools/support/statistics.hpp"

namespace capstan::tools {
namespace {

constexpr double kNoise = 0.0005;

/// Four equal cycles of a joint with a gap and a tendon that yields, written out here. The gap's half width and the
/// joint's zero may be others from some row on.
struct GapJoint {
  double half_width = 0.02, half_width_later = 0.02, zero_later = 0.0, drift = 0.0;
  Eigen::Index changes_at = 2000;

  [[nodiscard]] auto log() const -> AxisLog {
    constexpr Eigen::Index kRows = 4000;
    AxisLog log;
    log.name = "gap.csv";
    log.target = "axis0/q2_rad";
    log.period_s = 0.01;
    log.has_torque = true;
    log.time_s = Eigen::VectorXd::LinSpaced(kRows, 0.0, log.period_s * static_cast<double>(kRows - 1));
    log.q1_rad = log.tau_nm = log.q2_rad = Eigen::VectorXd::Zero(kRows);
    Random random(0x6A9);
    double behind = 0.0;
    for (Eigen::Index i = 0; i < kRows; ++i) {
      const double phase = 2.0 * std::numbers::pi * log.time_s[i] / 10.0;
      const double q1 = 0.8 * std::sin(phase) + 0.35 * std::sin(3.0 * phase + 0.4);
      const double half = i < changes_at ? half_width : half_width_later;
      behind = std::clamp(behind, q1 - half, q1 + half);
      const double rate = 0.8 * std::cos(phase) + 1.05 * std::cos(3.0 * phase + 0.4);
      log.q1_rad[i] = q1;
      log.tau_nm[i] = (rate > 0.0 ? 0.06 : -0.06) + 0.03 * std::sin(2.0 * phase);
      log.q2_rad[i] = 0.9 * behind - 0.27 * log.tau_nm[i] + (i < changes_at ? 0.0 : zero_later) +
                      drift * log.time_s[i] + kNoise * random.normal();
    }
    return log;
  }
};

void expect_changed(const GapJoint& joint) {
  const Diagnosis d = diagnose({joint.log()}, {});
  EXPECT_EQ(d.verdict, Verdict::kUnknown) << d.reason;
  EXPECT_NE(d.reason.find("The joint changed at time_s"), std::string::npos) << d.reason;
  EXPECT_TRUE(d.effects.empty());
  EXPECT_NE(d.law.status, LawStatus::kConfirmed);
  EXPECT_LT(d.noise_floor, 1.2 * kNoise);
  ASSERT_TRUE(d.next_experiment);
  EXPECT_NE(d.next_experiment->find("capstan compare"), std::string::npos);
}

TEST(OneLaw, AGapThatGrowsOrShrinksHalfWayIsNoNoiseAndNoConfirmedEffect) {
  for (const double later : {0.03, 0.01}) {
    GapJoint joint;
    joint.half_width_later = later;
    expect_changed(joint);
  }
}

TEST(OneLaw, AChangeBesideTheMiddleIsFoundAtItsRow) {
  GapJoint joint;
  joint.half_width_later = 0.03;
  joint.changes_at = 1300;
  const Diagnosis d = diagnose({joint.log()}, {});
  const std::size_t at = d.reason.find("(row ");
  ASSERT_NE(at, std::string::npos) << d.reason;
  EXPECT_NEAR(std::stod(d.reason.substr(at + 5)), 1301.0, 40.0) << d.reason;
  EXPECT_NE(d.reason.find("play.half_width moved from 0.02"), std::string::npos) << d.reason;
}

TEST(OneLaw, AZeroThatJumpsIsSaidToHaveMoved) {
  GapJoint joint;
  joint.zero_later = 0.1;
  const Diagnosis d = diagnose({joint.log()}, {});
  EXPECT_EQ(d.verdict, Verdict::kUnknown) << d.reason;
  EXPECT_NE(d.reason.find("joint_offset.offset moved from"), std::string::npos) << d.reason;
  // The law is one of the joint as it is now: it errs by the noise on a log without a jump, but for its zero.
  const AxisLog other = GapJoint{}.log();
  const Eigen::VectorXd left = left_by(d.law, {other});
  EXPECT_LT(rms_about_mean(left), 4.0 * kNoise);
}

TEST(OneLaw, AJointThatStaysTheSameKeepsItsName) {
  const Diagnosis d = diagnose({GapJoint{}.log()}, {});
  EXPECT_EQ(d.verdict, Verdict::kEffect) << d.reason;
  ASSERT_EQ(d.effects.size(), 1U);
  EXPECT_EQ(d.effects[0].name, "play");
}

// What goes on all the time is no change, whether the law has a drift or not.
TEST(OneLaw, ADriftIsNoChange) {
  GapJoint joint;
  joint.drift = 0.001;
  const Diagnosis d = diagnose({joint.log()}, {});
  EXPECT_EQ(d.reason.find("another one"), std::string::npos) << d.reason;
}

}  // namespace
}  // namespace capstan::tools
