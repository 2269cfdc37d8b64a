// SPDX-License-Identifier: Apache-2.0
#include "capstan/firmware/console/shell_input.hpp"

#include <gtest/gtest.h>

#include "capstan/tests/firmware/support.hpp"

namespace capstan {
namespace {

using namespace test;

struct Fed : test::Bench<2> {
  explicit Fed(bool echo = false) : Bench<2>(echo) {}
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

TEST(ShellInput, OnATerminalTooALineThatLostItsEndIsNotDone) {
  Fed fed(true);
  const auto gain = [&fed] { return fed.say("get joint0.control.stiffness"); };
  const std::string before = gain();
  fed.send("arm\nlog joint0 1000000\n");
  fed.background(50);
  ASSERT_TRUE(fed.shell.busy());
  const std::string cut = "\nset joint0.control.stiffness 0";
  while (fed.input.room() > cut.size()) {
    fed.input.take(' ');
  }
  for (const char c : cut + ".5\n") {
    fed.input.take(c);
  }
  fed.shell.receive('\x03');  // the log ends, the lines that wait stay
  fed.background(10);
  fed.sink.take();
  fed.send("version\n");
  fed.background(10);
  EXPECT_NE(fed.sink.take().find("error not_text: "), std::string::npos);
  EXPECT_EQ(gain(), before);
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

TEST(ShellInput, ADisarmIsHeardWithoutRoomWhileAnArmingWaitsForItsDrives) {
  Fed fed;
  fed.io.cycles_to_follow = 200;
  fed.send("arm\n");
  fed.background(5);
  ASSERT_EQ(fed.state(), State::kArmed);
  while (fed.input.room() > 0) {
    fed.input.take("version\n"[(256 - fed.input.room()) % 8]);
  }
  ASSERT_GT(fed.input.wants(), 0U);
  for (const char c : std::string("disarm\n")) {
    fed.input.take(c);
  }
  fed.background(2);
  EXPECT_EQ(fed.state(), State::kDisarmed);
}

}  // namespace
}  // namespace capstan
