// SPDX-License-Identifier: Apache-2.0
#include "capstan/hal/stm32f4/clocks.hpp"

#include <gtest/gtest.h>

#include <string>

#include "capstan/tests/hal/stm32f4/fake_register.hpp"

namespace capstan::stm32f4 {
namespace {

/// Clock control with the ready flags of RM0090 section 7.3: each follows its enable bit, if the part is healthy.
class Clocks : public testing::Test {
 protected:
  Clocks() {
    rcc.cr.on_read = [this](std::uint32_t value) { return value | ready_flags(value); };
    rcc.cfgr.on_write = [this](std::uint32_t, std::uint32_t written) {
      switched_with_latency = flash.acr.value & flash::kAcrLatencyMask;
      const std::uint32_t wanted = written & rcc::kCfgrSwitchMask;
      return (written & ~rcc::kCfgrStatusMask) | (pll_locks ? wanted << 2U : 0U);
    };
    rcc.pllcfgr.on_write = [this](std::uint32_t, std::uint32_t written) {
      pll_written_while_on = pll_written_while_on || (rcc.cr.value & rcc::kCrPllOn) != 0;
      return written;
    };
  }

  [[nodiscard]] auto ready_flags(std::uint32_t enables) const -> std::uint32_t {
    const bool crystal = crystal_starts && (enables & rcc::kCrHseOn) != 0;
    const bool source = (rcc.pllcfgr.value & rcc::kPllSourceHse) == 0 || crystal;
    const bool pll = pll_locks && source && (enables & rcc::kCrPllOn) != 0;
    return ((enables & rcc::kCrHsiOn) != 0 ? rcc::kCrHsiReady : 0U) | (crystal ? rcc::kCrHseReady : 0U) |
           (pll ? rcc::kCrPllReady : 0U);
  }

  auto start() -> ClockStatus { return start_clocks(rcc, power, flash); }

