// SPDX-License-Identifier: Apache-2.0
// The small drivers of the core: tick, schedule, interrupt controller, pins, reset cause.
#include <gtest/gtest.h>

#include "capstan/hal/stm32f4/cycle_schedule.hpp"
#include "capstan/hal/stm32f4/gpio.hpp"
#include "capstan/hal/stm32f4/metered_io.hpp"
#include "capstan/hal/stm32f4/nvic.hpp"
#include "capstan/hal/stm32f4/reset_cause.hpp"
#include "capstan/hal/stm32f4/tick.hpp"
#include "capstan/tests/hal/stm32f4/fake_register.hpp"

namespace capstan::stm32f4 {
namespace {

TEST(BrownOut, IsWatchedAtLevel3OnlyAndNotInAChipAsItIsDelivered) {
  FlashRegisters<FakeRegister> flash;
  for (const auto& [option, watched] :
       {std::pair{0x0FFF'AAEDU, false}, {0x0FFF'AAE1U, true}, {0x0FFF'AAE5U, false}, {0x0FFF'AAE9U, false}}) {
    flash.optcr.value = option;
    EXPECT_EQ(brown_out_watched(flash), watched) << std::hex << option;
  }
}

TEST(Tick, CountsCoreCyclesAcrossPeriods) {
  SysTickRegisters<FakeRegister> registers;
  Tick<FakeRegister> tick(registers);
  ASSERT_TRUE(tick.start(168'000'000, 1000));
  EXPECT_EQ(registers.rvr.value, 167'999U);
  EXPECT_EQ(registers.csr.value, 7U);
  registers.cvr.value = 167'999;
  EXPECT_EQ(tick.core_cycles(), 0U);
  registers.cvr.value = 167'000;
  EXPECT_EQ(tick.core_cycles(), 999U);
  tick.rt_isr();
  tick.rt_isr();
  EXPECT_EQ(tick.count(), 2U);
  EXPECT_EQ(tick.core_cycles(), 2U * 168'000U + 999U);
}

TEST(Tick, PeriodThatEndsBetweenTheTwoReadsDoesNotJumpBack) {
  SysTickRegisters<FakeRegister> registers;
  Tick<FakeRegister> tick(registers);
  ASSERT_TRUE(tick.start(168'000'000, 1000));
  registers.cvr.on_read = [&](std::uint32_t) {
    if (registers.cvr.reads == 1) {
      tick.rt_isr();  // the counter reloads and its interrupt gets in just before the read
      return 167'990U;
    }
    return 167'980U;
  };
  EXPECT_EQ(tick.core_cycles(), 168'000U + 19U);
}

TEST(Tick, RefusesAPeriodOfMoreThan24Bits) {
  SysTickRegisters<FakeRegister> registers;
  Tick<FakeRegister> tick(registers);
  EXPECT_FALSE(tick.start(168'000'000, 10));
  EXPECT_FALSE(tick.start(1'000, 1'000));
  EXPECT_EQ(registers.csr.writes, 0U);
  EXPECT_TRUE(tick.start(16'000'000, 1'000));
}

TEST(CycleMeter, KeepsTheLastAndTheWorst) {
  CycleMeter meter;
  for (const std::uint32_t cost : {10U, 50U, 20U}) {
    meter.rt_add(cost);
  }
  EXPECT_EQ(meter.last(), 20U);
  EXPECT_EQ(meter.max(), 50U);
}

TEST(CycleSchedule, EveryPunctualTickGetsACycle) {
  CycleSchedule schedule;
  for (std::uint32_t tick = 1; tick <= 100; ++tick) {
    EXPECT_TRUE(schedule.rt_begin(tick, 300, 168'000));
  }
  EXPECT_EQ(schedule.overruns(), 0U);
}

TEST(CycleSchedule, SkippedTicksAreCountedAndNotCaughtUp) {
  CycleSchedule schedule;
  EXPECT_TRUE(schedule.rt_begin(1, 0, 168'000));
  EXPECT_TRUE(schedule.rt_begin(4, 0, 168'000));
  EXPECT_EQ(schedule.overruns(), 2U);
  EXPECT_TRUE(schedule.rt_begin(5, 0, 168'000));
  EXPECT_EQ(schedule.overruns(), 2U);
}

TEST(CycleSchedule, LateStartIsSkippedToTheNextEdge) {
  CycleSchedule schedule;
  EXPECT_TRUE(schedule.rt_begin(1, 0, 168'000));
  EXPECT_FALSE(schedule.rt_begin(2, 168'000 / 8 + 1, 168'000));
  EXPECT_EQ(schedule.overruns(), 1U);
  EXPECT_TRUE(schedule.rt_begin(3, 0, 168'000));
  EXPECT_EQ(schedule.overruns(), 1U);
}

TEST(CycleSchedule, OneEdgeGivesOneCycle) {
  CycleSchedule schedule;
  EXPECT_TRUE(schedule.rt_begin(1, 0, 168'000));
  EXPECT_FALSE(schedule.rt_begin(1, 10, 168'000));
  EXPECT_EQ(schedule.overruns(), 0U);
}

TEST(CycleSchedule, SurvivesTheWrapOfTheTickCount) {
  CycleSchedule schedule;
  EXPECT_TRUE(schedule.rt_begin(0xFFFF'FFFFU, 0, 168'000));
  const std::uint32_t before = schedule.overruns();
  EXPECT_TRUE(schedule.rt_begin(0, 0, 168'000));
  EXPECT_TRUE(schedule.rt_begin(1, 0, 168'000));
  EXPECT_EQ(schedule.overruns(), before);
}

TEST(Nvic, PriorityGoesIntoItsOwnByteOnly) {
  NvicRegisters<FakeRegister> nvic;
  nvic.ipr[9].value = 0x1122'3344;
  set_priority(nvic, Interrupt::kUsart1, Priority::kSerial);  // 37 = 4 * 9 + 1
  EXPECT_EQ(nvic.ipr[9].value, 0x1122'2044U);
}

TEST(Nvic, CycleIsLessUrgentThanSerialAndSerialLessThanTheTick) {
  EXPECT_LT(static_cast<int>(Priority::kTick), static_cast<int>(Priority::kSerial));
  EXPECT_LT(static_cast<int>(Priority::kSerial), static_cast<int>(Priority::kCycle));
  ScbRegisters<FakeRegister> scb;
  scb.shpr[2].value = 0x0000'00AB;
  set_core_priorities(scb, Priority::kCycle, Priority::kTick);
  EXPECT_EQ(scb.shpr[2].value, 0x10F0'00ABU);
}

TEST(Gpio, PinGetsItsModeAndTheOthersKeepTheirs) {
  GpioRegisters<FakeRegister> gpio;
  gpio.moder.value = 0xA800'0000;  // port A after reset: debug pins
  configure_pin(gpio, {.port = Port::kA, .number = 9, .mode = PinMode::kAlternate, .alternate = 7, .pull = Pull::kUp});
  EXPECT_EQ(gpio.moder.value, 0xA800'0000U | (2U << 18U));
  EXPECT_EQ(gpio.afr[1].value, 7U << 4U);
  EXPECT_EQ(gpio.afr[0].value, 0U);
  EXPECT_EQ(gpio.pupdr.value, 1U << 18U);
}

TEST(Gpio, AlternateFunctionIsSetBeforeTheMode) {
  GpioRegisters<FakeRegister> gpio;
  std::uint32_t function_at_switch = 0;
  gpio.moder.on_write = [&](std::uint32_t, std::uint32_t written) {
    function_at_switch = gpio.afr[0].value;
    return written;
  };
  configure_pin(gpio, {.port = Port::kB, .number = 3, .mode = PinMode::kAlternate, .alternate = 1});
  EXPECT_EQ(function_at_switch, 1U << 12U);
}

TEST(Gpio, OutputsAreSetAndResetWithoutTouchingOthers) {
  GpioRegisters<FakeRegister> gpio;
  const Pin pin{.port = Port::kC, .number = 10, .mode = PinMode::kOutput};
  set_pin(gpio, pin, true);
  EXPECT_EQ(gpio.bsrr.value, 1U << 10U);
  set_pin(gpio, pin, false);
  EXPECT_EQ(gpio.bsrr.value, 1U << 26U);
  EXPECT_EQ(gpio.odr.writes, 0U);
}

TEST(ResetCause, EveryCauseIsToldApart) {
  // What the chip really shows: the pin flag comes with every internal reset, the brown-out flag with a power-on.
  EXPECT_EQ(decode_reset_cause(0x0E00'0000), ResetCause::kPowerOn);
  EXPECT_EQ(decode_reset_cause(0x0600'0000), ResetCause::kBrownOut);
  EXPECT_EQ(decode_reset_cause(0x0400'0000), ResetCause::kPin);
  EXPECT_EQ(decode_reset_cause(0x1400'0000), ResetCause::kSoftware);
  EXPECT_EQ(decode_reset_cause(0x2400'0000), ResetCause::kIndependentWatchdog);
  EXPECT_EQ(decode_reset_cause(0x4400'0000), ResetCause::kWindowWatchdog);
  EXPECT_EQ(decode_reset_cause(0x8400'0000), ResetCause::kLowPower);
  EXPECT_EQ(decode_reset_cause(0), ResetCause::kUnknown);
}

TEST(ResetCause, TakingItRemovesTheFlagsForTheNextReset) {
  RccRegisters<FakeRegister> rcc;
  rcc.csr.value = 0x2400'0003;
  rcc.csr.on_write = [](std::uint32_t old, std::uint32_t written) {
    return (written & (1U << 24U)) != 0 ? old & 0x00FF'FFFFU : written;
  };
  EXPECT_EQ(take_reset_cause(rcc), ResetCause::kIndependentWatchdog);
  EXPECT_EQ(take_reset_cause(rcc), ResetCause::kUnknown);
}

TEST(WaitFor, GivesUpAfterExactlyItsBound) {
  FakeRegister never;
  EXPECT_FALSE(wait_for(never, 1, 1, 25));
  EXPECT_EQ(never.reads, 25U);
  FakeRegister late;
  late.on_read = [&late](std::uint32_t) { return late.reads >= 25 ? 1U : 0U; };
  EXPECT_TRUE(wait_for(late, 1, 1, 25));
}

struct SlowIo {
  static constexpr std::size_t kAxes = 1;
  auto read(Sensed<1>& in) noexcept -> Status {
    in.overruns = 5;
    *now += 70;
    return Status::kTimeout;
  }
  auto write(const Drive<1>&) noexcept -> Status {
    *now += 30;
    return Status::kOk;
  }
  void release() noexcept { ++releases; }
  std::uint32_t* now;
  int releases = 0;
};

struct FakeCounter {
  [[nodiscard]] auto core_cycles() const noexcept -> std::uint32_t { return now; }
  std::uint32_t now = 0xFFFF'FFF0;  // wraps during the test
};

TEST(MeteredIo, MeasuresTheHardwareAndPassesEverythingOn) {
  FakeCounter counter;
  SlowIo inner{.now = &counter.now};
  MeteredIo<SlowIo, FakeCounter> io(inner, counter);
  static_assert(JointIo<decltype(io)>);
  Sensed<1> in;
  EXPECT_EQ(io.read(in), Status::kTimeout);
  EXPECT_EQ(in.overruns, 5U);
  EXPECT_EQ(io.write({}), Status::kOk);
  EXPECT_EQ(io.take_spent(), 100U);
  EXPECT_EQ(io.take_spent(), 0U);
  io.release();
  EXPECT_EQ(inner.releases, 1);
}

}  // namespace
}  // namespace capstan::stm32f4
