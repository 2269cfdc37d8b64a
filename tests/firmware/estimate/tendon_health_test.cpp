// SPDX-License-Identifier: Apache-2.0
// What the judge makes of friction, loop and zero; on the simulated plant: tests/tools/plant/plant_health_test.cpp.
#include "capstan/firmware/estimate/tendon_health.hpp"

#include <gtest/gtest.h>

namespace capstan {
namespace {

auto q(double value) -> Q24 {
  return Q24::from_double(value);
}
auto watching() -> MonitorConfig {
  return {.joint_rms_rad = q(0.002), .torque_rms_nm = q(0.001)};  // allowed: 3 mrad, 1.5 mNm
}
/// A joint that takes 54 mNm each way, 4 of them the motor's own, and whose loop is 60 mrad to either side.
auto healthy() -> TendonJudge::Stretch {
  return {
      .friction_nm = q(0.054), .healthy_nm = q(0.054), .motors_nm = q(0.004), .loop_rad = q(0.06), .has_joint = true};
}
constexpr auto kFriction = static_cast<WarningSet>(bit(Warning::kFrictionHigher) | bit(Warning::kFrictionLower));
constexpr auto kAll = static_cast<WarningSet>(kFriction | bit(Warning::kLawMisfit));
auto judged(TendonJudge::Stretch now, MonitorConfig config = watching(), WarningSet warnings = kAll) -> TendonJudge {
  TendonJudge judge;
  judge.rt_judge(config, healthy(), 0);
  judge.rt_judge(config, now, warnings);
  judge.rt_judge(config, now, warnings);
  return judge;
}
auto changed(double friction_nm, double wider_rad = 0.0, double shifted_rad = 0.0) -> TendonJudge::Stretch {
  TendonJudge::Stretch now = healthy();
  now.friction_nm = q(friction_nm);
  now.wider_rad = q(wider_rad);
  now.shifted_rad = q(shifted_rad);
  return now;
}

struct Case {
  const char* name;
  double friction_nm, wider_rad, shifted_rad;
  TendonHealth with_sensor, by_torque;
};
class TendonJudgeCauses : public testing::TestWithParam<Case> {};

TEST_P(TendonJudgeCauses, AreToldApartByFrictionLoopAndZero) {
  const Case& now = GetParam();
  TendonJudge::Stretch stretch = changed(now.friction_nm, now.wider_rad, now.shifted_rad);
  EXPECT_EQ(judged(stretch).health(), now.with_sensor);
  stretch.has_joint = false;
  EXPECT_EQ(judged(stretch).health(), now.by_torque);
}
using H = TendonHealth;
INSTANTIATE_TEST_SUITE_P(
    All, TendonJudgeCauses,
    testing::Values(Case{"nothing", 0.054, 0.0, 0.0, H::kNothing, H::kNothing},
                    Case{"allowed", 0.053, 0.002, -0.002, H::kNothing, H::kNothing},
                    Case{"loose", 0.034, 0.0, 0.001, H::kLoose, H::kLoose},
                    // 37 % of the loop is gone, and both tendons alike shift the zero by less than half of that.
                    Case{"loose_and_uneven", 0.034, 0.0, 0.008, H::kLoose, H::kLoose},
                    Case{"frayed", 0.034, 0.01, 0.03, H::kFrayed, H::kLoose},
                    Case{"slack", 0.01, 0.0, -0.01, H::kSlack, H::kSlack},
                    Case{"broken", 0.005, 0.2, 0.5, H::kBroken, H::kSlack},
                    Case{"worn", 0.06, 0.0, 0.0, H::kWorn, H::kWorn},
                    // A warning, and less than a tenth of the tendons' 50 mNm: anything else may have come.
                    Case{"little_more", 0.058, 0.0, 0.0, H::kNothing, H::kNothing},
                    Case{"little_less", 0.050, 0.0, 0.0, H::kNothing, H::kNothing},
                    Case{"little_more_and_play", 0.058, 0.01, 0.001, H::kPlay, H::kNothing},
                    Case{"play", 0.054, 0.01, 0.001, H::kPlay, H::kNothing},
                    Case{"narrower", 0.054, -0.01, 0.0, H::kNothing, H::kNothing},
                    Case{"zero_moved", 0.054, 0.001, -0.03, H::kZeroMoved, H::kNothing},
                    // Moved between the way there and the way back.
                    Case{"zero_moved_within", 0.054, 0.015, 0.015, H::kZeroMoved, H::kNothing}),
    [](const auto& one) { return one.param.name; });

TEST(TendonJudge, TheMotorsOwnFrictionIsNoTension) {
  EXPECT_NEAR(judged(changed(0.029)).tension().to_double(), 0.5, 1e-6);
  EXPECT_EQ(judged(changed(0.003)).tension(), Q24{}) << "less than the motor's own";
  EXPECT_EQ(judged(changed(20.0)).tension(), q(8.0)) << "more than can be, and no overflow";
}

TEST(TendonJudge, TellsNewtonsByTheTendonsShareOfTheFriction) {
  MonitorConfig config = watching();
  config.tendon_friction_nm = q(0.04);
  config.pretension_n = q(20.0);
  config.pretension_95_n = q(0.5);
  const TendonJudge looser = judged(changed(0.034), config);
  EXPECT_NEAR(looser.tension().to_double(), 0.5, 1e-6) << "20 of 40 mNm; 10 of them are no tendon's";
  EXPECT_NEAR(looser.pretension_n().to_double(), 10.0, 1e-4);
  EXPECT_NEAR(looser.pretension_95_n().to_double(), 0.25, 1e-5);
  EXPECT_EQ(judged(changed(0.01), config).pretension_n(), Q24{});
  config.pretension_n = q(127.0);
  EXPECT_GT(judged(changed(20.0), config).pretension_n(), q(127.0)) << "held at the end of its range";
  EXPECT_EQ(judged(changed(0.034)).pretension_n(), Q24{}) << "nobody said what the healthy joint's is";
}

TEST(TendonJudge, OneStretchIsNoCauseAndWithoutAWarningThereIsNone) {
  TendonJudge judge;
  judge.rt_judge(watching(), healthy(), 0);
  judge.rt_judge(watching(), changed(0.034), kAll);
  EXPECT_EQ(judge.health(), H::kNothing);
  judge.rt_judge(watching(), changed(0.06), kAll);
  EXPECT_EQ(judge.health(), H::kNothing) << "they contradict each other";
  EXPECT_EQ(judged(changed(0.034), watching(), 0).health(), H::kNothing);
}

TEST(TendonJudge, AZeroThatMovesAgainSlipsAndOneThatStaysDoesNot) {
  TendonJudge judge = judged(changed(0.054, 0.0, 0.03));
  judge.rt_judge(watching(), changed(0.054, 0.0, 0.031), kAll);
  EXPECT_EQ(judge.health(), H::kZeroMoved);
  judge.rt_judge(watching(), changed(0.054, 0.0, 0.06), kAll);
  EXPECT_EQ(judge.health(), H::kZeroMoved);
  judge.rt_judge(watching(), changed(0.054, 0.0, 0.06), kAll);
  EXPECT_EQ(judge.health(), H::kSlips);
  judge.rt_judge(watching(), changed(0.054, 0.0, 0.06), kAll);
  EXPECT_EQ(judge.health(), H::kSlips) << "it did slip";
}

TEST(TendonJudge, OnlyWhatTheWarningSaysHasACause) {
  const WarningSet misfit = bit(Warning::kLawMisfit);
  EXPECT_EQ(judged(changed(0.050, 0.0, 0.03), watching(), misfit).health(), H::kZeroMoved) << "friction is not sure";
  EXPECT_EQ(judged(changed(0.054, 0.0, 0.03), watching(), kFriction).health(), H::kNothing) << "nor here the zero";
  MonitorConfig by_torque = watching();
  by_torque.joint_rms_rad = Q24{};  // what the sensor may differ by is not known
  EXPECT_EQ(judged(changed(0.034, 0.0, 0.03), by_torque, kFriction).health(), H::kLoose);
  TendonJudge::Stretch stretch = changed(0.034);
  stretch.healthy_nm = Q24{};  // a law without steady torque
  EXPECT_EQ(judged(stretch).health(), H::kNothing);
  EXPECT_EQ(judged(stretch).tension(), Q24{});
}

TEST(TendonHealthTable, HasALineForEachWithCauseAndCure) {
  for (const TendonHealthInfo& row : kTendonHealthTable) {
    EXPECT_NE(std::string(row.cause), "") << row.name;
    EXPECT_NE(std::string(row.cure), "") << row.name;
  }
}

}  // namespace
}  // namespace capstan
