// SPDX-License-Identifier: Apache-2.0
#include "capstan/hal/stm32f4/usart.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "capstan/tests/hal/stm32f4/fake_register.hpp"

namespace capstan::stm32f4 {
namespace {

using namespace std::string_literals;

auto bytes_of(const std::string& text) -> std::vector<std::uint8_t> {
  return {text.begin(), text.end()};
}

/// A port as in RM0090 section 30.6: reading status then data clears the receive flags; writing data makes the transmit
/// register busy until the test says that the byte has left.
class UsartPort : public testing::Test {
 protected:
  static constexpr std::size_t kRx = 8;
  static constexpr std::size_t kTx = 16;
  UsartPort() : port(registers, nvic, Interrupt::kUsart1) {
    registers.sr.value = usart::kSrTransmitEmpty;
    registers.dr.on_read = [this](std::uint32_t value) {
      registers.sr.value &= ~(usart::kSrReceived | usart::kSrOverrun | usart::kSrFraming | usart::kSrNoise);
      return value;
    };
    registers.dr.on_write = [this](std::uint32_t, std::uint32_t written) {
      sent.push_back(static_cast<char>(written));
      if (!takes_all_at_once) {
        registers.sr.value &= ~usart::kSrTransmitEmpty;
      }
      return written;
    };
    port.start(84'000'000, 115'200);
  }

  /// A byte comes in while the last one may still be unread.
  void arrive(char byte, std::uint32_t extra_flags = 0) {
    const bool unread = (registers.sr.value & usart::kSrReceived) != 0;
    if (!unread) {
      registers.dr.value = static_cast<std::uint8_t>(byte);
    }
    registers.sr.value |= usart::kSrReceived | extra_flags | (unread ? usart::kSrOverrun : 0U);
  }
  void receive(const std::string& text) {
    for (const char c : text) {
      arrive(c);
      port.rt_isr();
    }
  }
  void byte_left() { registers.sr.value |= usart::kSrTransmitEmpty; }
  [[nodiscard]] auto transmit_interrupt_on() const -> bool {
    return (registers.cr1.value & usart::kCr1TransmitInterrupt) != 0;
  }
  auto read_all() -> std::string {
    std::string text;
    std::uint8_t byte = 0;
    while (port.read(byte)) {
      text.push_back(static_cast<char>(byte));
    }
    return text;
  }

  UsartRegisters<FakeRegister> registers;
  NvicRegisters<FakeRegister> nvic;
  Usart<FakeRegister, kRx, kTx> port;
  std::string sent;
  bool takes_all_at_once = false;
};

TEST_F(UsartPort, StartSetsTheRateAndListens) {
  EXPECT_EQ(registers.brr.value, 729U);  // 84 MHz / 115200 = 729.17
  EXPECT_NE(registers.cr1.value & usart::kCr1Enable, 0U);
  EXPECT_NE(registers.cr1.value & usart::kCr1ReceiveInterrupt, 0U);
  EXPECT_FALSE(transmit_interrupt_on());
  EXPECT_EQ(nvic.iser[1].value, 1U << (37 - 32));
}

TEST_F(UsartPort, ReceivedBytesComeOutInOrder) {
  for (const char c : std::string("abc")) {
    arrive(c);
    port.rt_isr();
  }
  EXPECT_EQ(read_all(), "abc");
  EXPECT_EQ(port.errors().hardware_overruns, 0U);
}

TEST_F(UsartPort, FullRingDropsTheNewestCountsItAndMarksTheGap) {
  receive("12345678XY");
  EXPECT_EQ(read_all(), "12345678");
  EXPECT_EQ(port.errors().ring_overruns, 2U);
  receive("ab");
  EXPECT_EQ(read_all(), "\0ab"s);
  receive("cd");
  EXPECT_EQ(read_all(), "cd") << "one mark for a gap";
}

TEST_F(UsartPort, RoomForTheMarkAloneIsNoRoomForTheByteBehindIt) {
  receive("12345678X");
  std::uint8_t byte = 0;
  ASSERT_TRUE(port.read(byte));
  receive("Y");
  EXPECT_EQ(read_all(), "2345678\0"s);
  receive("Z");
  EXPECT_EQ(read_all(), "\0Z"s);
  EXPECT_EQ(port.errors().ring_overruns, 2U);
}

TEST_F(UsartPort, LateInterruptKeepsTheFirstByteCountsTheLossAndMarksIt) {
  arrive('a');
  arrive('b');
  port.rt_isr();
  EXPECT_EQ(read_all(), "a");
  EXPECT_EQ(port.errors().hardware_overruns, 1U);
  receive("c");
  EXPECT_EQ(read_all(), "\0c"s);
}

TEST_F(UsartPort, OverrunWithoutAByteStillClearsItsFlag) {
  registers.sr.value |= usart::kSrOverrun;
  port.rt_isr();
  EXPECT_EQ(registers.sr.value & usart::kSrOverrun, 0U);
  EXPECT_EQ(port.errors().hardware_overruns, 1U);
  EXPECT_EQ(read_all(), "");
}

TEST_F(UsartPort, DamagedByteIsThrownAwayCountedAndMarked) {
  arrive('a', usart::kSrFraming);
  port.rt_isr();
  arrive('b', usart::kSrNoise);
  port.rt_isr();
  EXPECT_EQ(read_all(), "");
  EXPECT_EQ(port.errors().line_errors, 2U);
  receive("cd");
  EXPECT_EQ(read_all(), "\0cd"s) << "one mark, before the next good byte";
}

TEST_F(UsartPort, ChipSendsOneByteForEachInterrupt) {
  EXPECT_EQ(port.write(bytes_of("hey")), 3U);
  EXPECT_TRUE(transmit_interrupt_on());
  port.rt_isr();
  EXPECT_EQ(sent, "h");
  port.rt_isr();  // the register is still busy
  EXPECT_EQ(sent, "h");
  for (int i = 0; i < 2; ++i) {
    byte_left();
    port.rt_isr();
  }
  EXPECT_EQ(sent, "hey");
}

TEST_F(UsartPort, TransmitInterruptGoesOffWhenNothingIsLeft) {
  static_cast<void>(port.write(bytes_of("x")));
  port.rt_isr();
  EXPECT_TRUE(transmit_interrupt_on());
  byte_left();
  port.rt_isr();
  EXPECT_FALSE(transmit_interrupt_on());
  EXPECT_NE(registers.cr1.value & usart::kCr1ReceiveInterrupt, 0U);
}

TEST_F(UsartPort, PortWithoutTransmitInterruptIsServedByThePendedOne) {
  takes_all_at_once = true;
  static_cast<void>(port.write(bytes_of("whole line")));
  EXPECT_EQ(nvic.ispr[1].value, 1U << (37 - 32));
  port.rt_isr();
  EXPECT_EQ(sent, "whole line");
}

TEST_F(UsartPort, WriteTakesWhatFitsAndSaysHowMuch) {
  EXPECT_EQ(port.write(bytes_of("0123456789abcdefXYZ")), kTx);
  EXPECT_EQ(port.write_free(), 0U);
  EXPECT_EQ(port.write(bytes_of("!")), 0U);
  port.rt_isr();
  EXPECT_EQ(port.write(bytes_of("!?")), 1U);
}

TEST(UsartRate, ErrorStaysUnderTwoPercentOnEveryClockOfTheBoard) {
  for (const std::uint32_t bus_hz : {84'000'000U, 42'000'000U, 16'000'000U}) {
    const std::uint32_t divider = baud_divider(bus_hz, 115'200);
    const double reached = static_cast<double>(bus_hz) / divider;
    EXPECT_NEAR(reached / 115'200.0, 1.0, 0.02) << bus_hz;
    EXPECT_LE(divider, 0xFFFFU);
  }
}

}  // namespace
}  // namespace capstan::stm32f4