  RccRegisters<FakeRegister> rcc;
  PowerRegisters<FakeRegister> power;
  FlashRegisters<FakeRegister> flash;
  bool crystal_starts = true;
  bool pll_locks = true;
  bool pll_written_while_on = false;
  std::uint32_t switched_with_latency = 0;
};

TEST_F(Clocks, HealthyBoardRunsAt168MHzFromTheCrystal) {
  const ClockStatus status = start();
  EXPECT_EQ(status.source, ClockSource::kCrystalPll);
  EXPECT_FALSE(status.is_fault());
  EXPECT_FALSE(status.fell_back());
  EXPECT_EQ(status.core_hz, 168'000'000U);
  EXPECT_EQ(status.apb1_hz, 42'000'000U);
  EXPECT_EQ(status.apb2_hz, 84'000'000U);
  EXPECT_EQ(status.timer_hz(status.apb2_hz), 168'000'000U);
  EXPECT_EQ(rcc.pllcfgr.value & 0x3FU, 8U);
  EXPECT_EQ((rcc.pllcfgr.value >> 6U) & 0x1FFU, 336U);
  EXPECT_EQ((rcc.pllcfgr.value >> 16U) & 3U, 0U);
  EXPECT_NE(rcc.pllcfgr.value & rcc::kPllSourceHse, 0U);
  EXPECT_EQ((rcc.cfgr.value >> 10U) & 7U, 5U);
  EXPECT_EQ((rcc.cfgr.value >> 13U) & 7U, 4U);
}

TEST_F(Clocks, InternalOscillatorThatABootLoaderSwitchedOffIsSwitchedOn) {
  rcc.cr.value = rcc::kCrHseOn;
  EXPECT_EQ(start().source, ClockSource::kCrystalPll);
  EXPECT_NE(rcc.cr.value & rcc::kCrHsiOn, 0U);
}

TEST_F(Clocks, WaitStatesAndVoltageAreSetBeforeTheClockIsRaised) {
  static_cast<void>(start());
  EXPECT_EQ(switched_with_latency, 5U);
  EXPECT_NE(power.cr.value & power::kCrScale1, 0U);
}

TEST_F(Clocks, CrystalIsGuardedOnceItIsUsed) {
  static_cast<void>(start());
  EXPECT_NE(rcc.cr.value & rcc::kCrSecurityOn, 0U);
}

TEST_F(Clocks, DeadCrystalEndsOnTheInternalOscillatorAsAFault) {
  crystal_starts = false;
  const ClockStatus status = start();
  EXPECT_EQ(status.source, ClockSource::kInternalPll);
  EXPECT_TRUE(status.is_fault());
  EXPECT_TRUE(status.fell_back());
  EXPECT_EQ(status.core_hz, 168'000'000U);
  EXPECT_EQ(rcc.pllcfgr.value & 0x3FU, 16U);
  EXPECT_EQ(rcc.pllcfgr.value & rcc::kPllSourceHse, 0U);
  EXPECT_EQ(rcc.cr.value & (rcc::kCrHseOn | rcc::kCrSecurityOn), 0U);
  EXPECT_NE(std::string(describe(status.source)).find("crystal"), std::string::npos);
}

TEST_F(Clocks, DeadPllLeavesTheSlowClockWithUndividedBuses) {
  pll_locks = false;
  const ClockStatus status = start();
  EXPECT_EQ(status.source, ClockSource::kInternal);
  EXPECT_TRUE(status.fell_back());
  EXPECT_EQ(status.core_hz, 16'000'000U);
  EXPECT_EQ(status.apb1_hz, 16'000'000U);
  EXPECT_EQ(status.timer_hz(status.apb1_hz), 16'000'000U);
  EXPECT_EQ(rcc.cfgr.value & (rcc::kCfgrPrescalerMask | rcc::kCfgrSwitchMask), 0U);
}

TEST_F(Clocks, PllSettingIsNeverWrittenWhileThePllRuns) {
  rcc.cr.value |= rcc::kCrPllOn;  // a boot loader left it on
  static_cast<void>(start());
  EXPECT_FALSE(pll_written_while_on);
}

TEST_F(Clocks, ClockStaysSlowWhenTheWaitStatesDoNotStick) {
  flash.acr.on_read = [](std::uint32_t) { return 0U; };
  const ClockStatus status = start();
  EXPECT_EQ(status.source, ClockSource::kInternal);
  EXPECT_EQ(rcc.cfgr.writes, 0U);
}

TEST(ClocksAbsent, ControlThatReadsZeroIsReportedAfterABoundedWait) {
  RccRegisters<FakeRegister> rcc;
  PowerRegisters<FakeRegister> power;
  FlashRegisters<FakeRegister> flash;
  rcc.cr.on_read = [](std::uint32_t) { return 0U; };
  const ClockBounds bounds{.internal_polls = 17, .crystal_polls = 5, .pll_polls = 5};
  const ClockStatus status = start_clocks(rcc, power, flash, bounds);
  EXPECT_EQ(status.source, ClockSource::kNotAnswering);
  EXPECT_TRUE(status.is_fault());
  EXPECT_FALSE(status.fell_back()) << "an emulator is no oscillator";
  EXPECT_EQ(status.core_hz, 168'000'000U);
  EXPECT_LE(rcc.cr.reads, 1U + 17U);
}

TEST_F(Clocks, CrystalGetsExactlyItsBoundOfPolls) {
  crystal_starts = false;
  pll_locks = false;
  const ClockBounds bounds{.internal_polls = 3, .crystal_polls = 500, .pll_polls = 7};
  static_cast<void>(start_clocks(rcc, power, flash, bounds));
  EXPECT_GE(rcc.cr.reads, 500U);
  EXPECT_LE(rcc.cr.reads, 500U + 3U + 4U * 7U + 10U);
}

TEST(ClockTexts, EveryFaultHasASentenceAndHealthHasNone) {
  EXPECT_STREQ(describe(ClockSource::kCrystalPll), "");
  for (const auto source : {ClockSource::kInternalPll, ClockSource::kInternal, ClockSource::kNotAnswering}) {
    EXPECT_GT(std::string(describe(source)).size(), 40U);
  }
}

}  // namespace
}  // namespace capstan::stm32f4
