// SPDX-License-Identifier: Apache-2.0
// Input that no person would type. Seeds are fixed, so every run is the same.
#include <gtest/gtest.h>

#include <random>

#include "capstan/tests/firmware/support.hpp"

namespace capstan {
namespace {

using Bench = test::Bench<2>;

/// The joint has never had torque and never moved.
auto at_rest(const Bench& bench) -> bool {
  return bench.state() == State::kDisarmed && !bench.io.has_torque() && bench.io.motors[0].angle_rad == 0.0 &&
         bench.io.motors[1].angle_rad == 0.0;
}

/// Feeds one character as a careful host would: an answer under way is waited for.
void feed(Bench& bench, char c) {
  bench.shell.receive(c);
  for (int i = 0; i < 3000 && bench.shell.busy(); ++i) {
    bench.application.rt_tick();
    bench.shell.poll();
  }
}

TEST(ShellFuzz, RandomBytesNeverArmNorMoveAJoint) {
  Bench bench;
  std::mt19937 random(20261121);
  std::array<char, 3> last{};
  for (int i = 0; i < 100'000; ++i) {
    char c = static_cast<char>(random() & 0xFFU);
    if (last[1] == 'a' && last[2] == 'r' && c == 'm') {
      c = 'x';  // the one word that may
    }
    last = {last[1], last[2], c};
    feed(bench, c);
    ASSERT_TRUE(at_rest(bench)) << "byte " << i;
  }
  bench.shell.receive('\n');
  bench.sink.take();
  EXPECT_NE(bench.say("version").find("board bench"), std::string::npos) << "it still works";
}

TEST(ShellFuzz, RandomSentencesOfTheShellsOwnWordsKeepTheContractAndNeverGiveTorque) {
  static constexpr std::array kWords = {"help",
                                        "version",
                                        "status",
                                        "faults",
                                        "get",
                                        "set",
                                        "list",
                                        "dump",
                                        "diff",
                                        "begin",
                                        "commit",
                                        "abandon",
                                        "defaults",
                                        "save",
                                        "load",
                                        "disarm",
                                        "move",
                                        "hold",
                                        "log",
                                        "joint0",
                                        "joint1",
                                        "joint9",
                                        "joint0.control.kp",
                                        "joint1.limits.current",
                                        "joint0.motor.encoder_sign",
                                        "1",
                                        "-1",
                                        "0.5",
                                        "1e9",
                                        "-1e-9",
                                        "nan",
                                        "inf",
                                        "99999999999999999999",
                                        "0x10",
                                        "rad",
                                        "deg",
                                        "ms",
                                        "mA",
                                        "Nm",
                                        "#",
                                        ";",
                                        "joint0.limits.motor_min",
                                        "30deg",
                                        "3",
                                        "joint0.play.half_width",
                                        "5 ms",
                                        "\t",
                                        "joint",
                                        ".",
                                        "joint0.",
                                        "e",
                                        "-",
                                        "+"};
  Bench bench;
  std::mt19937 random(7);
  for (int i = 0; i < 20'000; ++i) {
    std::string line;
    const auto count = random() % 6;
    for (unsigned word = 0; word < count; ++word) {
      line += std::string(kWords[random() % kWords.size()]) + (random() % 8 == 0 ? "" : " ");
    }
    const std::string answer = bench.say(line);
    ASSERT_TRUE(bench.answered) << line;
    const auto lines = test::lines_of(answer);
    ASSERT_EQ(std::count_if(lines.begin(), lines.end(), test::is_final), 1) << line << "\n" << answer;
    ASSERT_TRUE(test::is_final(lines.back())) << line;
    ASSERT_TRUE(at_rest(bench)) << line;
    for (const AxisConfig& axis : bench.application.config()) {
      ASSERT_EQ(check(axis), nullptr) << line;
    }
  }
}

TEST(ShellFuzz, DamagedCommandsUnderTorqueNeverLeaveTheLimits) {
  Bench bench;
  std::mt19937 random(3);
  static constexpr std::array kLines = {
      "move joint0 0.5", "move joint1 -30 deg", "set joint0.control.kp 0.4",       "hold joint0",
      "status",          "log joint0 3",        "set joint0.limits.joint_max 1.5", "arm",
      "disarm"};
  for (int i = 0; i < 5'000; ++i) {
    std::string line = kLines[random() % kLines.size()];
    if (random() % 2 == 0) {
      line[random() % line.size()] = static_cast<char>(' ' + random() % 95);
    }
    static_cast<void>(bench.say(line));
    bench.ticks(20);
    ASSERT_LE(std::fabs(bench.io.motors[0].angle_rad), 2.1) << line;
    ASSERT_LE(std::fabs(bench.io.motors[1].angle_rad), 2.1) << line;
  }
}

TEST(ShellFuzz, APasteOfTenThousandLinesWithTheWaitForAnswerRuleLosesNothing) {
  Bench bench;
  int answers = 0;
  int oks = 0;
  for (int i = 0; i < 10'000; ++i) {
    const std::string value = "0." + std::to_string(100'000 + i);
    const auto lines =
        test::lines_of(bench.say("set joint" + std::to_string(i % 2) + ".control.integral_limit " + value));
    answers += static_cast<int>(std::count_if(lines.begin(), lines.end(), test::is_final));
    oks += lines.back() == "ok" ? 1 : 0;
    ASSERT_EQ(bench.application.config()[static_cast<std::size_t>(i % 2)].control.integral_limit_rad,
              Q24::from_double((100'000 + i) * 1e-6))
        << "line " << i;
  }
  EXPECT_EQ(answers, 10'000);
  EXPECT_EQ(oks, 10'000);
}

}  // namespace
}  // namespace capstan
