// SPDX-License-Identifier: Apache-2.0
// The shell as a terminal: editing, line ends, and the log that flows by.
#include <gtest/gtest.h>

#include <cstdlib>

#include "capstan/tests/firmware/support.hpp"

namespace capstan {
namespace {

using Bench = test::Bench<2>;
using test::error_of;
using test::has_line;
using test::lines_of;
using test::verdict;

/// Splits a row of CSV into numbers; empty if one of them is none.
auto numbers_of(const std::string& row) -> std::vector<double> {
  std::vector<double> numbers;
  const char* at = row.c_str();
  for (;;) {
    char* end = nullptr;
    numbers.push_back(std::strtod(at, &end));
    if (end == at || (*end != ',' && *end != '\0')) {
      return {};
    }
    if (*end == '\0') {
      return numbers;
    }
    at = end + 1;
  }
}

TEST(ShellLog, PrintsAHeaderByTheContractAndThatManyRowsWithRisingTime) {
  Bench bench;
  for (const auto& [line, every] : {std::pair{"log joint1 200", 1}, {"log joint1 50 10", 10}}) {
    const auto lines = lines_of(bench.say(line));
    const std::size_t count = every == 1 ? 200 : 50;
    ASSERT_EQ(lines.size(), count + 2) << line;
    EXPECT_EQ(lines[0], "time_s,axis1/q1_rad,axis1/tau_Nm,axis1/q2_est_rad,axis1/q2_ref_rad,axis1/current_A");
    double last = -1.0;
    for (std::size_t i = 1; i <= count; ++i) {
      ASSERT_EQ(numbers_of(lines[i]).size(), 6U) << lines[i];
      const double time = numbers_of(lines[i])[0];
      EXPECT_NEAR(time - last, 0.001 * every, i == 1 ? 1e9 : 1e-9);
      last = time;
    }
    EXPECT_EQ(lines.back(), "ok");
  }
}

TEST(ShellLog, RefusesCountsAndSpacingsThatMakeNoSense) {
  Bench bench;
  for (const char* line : {"log joint0 0", "log joint0 -1", "log joint0 1000001", "log joint0 1.5", "log joint0 x",
                           "log joint0 10 0", "log joint0 10 1001", "log joint0 10 x", "log joint2 10", "log 10"}) {
    const std::string answer = bench.say(line);
    EXPECT_EQ(verdict(answer).rfind("error usage: ", 0), 0U) << line;
    EXPECT_EQ(lines_of(answer).size(), 1U) << line << ": no header for a log that does not come";
  }
}

TEST(ShellLog, SaysHowManySamplesFoundNoRoom) {
  Bench bench;
  for (const char c : std::string("log joint0 300\n")) {
    bench.shell.receive(c);
  }
  bench.ticks(200);  // nobody fetches: 32 fit
  bench.shell.poll();
  for (int i = 0; i < 500 && bench.shell.busy(); ++i) {
    bench.ticks(1);
    bench.shell.poll();
  }
  const std::string answer = bench.sink.take();
  EXPECT_NE(answer.find("# 168 samples found no room"), std::string::npos) << answer.substr(answer.size() - 200);
  EXPECT_EQ(verdict(answer), "ok");
}

TEST(ShellLog, CancelEndsALogWithItsAnswer) {
  Bench bench;
  for (const char c : std::string("log joint0 1000000\n")) {
    bench.shell.receive(c);
  }
  bench.ticks(10);
  bench.shell.poll();
  EXPECT_TRUE(bench.shell.busy());
  bench.shell.receive(0x03);
  bench.shell.poll();
  EXPECT_FALSE(bench.shell.busy());
  EXPECT_EQ(verdict(bench.sink.take()), "ok");
  EXPECT_EQ(verdict(bench.say("status")), "ok");
}

TEST(ShellEditing, BackspaceAndDeleteTakeCharactersBackAndTheScreenFollows) {
  Bench bench(true);
  const std::string screen = bench.say("sta\btt\x7Ftus");  // "sta", back, "tt", delete, "tus"
  EXPECT_EQ(screen.rfind("sta\b \btt\b \btus\r\n", 0), 0U) << screen;
  EXPECT_NE(screen.find("error unknown_command"), std::string::npos) << "that reads 'sttus'";
  const std::string corrected = bench.say("statusx\b");
  EXPECT_NE(corrected.find("state disarmed"), std::string::npos) << corrected;
}

TEST(ShellEditing, BackspaceAtTheBeginningOfALineDoesNothing) {
  Bench bench(true);
  const std::string screen = bench.say("\b\b\x7Fversion");
  EXPECT_EQ(screen.rfind("version\r\n", 0), 0U) << screen;
  EXPECT_NE(screen.find("\r\nok\r\n"), std::string::npos);
}

TEST(ShellEditing, KillAndCancelForgetTheLine) {
  for (const char key : {'\x15', '\x03'}) {
    Bench bench(true);
    const std::string screen = bench.say(std::string("arm") + key + "version");
    EXPECT_NE(screen.find("board bench"), std::string::npos) << screen;
    EXPECT_EQ(bench.state(), State::kDisarmed);
  }
}

TEST(ShellEditing, CarriageReturnLineFeedOrBothEndALineOnce) {
  for (const char* end : {"\r", "\n", "\r\n"}) {
    Bench bench;
    for (const char c : std::string("version") + end + "version" + end) {
      bench.shell.receive(c);
    }
    const auto lines = lines_of(bench.sink.take());
    EXPECT_EQ(std::count(lines.begin(), lines.end(), "ok"), 2) << "end of " << std::string(end).size() << " characters";
    EXPECT_EQ(lines.size(), 4U);
  }
}

TEST(ShellEditing, WithoutATerminalThereIsNeitherEchoNorPrompt) {
  Bench bench;
  EXPECT_EQ(bench.say("# nothing"), "ok\r\n");
}

TEST(ShellEditing, ATerminalGetsAPromptAfterEveryAnswer) {
  Bench bench(true);
  for (const char* line : {"version", "nonsense", "arm", "", "set joint0.control.kp 99", "move joint0 9"}) {
    const std::string screen = bench.say(line);
    EXPECT_EQ(lines_of(screen).back(), "capstan> ") << line;
  }
}

TEST(ShellEditing, ALineOf160CharactersIsReadAndALongerOneIsRefusedWhole) {
  Bench bench;
  EXPECT_EQ(verdict(bench.say("arm" + std::string(157, ' '))), "ok");
  EXPECT_EQ(verdict(bench.say("disarm")), "ok");
  EXPECT_EQ(verdict(bench.say("arm" + std::string(158, ' '))).rfind("error line_too_long: ", 0), 0U);
  EXPECT_EQ(bench.state(), State::kDisarmed);
  EXPECT_EQ(verdict(bench.say("version")), "ok") << "the next line is a new one";
}

TEST(ShellEditing, ALineWithCharactersThatAreNoTextIsRefusedBecauseItMayMeanSomethingElse) {
  Bench bench;
  for (const std::string& damaged : {std::string("a\0rm", 4),
                                     std::string("\xFF"
                                                 "arm"),
                                     std::string("arm\x01"),
                                     std::string("set joint0.control.kp 0.\x80"
                                                 "5")}) {
    EXPECT_EQ(verdict(bench.say(damaged)).rfind("error not_text: ", 0), 0U) << damaged;
    EXPECT_EQ(bench.state(), State::kDisarmed);
    EXPECT_EQ(verdict(bench.say("version")), "ok") << "the next line is whole";
  }
  EXPECT_EQ(verdict(bench.say("\x01\x15version")), "ok") << "Ctrl-U forgets the damage too";
  EXPECT_EQ(verdict(bench.say("version")), "ok");
  EXPECT_EQ(verdict(bench.say("arm")), "ok");
  EXPECT_EQ(verdict(bench.say("dis\x80"
                              "arm")),
            "ok")
      << "what wants torque off is not refused";
  EXPECT_EQ(bench.state(), State::kDisarmed);
}

TEST(ShellNoise, WhatActsIsNotTakenRightBehindADamagedLineAndIsWhenSentAgain) {
  for (const char* noise : {"\x80\n", "st\x01tus\r", "\xFF\x15"}) {  // the last one forgotten by Ctrl-U
    Bench bench;
    for (const char* end = noise; *end != '\0'; ++end) {
      bench.shell.receive(*end);
    }
    bench.sink.take();
    EXPECT_EQ(verdict(bench.say("arm")).rfind("error after_damage: ", 0), 0U);
    EXPECT_EQ(bench.state(), State::kDisarmed);
    EXPECT_EQ(verdict(bench.say("arm")), "ok");
    EXPECT_TRUE(energised(bench.state()));
    EXPECT_EQ(verdict(bench.say("\x80version")).rfind("error not_text: ", 0), 0U);
    EXPECT_EQ(verdict(bench.say("disarm")), "ok") << "never refused";
  }
}

TEST(ShellNoise, WhatActsIsNeitherRememberedNorCompletedNorMadeFromARecalledLine) {
  Bench bench(true);
  bench.say("version");
  bench.say("arm");
  bench.say("disarm");
  bench.say("help arm");
  const std::string up = "\x1B[A";
  const std::string cut_help = "\x01\x04\x04\x04\x04\x04";  // Ctrl-A and five times Ctrl-D
  EXPECT_NE(bench.say(up + cut_help).find("error recalled: "), std::string::npos);
  EXPECT_EQ(bench.state(), State::kDisarmed);
  for (int age = 1; age < 8; ++age) {
    std::string keys;
    for (int i = 0; i < age; ++i) {
      keys += up;
    }
    bench.say(keys);
    EXPECT_EQ(bench.state(), State::kDisarmed) << age << " lines back";
  }
  for (const char* start : {"ar\t", "reb\t"}) {
    EXPECT_NE(bench.say(start).find("error unknown_command"), std::string::npos) << start;
  }
  EXPECT_EQ(bench.state(), State::kDisarmed);
}

/// Bytes as they come from a broken line: control characters far more often than chance would have them.
TEST(ShellNoise, AMillionBytesRichInControlCharactersNeverArmOrRestart) {
  Bench bench(true);
  bench.say("arm");
  bench.say("disarm");
  bench.say("reboot");
  const int restarts = bench.board.reboots;
  std::uint32_t state = 20261122;
  const std::string words = "arm move joint0 reboot hold disarm\t\r\n";
  for (int i = 0; i < 1'000'000; ++i) {
    state = state * 1664525U + 1013904223U;
    const std::uint32_t draw = state >> 8U;
    const char c = draw % 4 == 0   ? static_cast<char>(draw / 4 % 32)
                   : draw % 4 == 1 ? words[draw / 4 % words.size()]
                   : draw % 4 == 2 ? "\x1B[ABCD\x10\x0E\x01\x04\r"[draw / 4 % 11]
                                   : static_cast<char>(draw / 4 % 256);
    bench.shell.receive(c);
    if (i % 16 == 0) {
      bench.ticks(1);
      bench.shell.poll();
      bench.sink.take();
      ASSERT_EQ(bench.state(), State::kDisarmed) << "byte " << i;
    }
  }
  EXPECT_EQ(bench.board.reboots, restarts);
}

TEST(ShellEditing, KeysThatSendEscapeSequencesAreNoTextOfALine) {
  for (const char* line : {"nonsense\x1B\x15version", "ver\x1B[Asion", "\x1B[1;5Cversion", "version\x1BOP",
                           "ve\x1B"
                           "brsion",
                           "version\x1B", "version\x1B["}) {
    Bench bench(true);
    EXPECT_TRUE(has_line(bench.say(line), "ok")) << line;
  }
}

TEST(ShellEditing, WithoutATerminalAnEscapeIsDamageAndTakesNothingWithIt) {
  Bench bench;
  bench.say("arm");
  bench.ticks(50);
  for (const char* line : {"move joint0 0.1\x1B"
                           "5 rad",
                           "move joint0 \x1B-0.5 rad", "move joint0 0.1\x1B[5 rad", "version\x1B"}) {
    EXPECT_EQ(error_of(bench.say(line)), "not_text") << line;
    bench.say("version");  // a line that acts is not trusted right behind a damaged one
  }
  bench.ticks(500);
  EXPECT_EQ(bench.joint().q2_reference_rad, Q24{});
  EXPECT_EQ(verdict(bench.say("nonsense\x1B\x15version")), "ok") << "Ctrl-U begins a new line";
  EXPECT_EQ(verdict(bench.say("disarm \x1B")), "ok") << "what wants torque off is never refused";
}

}  // namespace
}  // namespace capstan
