// SPDX-License-Identifier: Apache-2.0
// Who commands, who looks, and when the torque goes.
#include "capstan/tools/console_server/hub.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

namespace capstan::tools {
namespace {

using namespace std::chrono_literals;

struct Board {
  std::string sent;
  int disarmed = 0;
  int left = 0;
  int opened = 0;
  std::string refuses;
  Hub::Listener listener;
};

class FakeLine final : public BoardLine {
 public:
  explicit FakeLine(Board& board) : board_(board) {}
  void send(std::string_view bytes) override { board_.sent += bytes; }
  void disarm() override { ++board_.disarmed; }
  void peer_left() override { ++board_.left; }
  [[nodiscard]] auto every_ms() const -> int override { return 10; }

 private:
  Board& board_;
};

class Page final : public Guest {
 public:
  std::string heard;
  std::vector<std::string> words;
  void bytes(std::string_view bytes) override { heard += bytes; }
  void say(std::string_view words_said) override { words.emplace_back(words_said); }
};

class HubTest : public testing::Test {
 protected:
  Board board;
  Hub::Clock::time_point now = Hub::Clock::now();
  Hub hub{[this](Hub::Listener listener) -> std::unique_ptr<BoardLine> {
    if (!board.refuses.empty()) {
      throw std::runtime_error(board.refuses);
    }
    ++board.opened;
    board.listener = std::move(listener);
    return std::make_unique<FakeLine>(board);
  }};
  Page first;
  Page second;
};

TEST_F(HubTest, FirstPageCommandsAndTheSecondLooks) {
  hub.join(first, now);
  hub.join(second, now);
  EXPECT_EQ(first.words, std::vector<std::string>{"command 10"});
  EXPECT_EQ(second.words, std::vector<std::string>{"look 10"});
  hub.bytes(first, "status\n");
  hub.bytes(second, "arm\n");
  EXPECT_EQ(board.sent, "status\n");
}

TEST_F(HubTest, EveryPageHearsTheBoard) {
  hub.join(first, now);
  hub.join(second, now);
  board.listener.bytes("ok\r\n");
  EXPECT_EQ(first.heard, "ok\r\n");
  EXPECT_EQ(second.heard, "ok\r\n");
}

TEST_F(HubTest, TheTorqueGoesWithTheCommandingPageAndTheNextOneCommands) {
  hub.join(first, now);
  hub.join(second, now);
  hub.leave(first);
  EXPECT_EQ(board.left, 1);
  EXPECT_EQ(second.words.back(), "command 10");
  hub.bytes(second, "arm\n");
  EXPECT_EQ(board.sent, "arm\n");
}

TEST_F(HubTest, APageThatOnlyLooksTakesNothingAlong) {
  hub.join(first, now);
  hub.join(second, now);
  hub.leave(second);
  EXPECT_EQ(board.left, 0);
  hub.bytes(first, "status\n");
  EXPECT_EQ(board.sent, "status\n");
}

TEST_F(HubTest, APageThatLooksDisarmsAndTheOtherIsToldToBeginItsTalkAnew) {
  hub.join(first, now);
  hub.join(second, now);
  hub.word(second, "disarm", now);
  EXPECT_EQ(board.disarmed, 1);
  EXPECT_EQ(first.words[1], "cancel");
  EXPECT_EQ(second.words.size(), 1U);
}

TEST_F(HubTest, APageThatLooksCannotLeaveForTheOther) {
  hub.join(first, now);
  hub.join(second, now);
  hub.word(second, "leave", now);
  EXPECT_EQ(board.left, 0);
  hub.word(first, "leave", now);
  EXPECT_EQ(board.left, 1);
}

TEST_F(HubTest, ASilentPageLosesTheTorqueOnceAndALookersWordsDoNotHelp) {
  hub.join(first, now);
  hub.join(second, now);
  hub.word(first, "alive", now + 900ms);
  hub.look(now + 1800ms);
  EXPECT_EQ(board.left, 0);
  hub.word(second, "alive", now + 1800ms);
  hub.look(now + 2000ms);
  EXPECT_EQ(board.left, 1);
  hub.look(now + 4000ms);
  EXPECT_EQ(board.left, 1);
  hub.word(first, "alive", now + 4100ms);
  hub.look(now + 5200ms);
  EXPECT_EQ(board.left, 2);
}

TEST_F(HubTest, TakingTheCommandTakesTheTorqueFirst) {
  hub.join(first, now);
  hub.join(second, now);
  hub.word(second, "take", now);
  EXPECT_EQ(board.left, 1);
  EXPECT_EQ(first.words.back(), "look 10");
  EXPECT_EQ(second.words.back(), "command 10");
  hub.bytes(first, "arm\n");
  EXPECT_EQ(board.sent, "");
}

TEST_F(HubTest, ALostBoardIsToldToAllAndTriedAgainByWhoComes) {
  hub.join(first, now);
  board.refuses = "the port does not open; plug it in";
  board.listener.lost("the line is gone; check the cable");
  EXPECT_EQ(first.words.back(), "lost the line is gone; check the cable");
  hub.bytes(first, "arm\n");
  EXPECT_EQ(board.sent, "");
  hub.join(second, now);
  EXPECT_EQ(second.words.back(), "lost the port does not open; plug it in");
  hub.leave(second);
  board.refuses.clear();
  hub.leave(first);
  hub.join(first, now);
  EXPECT_EQ(first.words.back(), "command 10");
  EXPECT_EQ(board.opened, 2);
}

TEST_F(HubTest, ClosingTakesTheTorque) {
  hub.close();
  EXPECT_EQ(board.left, 1);
}

TEST_F(HubTest, TheServerSpeaksOnlyWhereNoPageCommands) {
  hub.send_unattended("frames 10 joint0.q2\n");
  EXPECT_EQ(board.sent, "frames 10 joint0.q2\n");
  hub.join(first, now);
  hub.send_unattended("frames 10 joint0.q2\n");
  EXPECT_EQ(board.sent, "frames 10 joint0.q2\n");
}

TEST(HubWithoutBoard, ALineThatDoesNotOpenAtTheStartIsTheCallersToTell) {
  EXPECT_THROW(Hub([](const Hub::Listener&) -> std::unique_ptr<BoardLine> { throw std::runtime_error("taken"); }),
               std::runtime_error);
}

}  // namespace
}  // namespace capstan::tools
