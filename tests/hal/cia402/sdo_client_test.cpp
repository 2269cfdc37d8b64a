// SPDX-License-Identifier: Apache-2.0
#include "capstan/hal/cia402/sdo_client.hpp"

#include <gtest/gtest.h>

#include "capstan/tests/hal/cia402/support.hpp"

namespace capstan::cia402 {
namespace {

constexpr Object kRated{0x6075, 0, 4, "motor rated current"};
constexpr Object kMode{0x6060, 0, 1, "mode of operation"};
constexpr Object kOption{0x6007, 0, 2, "abort connection option code"};

struct Rig {
  Journal journal;
  SdoClient sdo{5, journal, 1};
  [[nodiscard]] auto count(Anomaly anomaly) const -> std::uint32_t { return journal.count(anomaly, 1); }
};

TEST(SdoClient, ReadsFourBytes) {
  Rig rig;
  EXPECT_EQ(rig.sdo.read(kRated, ms(0)), frame(0x605, {0x40, 0x75, 0x60, 0x00, 0, 0, 0, 0}));
  EXPECT_EQ(rig.sdo.poll(ms(1)), SdoClient::State::kWaiting);
  rig.sdo.receive(frame(0x585, {0x43, 0x75, 0x60, 0x00, 0xD0, 0x07, 0x00, 0x00}));
  EXPECT_EQ(rig.sdo.poll(ms(2)), SdoClient::State::kDone);
  EXPECT_EQ(rig.sdo.value(), 2000U);
}

TEST(SdoClient, WritesOneTwoAndFourBytes) {
  Rig rig;
  EXPECT_EQ(rig.sdo.write(kMode, 10, ms(0)), frame(0x605, {0x2F, 0x60, 0x60, 0x00, 0x0A, 0, 0, 0}));
  rig.sdo.receive(frame(0x585, {0x60, 0x60, 0x60, 0x00, 0, 0, 0, 0}));
  EXPECT_EQ(rig.sdo.state(), SdoClient::State::kDone);
  EXPECT_EQ(rig.sdo.write(kOption, 0x0102, ms(1)), frame(0x605, {0x2B, 0x07, 0x60, 0x00, 0x02, 0x01, 0, 0}));
  rig.sdo.receive(frame(0x585, {0x60, 0x07, 0x60, 0x00, 0, 0, 0, 0}));
  EXPECT_EQ(rig.sdo.write({0x1016, 1, 4, ""}, 0x007F005A, ms(2)),
            frame(0x605, {0x23, 0x16, 0x10, 0x01, 0x5A, 0x00, 0x7F, 0x00}));
}

TEST(SdoClient, AnAbortIsTheDrivesAnswer) {
  Rig rig;
  static_cast<void>(rig.sdo.read(kRated, ms(0)));
  rig.sdo.receive(frame(0x585, {0x80, 0x75, 0x60, 0x00, 0x00, 0x00, 0x02, 0x06}));
  EXPECT_EQ(rig.sdo.state(), SdoClient::State::kAborted);
  EXPECT_EQ(rig.sdo.abort_code(), 0x06020000U);
}

TEST(SdoClient, SilenceEndsAfterTheTimeout) {
  Rig rig;
  static_cast<void>(rig.sdo.read(kRated, ms(10)));
  EXPECT_EQ(rig.sdo.poll(ms(1010)), SdoClient::State::kWaiting) << "drives answer after 250 ms and more";
  EXPECT_EQ(rig.sdo.poll(ms(1011)), SdoClient::State::kTimedOut);
  EXPECT_EQ(rig.count(Anomaly::kSdoTimeout), 1U);
  rig.sdo.receive(frame(0x585, {0x43, 0x75, 0x60, 0x00, 1, 0, 0, 0}));
  EXPECT_EQ(rig.sdo.state(), SdoClient::State::kTimedOut) << "a late answer is nobody's";
  EXPECT_EQ(rig.count(Anomaly::kSdoUnexpected), 1U);
}

TEST(SdoClient, AnAnswerTwiceCountsTheSecond) {
  Rig rig;
  static_cast<void>(rig.sdo.read(kRated, ms(0)));
  rig.sdo.receive(frame(0x585, {0x43, 0x75, 0x60, 0x00, 1, 0, 0, 0}));
  rig.sdo.receive(frame(0x585, {0x43, 0x75, 0x60, 0x00, 2, 0, 0, 0}));
  EXPECT_EQ(rig.sdo.value(), 1U);
  EXPECT_EQ(rig.count(Anomaly::kSdoUnexpected), 1U);
}

TEST(SdoClient, WhatDoesNotAnswerTheRequestIsCountedAndIgnored) {
  Rig rig;
  static_cast<void>(rig.sdo.read(kRated, ms(0)));
  rig.sdo.receive(frame(0x585, {0x43, 0x75, 0x60}));
  EXPECT_EQ(rig.count(Anomaly::kSdoLength), 1U);
  rig.sdo.receive(frame(0x585, {0x43, 0x76, 0x60, 0x00, 1, 0, 0, 0}));
  rig.sdo.receive(frame(0x585, {0x43, 0x75, 0x60, 0x01, 1, 0, 0, 0}));
  EXPECT_EQ(rig.count(Anomaly::kSdoOtherObject), 2U);
  rig.sdo.receive(frame(0x585, {0x60, 0x75, 0x60, 0x00, 1, 0, 0, 0}));
  EXPECT_EQ(rig.count(Anomaly::kSdoCommand), 1U) << "a write's answer to a read";
  EXPECT_EQ(rig.sdo.poll(ms(1)), SdoClient::State::kWaiting);
  rig.sdo.receive(frame(0x585, {0x43, 0x75, 0x60, 0x00, 9, 0, 0, 0}));
  EXPECT_EQ(rig.sdo.value(), 9U);
}

TEST(SdoClient, AnswersInSegmentsAreGathered) {
  Rig rig;
  static_cast<void>(rig.sdo.read(kRated, ms(0)));
  rig.sdo.receive(frame(0x585, {0x41, 0x75, 0x60, 0x00, 4, 0, 0, 0}));
  EXPECT_EQ(rig.sdo.follow_up(ms(1)), frame(0x605, {0x60, 0, 0, 0, 0, 0, 0, 0}));
  EXPECT_FALSE(rig.sdo.follow_up(ms(1))) << "once";
  rig.sdo.receive(frame(0x585, {0x0A, 0xD0, 0x07, 0, 0, 0, 0, 0}));  // two bytes of seven, more follow
  EXPECT_EQ(rig.sdo.follow_up(ms(2)), frame(0x605, {0x70, 0, 0, 0, 0, 0, 0, 0})) << "the toggle bit alternates";
  rig.sdo.receive(frame(0x585, {0x1B, 0x01, 0x00, 0, 0, 0, 0, 0}));  // the last two
  EXPECT_EQ(rig.sdo.poll(ms(3)), SdoClient::State::kDone);
  EXPECT_EQ(rig.sdo.value(), 0x000107D0U);
  static_cast<void>(rig.sdo.read(kOption, ms(4)));
  rig.sdo.receive(frame(0x585, {0x40, 0x07, 0x60, 0x00, 0, 0, 0, 0}));  // no size given
  static_cast<void>(rig.sdo.follow_up(ms(5)));
  rig.sdo.receive(frame(0x585, {0x0B, 0x02, 0x00, 0, 0, 0, 0, 0}));
  EXPECT_EQ(rig.sdo.state(), SdoClient::State::kDone);
  EXPECT_EQ(rig.sdo.value(), 2U);
}

TEST(SdoClient, SegmentsThatAreTooLongTooFewOrOutOfTurnAreRefused) {
  const auto answered = [](std::initializer_list<int> segment) {
    Rig rig;
    static_cast<void>(rig.sdo.read(kRated, ms(0)));
    rig.sdo.receive(frame(0x585, {0x40, 0x75, 0x60, 0x00, 0, 0, 0, 0}));
    static_cast<void>(rig.sdo.follow_up(ms(1)));
    rig.sdo.receive(frame(0x585, segment));
    return std::pair(rig.sdo.state(), rig.sdo.abort_code());
  };
  EXPECT_EQ(answered({0x00, 1, 2, 3, 4, 5, 6, 7}), std::pair(SdoClient::State::kAborted, 0x06070010U));
  EXPECT_EQ(answered({0x0B, 1, 2, 0, 0, 0, 0, 0}), std::pair(SdoClient::State::kAborted, 0x06070010U));
  EXPECT_EQ(answered({0x17, 1, 2, 3, 4, 0, 0, 0}), std::pair(SdoClient::State::kAborted, 0x05030000U));
  EXPECT_EQ(answered({0x80, 0x75, 0x60, 0, 0, 0, 0x02, 0x06}), std::pair(SdoClient::State::kAborted, 0x06020000U));
}

TEST(SdoClient, ADriveThatFallsSilentBetweenSegmentsIsGivenUp) {
  Rig rig;
  static_cast<void>(rig.sdo.read(kRated, ms(0)));
  rig.sdo.receive(frame(0x585, {0x41, 0x75, 0x60, 0x00, 4, 0, 0, 0}));
  static_cast<void>(rig.sdo.follow_up(ms(500)));
  EXPECT_EQ(rig.sdo.poll(ms(1500)), SdoClient::State::kWaiting);
  EXPECT_EQ(rig.sdo.poll(ms(1501)), SdoClient::State::kTimedOut);
}

TEST(SdoClient, AnObjectOfAnotherSizeIsRefused) {
  Rig rig;
  static_cast<void>(rig.sdo.read(kRated, ms(0)));
  rig.sdo.receive(frame(0x585, {0x4B, 0x75, 0x60, 0x00, 1, 0, 0, 0}));  // two bytes
  EXPECT_EQ(rig.sdo.state(), SdoClient::State::kAborted);
  EXPECT_EQ(rig.count(Anomaly::kSdoSize), 1U);
  static_cast<void>(rig.sdo.read(kRated, ms(1)));
  rig.sdo.receive(frame(0x585, {0x41, 0x75, 0x60, 0x00, 20, 0, 0, 0}));  // segments follow
  EXPECT_EQ(rig.sdo.state(), SdoClient::State::kAborted);
  EXPECT_EQ(rig.count(Anomaly::kSdoSize), 2U);
  EXPECT_EQ(rig.sdo.follow_up(ms(2)), frame(0x605, {0x80, 0x75, 0x60, 0x00, 0x10, 0x00, 0x07, 0x06}))
      << "and the drive is told that this transfer is over";
}

}  // namespace
}  // namespace capstan::cia402
