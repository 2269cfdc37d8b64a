// SPDX-License-Identifier: Apache-2.0
// The plant's faults from the operator's prompt.
#include "capstan/boards/sim/sim_board.hpp"

#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "capstan/boards/common/file_banks.hpp"

namespace capstan {
namespace {

class StringSink final : public TextSink {
 public:
  auto take() -> std::string { return std::exchange(text_, {}); }

 private:
  void do_write(std::string_view text) override { text_.append(text); }
  std::string text_;
};

class FaultsFromTheShell : public ::testing::Test {
 protected:
  auto say(std::string_view line) -> std::string {
    for (const char c : line) {
      board_.shell().receive(c);
    }
    board_.shell().receive('\n');
    while (board_.shell().busy()) {
      ticks(1);
      board_.shell().poll();
    }
    return sink_.take();
  }
  void ticks(int count) {
    for (int i = 0; i < count; ++i) {
      board_.tick();
    }
  }
  auto arm() -> std::string {
    ticks(1);
    return say("arm");
  }
  [[nodiscard]] auto fault() const -> Fault { return board_.machine().telemetry().first_fault; }

  FileBanks banks_ = FileBanks::temporary();
  StringSink sink_;
  SimBoard board_{sim::Scenario{}, banks_, sink_, false};
};

TEST_F(FaultsFromTheShell, ASensorDiesAtOnceAndTheFirmwareTakesTheTorqueAway) {
  ASSERT_EQ(arm(), "ok\r\n");
  EXPECT_EQ(say("fail encoder off for 0.05"), "ok\r\n");
  ticks(3);
  EXPECT_EQ(fault(), Fault::kSensorMissing);
  EXPECT_FALSE(energised(board_.machine().telemetry().state));
  ticks(60);
  EXPECT_EQ(say("disarm"), "ok\r\n");
  EXPECT_EQ(say("arm"), "ok\r\n");
}

TEST_F(FaultsFromTheShell, TimeCountsFromTheLine) {
  ASSERT_EQ(arm(), "ok\r\n");
  ticks(500);
  EXPECT_EQ(say("fail encoder off at 0.2"), "ok\r\n");
  ticks(195);
  EXPECT_EQ(fault(), Fault::kNone);
  ticks(10);
  EXPECT_EQ(fault(), Fault::kSensorMissing);
}

TEST_F(FaultsFromTheShell, AnAmplifierThatSticksHoldsTheCommandOfThatMoment) {
  ASSERT_EQ(arm(), "ok\r\n");
  ASSERT_EQ(say("move joint0 0.3 rad"), "ok\r\n");
  ticks(100);
  ASSERT_EQ(say("fail amplifier stuck for 0.02"), "ok\r\n");
  const double held = board_.truth(0).current_a;
  ASSERT_GT(held, 0.3);
  ticks(15);
  EXPECT_NEAR(board_.truth(0).current_a, held, 0.1 * held);
}

TEST_F(FaultsFromTheShell, AMistakeChangesNothingAndSaysWhatIsKnown) {
  ASSERT_EQ(arm(), "ok\r\n");
  for (const char* line : {"fail", "fail encoder", "fail encoder flies", "fail encoder off at x",
                           "fail encoder off axis 1", "fail tendon_top stuck"}) {
    const std::string answer = say(line);
    EXPECT_EQ(answer.rfind("error fault: ", 0), 0U) << answer;
    EXPECT_NE(answer.find("; "), std::string::npos) << "no cure in: " << answer;
  }
  ticks(50);
  EXPECT_EQ(fault(), Fault::kNone);
  EXPECT_NE(say("help").find("  fail TARGET KIND"), std::string::npos);
  EXPECT_EQ(say("break encoder").rfind("error unknown_command: ", 0), 0U);
}

// Between its parts it takes the torque away and gives it again: who stops it then must not be forgotten.
TEST_F(FaultsFromTheShell, CtrlCWhileCommissioningHasNoTorqueEndsItWithoutGivingItAgain) {
  ASSERT_EQ(arm(), "ok\r\n");
  say("maintenance open");
  for (const char c : std::string("commission joint0\n")) {
    board_.shell().receive(c);
  }
  const auto has_torque = [this] { return energised(board_.machine().telemetry().state); };
  for (int i = 0; i < 100'000 && has_torque(); ++i) {
    board_.shell().poll();
    ticks(1);
  }
  ASSERT_FALSE(has_torque());
  ASSERT_TRUE(board_.shell().busy()) << sink_.take();
  board_.shell().receive('\x03');
  for (int i = 0; i < 20'000 && board_.shell().busy(); ++i) {
    ticks(1);
    board_.shell().poll();
    ASSERT_FALSE(has_torque());
  }
  const std::string answer = sink_.take();
  EXPECT_NE(answer.find("error aborted: "), std::string::npos) << answer;
}

}  // namespace
}  // namespace capstan
