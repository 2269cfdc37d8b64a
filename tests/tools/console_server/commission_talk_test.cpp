// SPDX-License-Identifier: Apache-2.0
// Who may start a commissioning and what ends it, up to the moment at which the program would begin. What the program
// does then is tested with a page: tests/tools/console/served_setup.test.mjs.
#include "capstan/tools/console_server/commission_talk.hpp"

#include <algorithm>
#include <boost/asio/io_context.hpp>

#include "hub_fixture.hpp"

namespace capstan::tools {
namespace {

using namespace std::chrono_literals;

class CommissionTalkTest : public HubTest {
 protected:
  CommissionTalkTest() {
    talk.join(first, now);
    talk.join(second, now);
  }
  static constexpr const char* kStart = R"(commission start {"axis":0,"corridor":0.8,"key":"","again":false})";
  static auto last_ended(const Page& page) -> bool {
    return !page.words.empty() && page.words.back().starts_with("commission ended ");
  }
  [[nodiscard]] static auto ended(const Page& page) -> int {
    return static_cast<int>(std::count_if(page.words.begin(), page.words.end(), [](const std::string& word) {
      return word.starts_with("commission ended ");
    }));
  }
  boost::asio::io_context io;
  CommissionTalk talk{io, hub};
};

TEST_F(CommissionTalkTest, OtherWordsAndBytesAreTheHubs) {
  talk.bytes(first, "status\n");
  talk.bytes(second, "arm\n");
  EXPECT_EQ(board.sent, "status\n");
  talk.word(second, "disarm", now);
  EXPECT_EQ(board.disarmed, 1);
  talk.word(second, "take", now);
  EXPECT_EQ(second.words.back(), "command 10");
}

TEST_F(CommissionTalkTest, APageThatLooksCanNotStartOne) {
  talk.word(second, kStart, now);
  EXPECT_TRUE(last_ended(second));
  EXPECT_EQ(board.left, 0);
  EXPECT_TRUE(hub.commands(first));
}

TEST_F(CommissionTalkTest, WhatIsNotUnderstoodIsRefusedAndThePageCommandsOn) {
  for (const char* asked : {"", "{", "[]", R"({"axis":0})", R"({"axis":"0;ls","corridor":1})"}) {
    talk.word(first, std::string("commission start ") + asked, now);
    EXPECT_TRUE(last_ended(first)) << asked;
    EXPECT_TRUE(hub.commands(first)) << asked;
  }
  EXPECT_EQ(board.left, 0);
}

TEST_F(CommissionTalkTest, TheTorqueGoesAtTheStartAndNoPageCommandsMeanwhile) {
  talk.word(first, kStart, now);
  EXPECT_EQ(board.left, 1);
  EXPECT_EQ(first.words.back(), "look 10");
  talk.bytes(first, "arm\n");
  EXPECT_EQ(board.sent, "");
  talk.word(second, "take", now);
  EXPECT_FALSE(hub.commands(second));
  EXPECT_TRUE(second.words.back().starts_with("remark ")) << second.words.back();
  talk.word(first, kStart, now);
  EXPECT_TRUE(last_ended(first)) << "there is one under way";
  EXPECT_FALSE(hub.commands(first));
}

TEST_F(CommissionTalkTest, StopDisarmAndAPageThatLosesFocusEndItAndTheCommandGoesBack) {
  for (const auto& [page, word] : std::vector<std::pair<Page*, std::string>>{
           {&first, "commission stop"}, {&first, "disarm"}, {&second, "disarm"}, {&first, "leave"}}) {
    const int disarmed = board.disarmed;
    const int before = ended(first);
    talk.word(first, kStart, now);
    talk.word(*page, word, now);
    EXPECT_GT(board.disarmed, disarmed) << word;
    EXPECT_EQ(ended(first), before + 1) << word;
    EXPECT_TRUE(hub.commands(first)) << word;
  }
}

TEST_F(CommissionTalkTest, OnlyItsOwnPageStopsItByThatWord) {
  talk.word(first, kStart, now);
  talk.word(second, "commission stop", now);
  talk.word(second, "leave", now);
  EXPECT_EQ(ended(first), 0);
}

TEST_F(CommissionTalkTest, APageThatSaysNothingForASecondLosesIt) {
  talk.word(first, kStart, now);
  board.listener.bytes("# still talking\r\n");
  talk.word(second, "alive", now + 1100ms);
  talk.look(now + 1150ms);
  EXPECT_EQ(board.disarmed, 1);
  EXPECT_EQ(ended(first), 1);
}

TEST_F(CommissionTalkTest, APageThatIsGoneTakesItAlongAndTheOtherCommands) {
  talk.word(first, kStart, now);
  talk.leave(first);
  EXPECT_EQ(board.disarmed, 1);
  EXPECT_TRUE(hub.commands(second));
}

}  // namespace
}  // namespace capstan::tools
