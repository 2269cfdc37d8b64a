// SPDX-License-Identifier: Apache-2.0
// watch, scope, timing, zero and reboot, as a person or a script meets them.
#include <gtest/gtest.h>

#include <sstream>

#include "capstan/tests/firmware/support.hpp"

namespace capstan {
namespace {

using Bench = test::Bench<2>;
using test::error_of;
using test::has_line;
using test::lines_of;
using test::verdict;

void run(Bench& bench, int cycles) {
  for (int i = 0; i < cycles; ++i) {
    bench.application.rt_tick();
    bench.shell.poll();
  }
}

auto numbers_of(const std::string& line) -> std::vector<double> {
  std::vector<double> numbers;
  std::istringstream cells(line);
  for (std::string cell; std::getline(cells, cell, ',');) {
    numbers.push_back(std::stod(cell));
  }
  return numbers;
}

TEST(ShellScope, AMoveIsCapturedAroundTheCrossingOfALevelAndDumpedAsALogByTheContract) {
  Bench bench;
  EXPECT_EQ(verdict(bench.say("scope channels joint0.q2 joint0.reference joint1.q1 machine.state")), "ok");
  EXPECT_EQ(verdict(bench.say("scope trigger joint0.q2 rising 10 deg")), "ok");
  EXPECT_EQ(verdict(bench.say("scope start 400 100")), "ok");
  EXPECT_EQ(error_of(bench.say("scope dump")), "nothing_captured");
  bench.say("arm");
  bench.ticks(200);
  EXPECT_TRUE(has_line(bench.say("scope"), "scope waiting"));
  bench.say("move joint0 0.5");
  bench.ticks(1000);
  EXPECT_TRUE(has_line(bench.say("scope"), "scope done"));
  const auto lines = lines_of(bench.say("scope dump"));
  ASSERT_EQ(lines.size(), 403U);
  EXPECT_EQ(lines[0].rfind("# trigger in cycle ", 0), 0U);
  EXPECT_NE(lines[0].find(" 0 cycles dropped"), std::string::npos);
  EXPECT_EQ(lines[1], "time_s,axis0/q2_est_rad,axis0/q2_ref_rad,axis1/q1_rad,state");
  for (std::size_t i = 0; i < 400; ++i) {
    const auto row = numbers_of(lines[2 + i]);
    ASSERT_EQ(row.size(), 5U) << lines[2 + i];
    EXPECT_NEAR(row[0], 0.001 * (static_cast<double>(i) - 100.0), 1e-9);
    EXPECT_EQ(row[1] >= 0.17453292, i >= 100) << "10 degrees are passed in the trigger's sample: " << lines[2 + i];
    EXPECT_NEAR(row[1], row[2], 0.05);
  }
}

TEST(ShellScope, AFaultTriggersWhateverItIs) {
  Bench bench;
  bench.say("scope channels machine.fault joint0.current");
  bench.say("scope trigger fault");
  bench.say("scope start 20 10");
  bench.say("arm");
  bench.ticks(30);
  bench.io.estop = true;
  bench.ticks(30);
  const auto lines = lines_of(bench.say("scope dump"));
  ASSERT_EQ(lines.size(), 23U);
  for (std::size_t i = 0; i < 20; ++i) {
    EXPECT_EQ(numbers_of(lines[2 + i])[1], i < 10 ? 0.0 : 9.0) << "emergency_stop is number 9";
  }
}

TEST(ShellScope, ADumpCanBeEndedAndTheCaptureIsStillThere) {
  Bench bench;
  bench.say("scope channels joint0.q2");
  bench.say("scope start 1000 0");
  bench.ticks(1001);
  for (const char c : std::string("scope dump\n")) {
    bench.shell.receive(c);
  }
  run(bench, 3);
  ASSERT_TRUE(bench.shell.busy());
  bench.shell.receive(0x03);
  run(bench, 2);
  EXPECT_FALSE(bench.shell.busy());
  EXPECT_EQ(verdict(bench.sink.take()), "ok");
  EXPECT_EQ(lines_of(bench.say("scope dump")).size(), 1003U);
}

TEST(ShellScope, WrongSettingsAreRefusedWithTheCureAndChangeNothing) {
  Bench bench;
  EXPECT_EQ(error_of(bench.say("scope start")), "no_channels");
  bench.say("scope channels joint0.q2 joint1.q2");
  bench.say("scope trigger joint0.current above 0.5 A");
  const std::string before = bench.say("scope");
  for (const auto& [line, error] : std::vector<std::pair<std::string, std::string>>{
           {"scope channels", "unknown_signal"},
           {"scope channels joint0.q2 joint9.q2", "unknown_signal"},
           {"scope channels joint0.q1 joint0.q1 joint0.q1 joint0.q1 joint0.q1 joint0.q1 joint0.q1 joint0.q1 joint0.q1",
            "unknown_signal"},
           {"scope channels joint0.q1 joint0.q2 joint0.q1", "unknown_signal"},
           {"scope trigger", "unknown_signal"},
           {"scope trigger sometimes", "unknown_signal"},
           {"scope trigger fault 3", "usage"},
           {"scope trigger joint0.q2", "usage"},
           {"scope trigger joint0.q2 now", "usage"},
           {"scope trigger joint0.q2 rising", "not_a_level"},
           {"scope trigger joint0.q2 rising 1 A", "not_a_level"},
           {"scope trigger joint0.q2 rising 1e9", "not_a_level"},
           {"scope trigger machine.state above x", "not_a_level"},
           {"scope start 1", "range"},
           {"scope start 4001", "range"},
           {"scope start 100 100", "range"},
           {"scope start 100 -1", "range"},
           {"scope start 100 10 0", "range"},
           {"scope start 100 10 1 1", "range"},
           {"scope start ten", "range"},
           {"scope nonsense", "usage"}}) {
    EXPECT_EQ(error_of(bench.say(line)), error) << line;
  }
  EXPECT_EQ(bench.say("scope"), before);
  EXPECT_EQ(verdict(bench.say("scope start 4000")), "ok") << "two channels leave room for four thousand";
  EXPECT_EQ(verdict(bench.say("scope stop")), "ok");
  EXPECT_TRUE(has_line(bench.say("scope"), "scope idle"));
}

TEST(ShellWatch, PrintsAtItsRateUntilTheNextLineWhichIsCarriedOut) {
  Bench bench;
  bench.say("watch 50 joint0.q2 joint1.drive machine.state");
  EXPECT_FALSE(bench.shell.busy()) << "a line may come at any time";
  run(bench, 501);
  const auto lines = lines_of(bench.sink.take());
  EXPECT_NEAR(static_cast<double>(lines.size()), 10.0, 1.0);
  EXPECT_EQ(lines.front(), "joint0.q2 0 rad  joint1.drive 0 A  machine.state 0");
  const auto answer = lines_of(bench.say("version"));
  ASSERT_EQ(answer.size(), 3U);
  EXPECT_EQ(answer[0], "ok") << "of the watch";
  EXPECT_EQ(answer[1].rfind("capstan ", 0), 0U);
  run(bench, 300);
  EXPECT_EQ(bench.sink.take(), "") << "it has ended";
}

TEST(ShellWatch, CtrlCEndsItAndWrongOnesAreRefused) {
  Bench bench;
  bench.say("watch joint0.q2");
  run(bench, 10);
  bench.sink.take();
  bench.shell.receive(0x03);
  run(bench, 500);
  EXPECT_EQ(bench.sink.take(), "ok\r\n");
  EXPECT_EQ(error_of(bench.say("watch")), "unknown_signal");
  EXPECT_EQ(error_of(bench.say("watch 100")), "unknown_signal");
  EXPECT_EQ(error_of(bench.say("watch 5 joint0.q2")), "range");
  EXPECT_EQ(error_of(bench.say("watch joint0.q9")), "unknown_signal");
  EXPECT_EQ(error_of(bench.say("watch joint0.q2 joint1.q2 joint0.q2")), "unknown_signal");
}

TEST(ShellTiming, ShowsWhatTheBoardSaysAndWhatWasLost) {
  Bench bench;
  bench.io.overruns = 2;
  bench.ticks(1);
  const std::string answer = bench.say("timing");
  EXPECT_TRUE(has_line(answer, "the bench has no clock")) << answer;
  EXPECT_NE(answer.find("overruns 2, log samples dropped 0, console characters dropped 0"), std::string::npos)
      << answer;
}

TEST(ShellReboot, HappensOnlyWhenDisarmedAndAfterTheAnswer) {
  Bench bench;
  bench.say("arm");
  EXPECT_EQ(error_of(bench.say("reboot")), "not_disarmed");
  bench.io.estop = true;
  bench.ticks(1);
  EXPECT_EQ(error_of(bench.say("reboot")), "not_disarmed") << "the fault is not acknowledged";
  EXPECT_EQ(bench.board.reboots, 0);
  bench.say("disarm");
  EXPECT_EQ(bench.say("reboot"), "ok\r\n");
  EXPECT_EQ(bench.board.reboots, 1);
}

TEST(ShellZero, SaysWhereTheMotorStandsAndClearsTheLossOfPosition) {
  Bench bench;
  bench.io.encoder_shift = 7000;
  bench.ticks(1);
  EXPECT_TRUE(has_line(bench.say("arm"), "blocked by encoder_jump: "));
  for (const auto& [line, error] : std::vector<std::pair<std::string, std::string>>{{"zero", "unknown_joint"},
                                                                                    {"zero joint5", "unknown_joint"},
                                                                                    {"zero joint0 x", "not_an_angle"},
                                                                                    {"zero joint0 1 A", "not_an_angle"},
                                                                                    {"zero joint0 6.1", "range"},
                                                                                    {"zero joint0 1e9", "range"}}) {
    EXPECT_EQ(error_of(bench.say(line)), error) << line;
  }
  EXPECT_EQ(verdict(bench.say("zero joint0 30 deg")), "ok");
  EXPECT_NEAR(bench.joint(0).q1_rad.to_double(), 0.5235988, 1e-4);
  EXPECT_EQ(verdict(bench.say("zero joint1")), "ok");
  EXPECT_EQ(verdict(bench.say("arm")), "ok");
  EXPECT_EQ(error_of(bench.say("zero joint0")), "armed");
}

}  // namespace
}  // namespace capstan
