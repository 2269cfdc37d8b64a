// SPDX-License-Identifier: Apache-2.0
#include "capstan/hal/stm32f4/can.hpp"

#include <gtest/gtest.h>

#include "capstan/tests/hal/stm32f4/fake_can.hpp"

namespace capstan::stm32f4 {
namespace {

constexpr std::uint32_t kTiming = can_bit_timing(42'000'000, 1'000'000);

auto frame(std::uint16_t id, std::uint8_t first) -> CanFrame {
  return {.id = id, .size = 8, .data = {first, 2, 3, 4, 5, 6, 7, 8}};
}

class CanController : public testing::Test {
 protected:
  CanController() : port(chip.registers) {
    EXPECT_TRUE(port.start(kTiming, {{{0x201, 0x301, 0x401, 0x501}, {0x601, 0x601, 0x601, 0x601}}}));
  }
  auto receive(std::size_t fifo) -> std::vector<std::uint8_t> {
    std::vector<std::uint8_t> firsts;
    CanFrame one;
    while (port.rt_receive(fifo, one)) {
      firsts.push_back(one.data[0]);
    }
    return firsts;
  }
  FakeCan chip;
  Can<FakeRegister> port;
};

TEST_F(CanController, BitIs14QuantaOf3ClocksSampledAt79Percent) {
  const std::uint32_t btr = chip.registers.btr.value;
  const std::uint32_t divider = (btr & 0x3FFU) + 1;
  const std::uint32_t before = ((btr >> 16U) & 0xFU) + 1;
  const std::uint32_t behind = ((btr >> 20U) & 7U) + 1;
  EXPECT_EQ(42'000'000U / divider / (1 + before + behind), 1'000'000U);
  EXPECT_NEAR((1.0 + before) / (1 + before + behind), 0.79, 0.01);
  EXPECT_EQ(btr >> 30U, 0U) << "neither silent nor looped back";
}

TEST_F(CanController, ControllerThatDoesNotAnswerIsReportedAfterABoundedWait) {
  FakeCan dead;
  dead.enters_initialisation = false;
  Can<FakeRegister> other(dead.registers);
  EXPECT_FALSE(other.start(kTiming, {}));
  EXPECT_FALSE(other.answers());
  EXPECT_LE(dead.registers.msr.reads, 60'000U);
  EXPECT_FALSE(other.send(frame(1, 1)));
  other.poll(5);
  EXPECT_EQ(dead.registers.esr.reads, 0U);
}

TEST_F(CanController, BusThatIsNeverIdleIsReportedAndJoinedLater) {
  FakeCan busy;
  busy.joins_at_once = false;
  Can<FakeRegister> other(busy.registers);
  EXPECT_FALSE(other.start(kTiming, {}));
  EXPECT_TRUE(other.answers());
  EXPECT_LE(busy.registers.msr.reads, 60'000U);
}

TEST_F(CanController, ClockWithoutTheExactBitRateIsRefused) {
  FakeCan fresh;
  Can<FakeRegister> other(fresh.registers);
  EXPECT_FALSE(other.start(can_bit_timing(16'000'000, 1'000'000), {}));
}

TEST_F(CanController, OnlyItsOwnIdentifiersReachTheFifoTheyAreFor) {
  for (const std::uint16_t id : std::initializer_list<std::uint16_t>{0x201, 0x301, 0x601, 0x202, 0x701, 0x000, 0x7FF}) {
    chip.arrive(frame(id, static_cast<std::uint8_t>(id >> 8U)));
  }
  port.rt_isr(0);
  port.rt_isr(1);
  EXPECT_EQ(receive(0), (std::vector<std::uint8_t>{2, 3}));
  EXPECT_EQ(receive(1), (std::vector<std::uint8_t>{6}));
}

TEST_F(CanController, RemoteFrameDoesNotPassTheFilterAndWouldNotBeTaken) {
  chip.arrive(frame(0x201, 1), 2U);
  port.rt_isr(0);
  EXPECT_TRUE(receive(0).empty());
  chip.deliver(0, frame(0x201, 1), 2U);
  chip.deliver(0, frame(0x201, 1), 4U);
  port.rt_isr(0);
  EXPECT_TRUE(receive(0).empty());
  EXPECT_EQ(port.errors().foreign, 2U);
}

TEST_F(CanController, FrameComesWithItsBytesInOrderAndItsLength) {
  chip.arrive({.id = 0x201, .size = 5, .data = {9, 8, 7, 6, 5, 4, 3, 2}});
  port.rt_isr(0);
  CanFrame one;
  ASSERT_TRUE(port.rt_receive(0, one));
  EXPECT_EQ(one.id, 0x201);
  EXPECT_EQ(one.size, 5);
  EXPECT_EQ(one.data, (std::array<std::uint8_t, 8>{9, 8, 7, 6, 5, 4, 3, 2}));
}

TEST_F(CanController, OneInterruptEmptiesAFullFifo) {
  for (std::uint8_t i = 1; i <= 3; ++i) {
    chip.arrive(frame(0x201, i));
  }
  port.rt_isr(0);
  EXPECT_EQ(receive(0), (std::vector<std::uint8_t>{1, 2, 3}));
  EXPECT_EQ(port.errors().fifo_overruns, 0U);
}

TEST_F(CanController, OverrunIsCountedOnceAndItsFlagCleared) {
  for (std::uint8_t i = 1; i <= 5; ++i) {
    chip.arrive(frame(0x201, i));
  }
  port.rt_isr(0);
  EXPECT_EQ(receive(0), (std::vector<std::uint8_t>{1, 2, 5}));
  EXPECT_EQ(port.errors().fifo_overruns, 1U);
  EXPECT_EQ(chip.registers.rfr[0].value & can::kRfrOverrun, 0U);
  chip.arrive(frame(0x201, 6));
  port.rt_isr(0);
  EXPECT_EQ(receive(0), (std::vector<std::uint8_t>{6}));
  EXPECT_EQ(port.errors().fifo_overruns, 1U);
}

TEST_F(CanController, ReaderThatComesTooLateLosesTheNewestAndTheyAreCounted) {
  for (std::uint8_t i = 0; i < 20; ++i) {
    chip.arrive(frame(0x601, i));
    port.rt_isr(1);
  }
  EXPECT_EQ(receive(1).size(), 16U);
  EXPECT_EQ(port.errors().ring_overruns, 4U);
}

TEST_F(CanController, FramesLeaveInTheOrderGivenAndAFourthIsNotTaken) {
  EXPECT_NE(chip.registers.mcr.value & can::kMcrInOrder, 0U);
  for (std::uint8_t i = 1; i <= 3; ++i) {
    EXPECT_TRUE(port.can_send());
    EXPECT_TRUE(port.send(frame(0x581, i)));
  }
  EXPECT_FALSE(port.can_send());
  EXPECT_FALSE(port.send(frame(0x581, 4)));
  EXPECT_EQ(port.errors().send_full, 1U);
  chip.send_one();
  EXPECT_TRUE(port.send(frame(0x581, 5)));
  while (chip.send_one()) {
  }
  ASSERT_EQ(chip.sent.size(), 4U);
  EXPECT_EQ(chip.sent[3].data[0], 5);
  EXPECT_EQ(chip.sent[0].id, 0x581);
  EXPECT_EQ(chip.sent[0].size, 8);
  EXPECT_EQ(chip.sent[0].data, (std::array<std::uint8_t, 8>{1, 2, 3, 4, 5, 6, 7, 8}));
}

TEST_F(CanController, FrameThatNobodyAcknowledgesIsGivenUpAfterTwentyTicks) {
  port.poll(1000);
  ASSERT_TRUE(port.send(frame(0x581, 1)));
  ASSERT_TRUE(port.send(frame(0x581, 2)));
  for (std::uint32_t tick = 1001; tick < 1020; ++tick) {
    port.poll(tick);
  }
  EXPECT_FALSE(chip.order.empty());
  EXPECT_EQ(port.errors().send_lost, 0U);
  port.poll(1020);
  port.poll(1021);
  EXPECT_EQ(port.errors().send_lost, 2U);
  EXPECT_EQ(chip.registers.tsr.value & can::kTsrEmpty, can::kTsrEmpty);
  EXPECT_TRUE(chip.sent.empty());
}

TEST_F(CanController, SlowBusThatMovesLosesNothing) {
  port.poll(0);
  for (std::uint32_t tick = 1; tick < 200; ++tick) {
    static_cast<void>(port.send(frame(0x581, 1)));
    if (tick % 15 == 0) {
      chip.send_one();
    }
    port.poll(tick);
  }
  EXPECT_EQ(port.errors().send_lost, 0U);
}

TEST_F(CanController, SenderThatNeverPausesIsNotTakenForOneThatHangs) {
  port.poll(0);
  for (std::uint8_t i = 0; i < 3; ++i) {
    ASSERT_TRUE(port.send(frame(0x581, i)));
  }
  for (std::uint32_t round = 0; round < 50; ++round) {  // a mailbox is filled again before anybody looks at its result
    chip.send_one();
    ASSERT_TRUE(port.send(frame(0x581, 9)));
  }
  port.poll(50);
  port.poll(51);
  EXPECT_EQ(port.errors().send_lost, 0U);
}

TEST_F(CanController, ErrorPassiveIsCountedOncePerTimeAndTheCountersAreShown) {
  chip.registers.esr.value = (130U << 16U) | (7U << 24U) | can::kEsrPassive | 1U;
  port.poll(1);
  port.poll(2);
  EXPECT_EQ(port.errors().passive, 1U);
  EXPECT_EQ(port.transmit_errors(), 130U);
  EXPECT_EQ(port.receive_errors(), 7U);
  chip.registers.esr.value = 0;
  port.poll(3);
  chip.registers.esr.value = can::kEsrPassive;
  port.poll(4);
  EXPECT_EQ(port.errors().passive, 2U);
  EXPECT_FALSE(port.bus_off());
}

TEST_F(CanController, BusOffStaysAwayForATenthOfASecondAndThenComesBack) {
  ASSERT_TRUE(port.send(frame(0x581, 1)));
  chip.go_bus_off();
  port.poll(5000);
  EXPECT_TRUE(port.bus_off());
  EXPECT_EQ(port.errors().bus_off, 1U);
  EXPECT_FALSE(port.send(frame(0x581, 2))) << "nothing waits to be replayed when the bus is back";
  for (std::uint32_t tick = 5001; tick < 5100; ++tick) {
    port.poll(tick);
    chip.bus_is_idle();
    ASSERT_TRUE(port.bus_off()) << tick;
    ASSERT_EQ(chip.registers.mcr.value & can::kMcrInit, 0U) << tick;
  }
  port.poll(5100);
  EXPECT_NE(chip.registers.mcr.value & can::kMcrInit, 0U);
  port.poll(5101);
  EXPECT_EQ(chip.registers.mcr.value & can::kMcrInit, 0U);
  for (std::uint32_t tick = 5102; tick < 5110; ++tick) {
    port.poll(tick);
    EXPECT_TRUE(port.bus_off()) << "the bus is not idle yet";
  }
  chip.bus_is_idle();
  port.poll(5110);
  EXPECT_FALSE(port.bus_off());
  EXPECT_EQ(port.errors().bus_off, 1U);
  EXPECT_EQ(port.errors().send_lost, 1U);
  EXPECT_TRUE(chip.sent.empty());
  EXPECT_TRUE(port.send(frame(0x581, 3)));
}

TEST_F(CanController, SecondBusOffIsCountedToo) {
  for (std::uint32_t round = 0; round < 2; ++round) {
    chip.go_bus_off();
    for (std::uint32_t tick = 0; tick < 110; ++tick) {
      port.poll(1000 * round + tick);
    }
    chip.bus_is_idle();
    port.poll(1000 * round + 200);
    EXPECT_FALSE(port.bus_off());
  }
  EXPECT_EQ(port.errors().bus_off, 2U);
}

}  // namespace
}  // namespace capstan::stm32f4
