// SPDX-License-Identifier: Apache-2.0
// The background of a board whose console is a serial line of 115200 baud, in virtual time: what is printed may not
// keep the shell from hearing who wants torque off.
#include <gtest/gtest.h>

#include <deque>

#include "capstan/firmware/console/shell_input.hpp"
#include "capstan/tests/firmware/support.hpp"

namespace capstan {
namespace {

using test::has_line;
using test::lines_of;
using test::verdict;

constexpr double kCharacterUs = 86.8;
constexpr double kCycleUs = 1000.0;

/// Firmware in its interrupt, and a line that takes characters from a buffer of 1024 while time goes by.
class SlowLine final : public TextSink {
 public:
  SlowLine() {
    run(5);
    say("arm");
    run(50);
    text_.clear();
  }

  void say(std::string_view line) {
    for (const char c : line) {
      received_.push_back(c);
    }
    received_.push_back('\r');
  }
  void press(char key) { received_.push_back(key); }
  void run(int milliseconds) {
    const double end = us_ + kCycleUs * milliseconds;
    while (us_ < end) {
      background();
    }
  }
  /// Until it has no torque any more, at most a minute.
  auto milliseconds_to_torque_off() -> double {
    const double since = us_;
    while (has_torque() && us_ < since + 60e6) {
      background();
    }
    return 1e-3 * (us_ - since);
  }
  /// Likewise until everything is answered.
  auto milliseconds_to_answer() -> double {
    const double since = us_;
    do {
      background();
    } while ((shell.busy() || !received_.empty()) && us_ < since + 60e6);
    return 1e-3 * (us_ - since);
  }
  [[nodiscard]] auto has_torque() const -> bool { return energised(application.telemetry().state); }
  /// Without what is echoed before it.
  auto answer() -> std::string {
    std::string answer = std::exchange(text_, {});
    answer.erase(0, answer.find('\n') + 1);
    return answer.substr(0, answer.rfind("capstan> "));
  }

  test::FakeIo<2> io;
  test::FlashBanks banks;
  Application<test::FakeIo<2>> application{io, banks};
  test::FakeBoard board;
  Shell shell{application, *this, board, true};
  ShellInput input{shell};

 private:
  void do_write(std::string_view text) override {
    constexpr std::size_t kBuffer = 1024;
    text_.append(text);
    waiting_ += text.size();
    while (waiting_ > kBuffer) {
      pass(kCharacterUs);
    }
  }
  void background() {
    while (!received_.empty() && input.wants() > 0) {
      input.take(received_.front());
      received_.pop_front();
    }
    input.poll();
    pass(50.0);
  }
  void pass(double us) {
    us_ += us;
    sent_us_ = waiting_ > 0 ? sent_us_ + us : 0.0;
    for (; waiting_ > 0 && sent_us_ >= kCharacterUs; sent_us_ -= kCharacterUs) {
      --waiting_;
    }
    for (; next_cycle_us_ <= us_; next_cycle_us_ += kCycleUs) {
      application.rt_tick();
    }
  }

