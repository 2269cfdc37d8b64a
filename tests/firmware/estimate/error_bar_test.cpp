// SPDX-License-Identifier: Apache-2.0
#include "capstan/firmware/estimate/error_bar.hpp"

#include <gtest/gtest.h>

namespace capstan {
namespace {

auto q(double value) -> Q24 {
  return Q24::from_double(value);
}

/// Made of logs from -1 to 1 rad and up to 0.5 Nm; wide for 0.2 rad behind a reversal.
auto bar_config() -> ErrorBarConfig {
  return {.steady_rad = q(0.01),
          .turning_rad = q(0.03),
          .turn_rad = q(0.2),
          .from_rad = q(-1.0),
          .to_rad = q(1.0),
          .torque_nm = q(0.5)};
}

auto at(double q1, double reversal, double tau = 0.1) -> Sample<Q24> {
  Sample<Q24> sample;
  sample.q1 = q(q1);
  sample.q1_reversal = q(reversal);
  sample.tau = q(tau);
  return sample;
}

/// A bar whose motor has gone from 0 to 0.3 rad and turned.
auto settled_bar() -> ErrorBar {
  ErrorBar bar;
  bar.rt_step(bar_config(), at(0.3, 0.0));
  bar.rt_step(bar_config(), at(0.28, 0.3));
  return bar;
}

TEST(ErrorBar, IsWideBehindAReversalAndNarrowBeyond) {
  ErrorBar bar = settled_bar();
  const ErrorBarConfig config = bar_config();
  EXPECT_EQ(bar.rt_step(config, at(0.25, 0.3)), q(0.03)) << "back by 0.05";
  EXPECT_EQ(bar.rt_step(config, at(0.05, 0.3)), q(0.01)) << "back by 0.25";
}

TEST(ErrorBar, IsUnknownUntilTheMotorTurnsAtTheEndOfALongerWay) {
  ErrorBar bar;
  const ErrorBarConfig config = bar_config();
  EXPECT_EQ(bar.rt_step(config, at(0.1, 0.0)), ErrorBar::kUnknown);
  EXPECT_EQ(bar.rt_step(config, at(0.05, 0.1)), ErrorBar::kUnknown) << "a turn on the way proves nothing";
  EXPECT_EQ(bar.rt_step(config, at(-0.2, 0.1)), ErrorBar::kUnknown) << "a way of 0.3, and no turn yet";
  EXPECT_EQ(bar.rt_step(config, at(-0.19, -0.2)), q(0.03)) << "turned";
  EXPECT_EQ(bar.rt_step(config, at(0.1, -0.2)), q(0.01));
  bar.rt_forget();
  EXPECT_EQ(bar.rt_step(config, at(-0.15, -0.2)), ErrorBar::kUnknown);
  EXPECT_EQ(bar.rt_step(config, at(0.1, -0.2)), ErrorBar::kUnknown) << "a new way begins";
}

TEST(ErrorBar, IsUnknownWhereTheLogsHaveNotBeenAndComesBack) {
  ErrorBar bar = settled_bar();
  const ErrorBarConfig config = bar_config();
  EXPECT_EQ(bar.rt_step(config, at(1.1, 0.0)), ErrorBar::kUnknown);
  EXPECT_EQ(bar.rt_step(config, at(-1.1, 1.1)), ErrorBar::kUnknown);
  EXPECT_EQ(bar.rt_step(config, at(0.0, 1.1, 0.6)), ErrorBar::kUnknown) << "more torque";
  EXPECT_EQ(bar.rt_step(config, at(0.0, 1.1, -0.6)), ErrorBar::kUnknown);
  EXPECT_EQ(bar.rt_step(config, at(0.0, 1.1)), q(0.01));
}

TEST(ErrorBar, IsUnknownForALawThatNoFitToldOf) {
  ErrorBar bar = settled_bar();
  EXPECT_EQ(bar.rt_step({}, at(0.0, 0.0)), ErrorBar::kUnknown);
  ErrorBarConfig config = bar_config();
  config.steady_rad = Q24{};
  EXPECT_EQ(bar.rt_step(config, at(0.3, 0.0)), ErrorBar::kUnknown);
}

/// A force law's, made of torques up to 0.5 Nm; wide for 0.1 Nm behind a reversal.
auto force_config() -> ForceErrorConfig {
  return {.steady_nm = q(0.01), .turning_nm = q(0.03), .turn_nm = q(0.1), .torque_nm = q(0.5)};
}
auto known_force() -> ForceEstimate<Q24> {
  ForceEstimate<Q24> now;
  now.known = true;
  return now;
}

TEST(ForceErrorBar, IsWideBehindAReversalOfTheTorqueAndNarrowBeyond) {
  ForceErrorBar bar;
  EXPECT_EQ(bar.rt_step(force_config(), q(0.3), known_force()), q(0.01));
  EXPECT_EQ(bar.rt_step(force_config(), q(0.25), known_force()), q(0.03));
  EXPECT_EQ(bar.rt_step(force_config(), q(0.15), known_force()), q(0.01));
}

TEST(ForceErrorBar, IsUnknownWhereTheLawOrItsLogsDoNotSay) {
  ForceErrorBar bar;
  EXPECT_EQ(bar.rt_step(force_config(), q(0.6), known_force()), ErrorBar::kUnknown) << "more torque";
  EXPECT_EQ(bar.rt_step(force_config(), q(-0.6), known_force()), ErrorBar::kUnknown);
  EXPECT_EQ(bar.rt_step({}, q(0.0), known_force()), ErrorBar::kUnknown) << "no fit told of it";
  ForceEstimate<Q24> now = known_force();
  now.known = false;
  EXPECT_EQ(bar.rt_step(force_config(), q(0.3), now), ErrorBar::kUnknown) << "the start still matters";
  now = known_force();
  now.beyond_table = true;
  EXPECT_EQ(bar.rt_step(force_config(), q(0.3), now), ErrorBar::kUnknown);
  now = known_force();
  now.saturated = true;
  EXPECT_EQ(bar.rt_step(force_config(), q(0.3), now), ErrorBar::kUnknown);
}

TEST(ErrorBar, NoWidthCouldBeTakenForUnknown) {
  EXPECT_LT(ErrorBar::kUnknown, Q24{});
}

}  // namespace
}  // namespace capstan
