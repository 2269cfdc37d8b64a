// SPDX-License-Identifier: Apache-2.0
// watch, scope, model, timing, zero and reboot, as a person or a script meets them.
#include <gtest/gtest.h>

#include <sstream>

#include "capstan/firmware/console/shell_input.hpp"
#include "capstan/tests/firmware/support.hpp"

namespace capstan {
namespace {

using Bench = test::Bench<2>;
using test::has_line;
using test::lines_of;
using test::verdict;

auto error_of(const std::string& answer) -> std::string {
  const std::string last = verdict(answer);
  return last.rfind("error ", 0) == 0 ? last.substr(6, last.find(':') - 6) : last;
}

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
}

TEST(ShellModel, ShowsTheTermsThatAreOnWithTheirParametersAndCountsTheOthers) {
  Bench bench;
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
  Bench bench;
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
  Bench bench;
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
  Bench bench;
  ASSERT_EQ(verdict(bench.say("set joint0.curved_ratio.span 1")), "ok");
  EXPECT_NE(bench.say("set joint0.curved_ratio.square 0.6").find("curve of curved_ratio turns back"),
            std::string::npos);
  ASSERT_EQ(verdict(bench.say("set joint0.curved_ratio.square 0.3")), "ok");
  ASSERT_EQ(verdict(bench.say("set joint0.table.low 1")), "ok");
  EXPECT_NE(bench.say("set joint0.table.forward_0 0.1").find("table.low is not below table.high"), std::string::npos);
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

struct Fed : Bench {
  void send(const std::string& text, bool urgent = true) {
    for (const char c : text) {
      ASSERT_GT(input.room(), 0U);
      input.take(c, urgent);
    }
  }
  void background(int cycles) {
    for (int i = 0; i < cycles; ++i) {
      input.poll();
      application.rt_tick();
    }
    input.poll();
  }
  ShellInput input{shell};
};

TEST(ShellInput, ATypedDisarmTakesTorqueAwayInTheMiddleOfALogAndIsAnsweredInItsTurn) {
  for (const std::string typed : {"disarm\n", "  disarm now\r\n", "disx\barm\r",
                                  "nonsense\x15"
                                  "disarm\n"}) {
    Fed fed;
    fed.send("arm\nlog joint0 1000000\n");
    fed.background(50);
    ASSERT_EQ(fed.state(), State::kHolding);
    ASSERT_TRUE(fed.shell.busy());
    fed.sink.take();
    fed.send("status\n" + typed);
    fed.background(1);
    EXPECT_EQ(fed.state(), State::kDisarmed) << typed;
    EXPECT_FALSE(fed.io.has_torque());
    fed.background(20);
    EXPECT_FALSE(fed.shell.busy());
    const auto lines = lines_of(fed.sink.take());
    EXPECT_EQ(std::count(lines.begin(), lines.end(), "ok"), 3) << typed << " after a log and a status:\n"
                                                               << testing::PrintToString(lines);
  }
}

/// A log under torque, and behind it as much as finds room.
struct Crowded : Fed {
  explicit Crowded(bool armed = true) {
    send(armed ? "arm\nlog joint0 1000000\n" : "log joint0 1000000\n");
    background(50);
    while (input.room() > 0) {
      input.take("version\n"[(256 - input.room()) % 8]);
    }
    sink.take();
  }
  auto answers() -> std::vector<std::string> {
    background(50);
    return lines_of(sink.take());
  }
};

TEST(ShellInput, ADisarmIsHeardWithoutRoomAndTheLinesBeforeItAreToldAsLost) {
  for (const std::string behind : {"disarm\n", "move joint0 1 rad\nmove joint0 -1 rad\n  disarm\r\n"}) {
    Crowded fed;
    ASSERT_GT(fed.input.wants(), 0U);
    for (const char c : behind) {
      fed.input.take(c);
    }
    fed.background(1);
    EXPECT_EQ(fed.state(), State::kDisarmed) << behind;
    EXPECT_FALSE(fed.io.has_torque());
    const auto lines = fed.answers();
    const auto is_version = [](const std::string& line) { return line.starts_with("capstan "); };
    EXPECT_TRUE(std::none_of(lines.begin(), lines.end(), is_version)) << testing::PrintToString(lines);
    ASSERT_GE(lines.size(), 3U);
    const auto* const last = &lines[lines.size() - (behind.size() > 10 ? 3 : 2)];
    EXPECT_EQ(error_of(last[0]), "not_text") << testing::PrintToString(lines);
    EXPECT_EQ(last[1], "ok");
  }
}

TEST(ShellInput, CtrlCIsHeardWithoutRoomAndEndsWhatStreams) {
  Crowded fed;
  fed.input.take('\x03');
  fed.background(3);
  EXPECT_FALSE(fed.shell.busy());
  EXPECT_EQ(fed.state(), State::kHolding);
  fed.send("status\n");
  EXPECT_EQ(fed.answers().back(), "ok");
}

TEST(ShellInput, ALineThatFoundNoRoomIsRefusedAndSoIsOneThatActsRightBehindIt) {
  for (const std::string lost : {"status\n", "sta"}) {
    Crowded fed;
    for (const char c : lost) {
      fed.input.take(c);
    }
    fed.shell.receive('\x03');  // the log ends, the lines that wait stay
    fed.background(10);
    fed.sink.take();
    fed.send(lost == "sta" ? "tus\nmove joint0 1 rad\n" : "move joint0 1 rad\n");
    const auto lines = fed.answers();
    ASSERT_EQ(lines.size(), 2U) << testing::PrintToString(lines);
    EXPECT_EQ(error_of(lines[0]), "not_text");
    EXPECT_EQ(error_of(lines[1]), "after_damage");
  }
}

TEST(ShellInput, ItWantsNoMoreThanItHasRoomForWhereNothingCanMove) {
  const Crowded still(false);
  EXPECT_EQ(still.input.wants(), 0U);
  const Crowded armed;
  EXPECT_GT(armed.input.wants(), 0U);
}

TEST(ShellInput, NothingElseOvertakes) {
  for (const std::string typed : {"status\n", "disarmed\n", "# disarm\n", "arm\n", "disarm", "disarm\x15\n"}) {
    Fed fed;
    fed.send("arm\nlog joint0 1000000\n");
    fed.background(50);
    fed.send(typed);
    fed.background(20);
    EXPECT_EQ(fed.state(), State::kHolding) << typed;
    EXPECT_TRUE(fed.shell.busy()) << typed;
  }
}

TEST(ShellInput, InAScriptADisarmWaitsForTheLogBeforeIt) {
  Fed fed;
  fed.send("arm\nlog joint0 100\n", false);
  fed.background(10);
  fed.send("disarm\n", false);
  fed.background(20);
  EXPECT_EQ(fed.state(), State::kHolding);
  fed.background(200);
  EXPECT_EQ(fed.state(), State::kDisarmed);
  EXPECT_EQ(lines_of(fed.sink.take()).size(), 1U + 1 + 100 + 1 + 1);
}

TEST(ShellInput, ALineOfDisarmEndsAWatchToo) {
  Fed fed;
  fed.send("arm\n");
  fed.background(10);
  fed.send("watch 20 joint0.q2\n");
  fed.background(100);
  fed.send("disarm\n");
  fed.background(3);
  EXPECT_EQ(fed.state(), State::kDisarmed);
}

}  // namespace
}  // namespace capstan
