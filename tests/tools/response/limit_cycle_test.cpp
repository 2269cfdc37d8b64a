// SPDX-License-Identifier: Apache-2.0
// Onsets of swinging against a motor that is run with growing gains.
#include "capstan/tools/response/limit_cycle.hpp"

#include <gtest/gtest.h>

#include "capstan/tests/tools/response/known_motor.hpp"
#include "capstan/tools/response/response_report.hpp"
#include "capstan/tools/support/errors.hpp"

namespace capstan::tools {
namespace {

using test::gentle;
using test::kPi;
using test::Motor;

TEST(LimitCycle, OnsetIsTheFactorAtWhichTheMotorInTimeBeginsToGrow) {
  for (const int delay : {1, 3}) {
    const Motor motor{.delay = delay};
    const LoopGains gains = gentle();
    const auto cycle = predict_limit_cycle(motor.response(gains), gains);
    ASSERT_TRUE(cycle) << delay;
    EXPECT_FALSE(motor.grows(gains, 0.97 * cycle->onset)) << delay;
    EXPECT_TRUE(motor.grows(gains, 1.03 * cycle->onset)) << delay;
    EXPECT_DOUBLE_EQ(swing_rad(*cycle, 2.0), 2.0 / (2.0 * kPi * cycle->hz));
  }
}

TEST(LimitCycle, AMotorThatNeverSwingsIsToldNothing) {
  // No delay, and the log ends long before the sampling shows.
  const Motor motor{.delay = 0};
  const LoopGains gains = gentle();
  Response response = motor.response(gains);
  std::erase_if(response.points, [](const ResponsePoint& point) { return point.hz > 15.0; });
  EXPECT_FALSE(predict_limit_cycle(response, gains));
}

TEST(LimitCycle, AGainWithinTwoOfTheOnsetIsRefusedWithThatSentence) {
  const Motor motor{.delay = 3};
  const LoopGains present = gentle();
  Wanted wanted;
  bool told = false;
  for (double hz = 10.0; hz < 100.0 && !told; hz *= 1.1) {
    wanted.bandwidth_hz = hz;
    try {
      const Tuning tuning = tune(motor.response(present), present, wanted);
      const auto cycle = predict_limit_cycle(motor.response(present), tuning.gains);
      ASSERT_TRUE(cycle) << hz;
      EXPECT_GE(cycle->onset, 2.0) << hz;
      EXPECT_FALSE(motor.grows(tuning.gains, 1.9)) << hz;
      EXPECT_NE(tuning.swings.find("begins to swing at"), std::string::npos);
    } catch (const Refusal& refusal) {
      told =
          std::string(refusal.what()).find("times these gains a moving joint begins to swing at") != std::string::npos;
    }
  }
  EXPECT_TRUE(told);
}

TEST(LimitCycle, AShakeThatTurnsItsMotorAboutIsWarnedOfAndAGentleOneIsNot) {
  const LoopGains gains = gentle();
  Response response = Motor{}.response(gains);
  response.travels = true;
  response.motor_speed_rad_s = 0.9;
  response.motor_shake_rad_s = 0.25;
  EXPECT_EQ(tune(response, gains, {}).warning, "");
  response.motor_shake_rad_s = 0.5;
  const Tuning tuning = tune(response, gains, {});
  EXPECT_NE(tuning.warning.find("turned the motor about"), std::string::npos) << tuning.warning;
  EXPECT_NE(tuning_text(tuning, gains).find("warning: the shake"), std::string::npos);
  response.motor_speed_rad_s = 0.0;
  EXPECT_EQ(tune(response, gains, {}).warning, "") << "a joint that stands has no way to be turned about";
}

}  // namespace
}  // namespace capstan::tools
