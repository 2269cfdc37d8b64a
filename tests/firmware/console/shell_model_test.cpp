// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "capstan/tests/firmware/support.hpp"

namespace capstan {
namespace {

using namespace test;

TEST(ShellModel, ShowsTheTermsThatAreOnWithTheirParametersAndCountsTheOthers) {
  test::Bench<2> bench;
  const std::string rigid = bench.say("model joint0");
  EXPECT_TRUE(has_line(rigid, "  motor_angle: ")) << rigid;
  EXPECT_TRUE(has_line(rigid, "    beta 1 ")) << rigid;
  EXPECT_EQ(rigid.find("play"), std::string::npos) << rigid;
  EXPECT_EQ(rigid.find("joint1"), std::string::npos);
  for (const char* line :
       {"set joint0.play.gain 1", "set joint0.play.half_width 0.02", "set joint0.motor_angle.beta 1.25"}) {
    ASSERT_EQ(verdict(bench.say(line)), "ok");
  }
  const std::string with_play = bench.say("model");
  EXPECT_TRUE(has_line(with_play, "  play: ")) << with_play;
  EXPECT_TRUE(has_line(with_play, "    half_width 0.02 rad ")) << with_play;
  EXPECT_TRUE(has_line(with_play, "    beta 1.25 ")) << with_play;
  EXPECT_TRUE(has_line(with_play, "joint1 joint angle q2 is the sum of"));
  EXPECT_EQ(error_of(bench.say("model joint7")), "unknown_joint");
  bench.say("arm");
  EXPECT_EQ(error_of(bench.say("set joint0.play.gain 0.5")), "armed");
  EXPECT_EQ(bench.say("model"), with_play) << "and nothing was changed";
}

TEST(ShellModel, ShowsOfAHysteresisThePlaysThatItHas) {
  test::Bench<2> bench;
  ASSERT_EQ(verdict(bench.say("set joint0.hysteresis.half_width_1 0.02")), "ok");
  EXPECT_FALSE(has_line(bench.say("model joint0"), "  hysteresis: ")) << "a width without a weight is none";
  ASSERT_EQ(verdict(bench.say("set joint0.hysteresis.half_width_3 0.05")), "ok");
  ASSERT_EQ(verdict(bench.say("set joint0.hysteresis.weight_3 0.5")), "ok");
  const std::string shown = bench.say("model joint0");
  EXPECT_TRUE(has_line(shown, "  hysteresis: ")) << shown;
  EXPECT_TRUE(has_line(shown, "    weight_3 0.5 ")) << shown;
  EXPECT_EQ(shown.find("half_width_1"), std::string::npos) << shown;
}

TEST(ShellModel, SaysThatALawIsProvisionalAndSoDoesStatus) {
  test::Bench<2> bench;
  EXPECT_EQ(bench.say("model joint0").find("provisional"), std::string::npos);
  ASSERT_EQ(verdict(bench.say("set joint0.law.status 1")), "ok");
  EXPECT_TRUE(has_line(bench.say("model joint0"), "  the law is provisional: "));
  EXPECT_TRUE(has_line(bench.say("status"), "  the law is provisional: "));
  EXPECT_EQ(bench.say("model joint1").find("provisional"), std::string::npos);
  ASSERT_EQ(verdict(bench.say("set joint0.law.status 2")), "ok");
  EXPECT_TRUE(has_line(bench.say("model joint0"), "  the law is the base law: "));
  EXPECT_EQ(error_of(bench.say("set joint0.law.status 3")), "range");
}

TEST(ShellModel, RefusesACurveThatTurnsBackAndATableWithItsEndsOutOfOrder) {
  test::Bench<2> bench;
  ASSERT_EQ(verdict(bench.say("set joint0.curved_ratio.span 1")), "ok");
  EXPECT_NE(bench.say("set joint0.curved_ratio.square 0.6").find("curve of curved_ratio turns back"),
            std::string::npos);
  ASSERT_EQ(verdict(bench.say("set joint0.curved_ratio.square 0.3")), "ok");
  ASSERT_EQ(verdict(bench.say("set joint0.table.low 1")), "ok");
  EXPECT_NE(bench.say("set joint0.table.forward_0 0.1").find("a table with values needs table.low below table.high"),
            std::string::npos);
  EXPECT_EQ(verdict(bench.say("set joint0.table.high 2")), "ok");
  EXPECT_EQ(verdict(bench.say("set joint0.table.forward_0 0.1")), "ok");
}

}  // namespace
}  // namespace capstan
