// SPDX-License-Identifier: Apache-2.0
// Who commands, who looks, and when the torque goes.
#include "hub_fixture.hpp"

namespace capstan::tools {
namespace {

using namespace std::chrono_literals;

TEST_F(HubTest, FirstPageCommandsAndTheSecondLooks) {
  hub.join(first, now);
  hub.join(second, now);
  EXPECT_EQ(first.words, std::vector<std::string>{"command 10"});
  EXPECT_EQ(second.words, std::vector<std::string>{"look 10"});
  hub.bytes(first, "status\n");
  hub.bytes(second, "arm\n");
  EXPECT_EQ(board.sent, "status\n");
}

TEST_F(HubTest, TheCommandingPageStartsASimulatedBoardAnewAndAllAreTold) {
  board.simulated = true;
  hub.join(first, now);
  hub.join(second, now);
  EXPECT_EQ(first.words, std::vector<std::string>{"command 10 anew"});
  EXPECT_EQ(second.words, std::vector<std::string>{"look 10 anew"});
  hub.word(first, "anew play=0.03", now);
  EXPECT_EQ(board.effect, "play=0.03");
  EXPECT_EQ(first.words, (std::vector<std::string>{"command 10 anew", "command 10 anew", "anew "}));
  EXPECT_EQ(second.words.back(), "look 10 anew");
  hub.word(first, "anew", now);
  EXPECT_EQ(board.effect, "");
}

TEST_F(HubTest, WhatCanNotStartAnewIsRefusedByASentenceAndTheBoardGoesOn) {
  hub.join(first, now);
  hub.join(second, now);
  hub.word(first, "anew play=0.03", now);
  EXPECT_NE(first.words.back().find("only a simulator of capstan console"), std::string::npos);
  board.simulated = true;
  hub.word(second, "anew play=0.03", now);
  EXPECT_NE(second.words.back().find("take the command first"), std::string::npos);
  hub.word(first, "anew no_such=1", now);
  EXPECT_EQ(first.words.back(), "anew no such effect");
  EXPECT_EQ(board.effect, "not started anew");
  EXPECT_TRUE(hub.commands(first));
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