  std::string text_;
  std::deque<char> received_;
  std::size_t waiting_ = 0;
  double us_ = 0.0, sent_us_ = 0.0, next_cycle_us_ = 0.0;
};

TEST(SlowLine, ADisarmIsHeardWithinALinesTimeWhateverIsBeingPrinted) {
  for (const char* printed :
       {"log joint0 20000 1", "experiment joint0 chirp", "experiment joint0 multisine on=torque",
        "experiment joint0 triangle every=1", "list", "dump", "scope signals",
        "frames 1 joint0.q1 joint0.q2 joint0.torque joint0.reference joint0.current joint0.drive"}) {
    SlowLine line;
    line.say(printed);
    line.run(300);
    ASSERT_TRUE(line.has_torque()) << printed << ": " << line.answer();
    line.say("disarm");
    EXPECT_LT(line.milliseconds_to_torque_off(), 20.0) << printed;
  }
}

TEST(SlowLine, AnswersOfAFewLinesAreHeardThroughToo) {
  for (const char* printed : {"help", "help table", "model", "status", "faults"}) {
    SlowLine line;
    line.say("list joint0.limits");  // the buffer is full
    line.say(printed);
    line.run(150);
    ASSERT_TRUE(line.has_torque()) << printed;
    line.say("disarm");
    EXPECT_LT(line.milliseconds_to_torque_off(), 45.0) << printed << ": its longest line has 400 characters";
  }
}

TEST(SlowLine, CtrlCEndsWhatIsBeingPrinted) {
  for (const char* printed : {"log joint0 20000 1", "list", "dump", "help", "scope signals"}) {
    SlowLine line;
    line.say(printed);
    line.run(120);
    ASSERT_TRUE(line.shell.busy()) << printed;
    line.press('\x03');
    EXPECT_LT(line.milliseconds_to_answer(), 45.0) << printed;
    EXPECT_EQ(verdict(line.answer()), "ok") << printed;
    EXPECT_TRUE(line.has_torque()) << printed;
  }
}

TEST(SlowLine, WhatIsPrintedSlowlyIsWhole) {
  SlowLine line;
  test::Bench<2> fast;
  for (const char* printed : {"list", "dump", "diff", "help", "model", "scope signals", "help limits"}) {
    line.say(printed);
    line.milliseconds_to_answer();
    EXPECT_EQ(line.answer(), fast.say(printed)) << printed;
  }
}

TEST(SlowLine, RowsThatALogHasNoTimeForAreCountedAndSaid) {
  constexpr std::size_t kRows = 400;
  SlowLine line;
  line.say("move joint0 1.5 rad");  // so that its rows have all their digits
  line.run(50);
  static_cast<void>(line.answer());
  line.say("log joint0 400 1");
  line.milliseconds_to_answer();
  const auto lines = lines_of(line.answer());
  ASSERT_EQ(lines.size(), 1 + kRows + 1 + 1) << lines.back();
  const double span_ms = 1e3 * (std::stod(lines[kRows]) - std::stod(lines[1]));
  ASSERT_TRUE(lines[kRows + 1].starts_with("# ")) << lines[kRows + 1];
  const double lost = std::stod(lines[kRows + 1].substr(2));
  EXPECT_GE(lost, std::round(span_ms) + 1 - kRows);
  EXPECT_GT(lost, 400.0);
}

TEST(SlowLine, AnExperimentsAnswerComesAfterItsLastRow) {
  const std::string experiment = "experiment joint0 triangle amplitude=0.1rad cycles=1 repeats=1 every=";
  for (const char* every : {"8", "1"}) {
    SlowLine line;
    line.say(experiment + every);
    line.milliseconds_to_answer();
    test::Bench<2> fast;
    fast.say("arm");
    fast.ticks(50);
    const auto all = lines_of(fast.say(experiment + every));
    const auto lines = lines_of(line.answer());
    EXPECT_EQ(lines.back(), "ok");
    const auto length_s = [](const std::string& first, const std::string& last) {
      return std::stod(last) - std::stod(first);
    };
    const bool lost = lines[lines.size() - 2].starts_with("# ");
    EXPECT_EQ(lost, every[0] == '1') << lines[lines.size() - 2];
    if (!lost) {
      EXPECT_NEAR(length_s(lines[1], lines[lines.size() - 2]), length_s(all[1], all[all.size() - 2]), 0.009);
      EXPECT_NEAR(static_cast<double>(lines.size()), static_cast<double>(all.size()), 1.0);
    }
  }
}

TEST(SlowLine, ADumpWhoseValuesChangeMeanwhileIsNoSet) {
  SlowLine line;
  test::StringSink other_sink;
  Shell other(line.application, other_sink, line.board, false);
  line.say("dump");
  line.run(500);
  ASSERT_TRUE(line.shell.busy());
  for (const char c : std::string("set joint1.control.kp 0.3\n")) {
    other.receive(c);
  }
  line.milliseconds_to_answer();
  const std::string answer = line.answer();
  EXPECT_EQ(test::error_of(answer), "changed");
  EXPECT_FALSE(has_line(answer, "commit")) << "so it can not be pasted back";
}

}  // namespace
}  // namespace capstan
