// SPDX-License-Identifier: Apache-2.0
#include "capstan/hal/stm32f4/watchdog.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "capstan/tests/hal/stm32f4/fake_register.hpp"

namespace capstan::stm32f4 {
namespace {

auto seconds(const WatchdogSetting& setting, double oscillator_hz) -> double {
  return (setting.reload + 1.0) * std::pow(2.0, 2.0 + setting.code) / oscillator_hz;
}

TEST(WatchdogArithmetic, CycleSettingHoldsAtBothEndsOfTheOscillator) {
  EXPECT_LE(seconds(kCycleWatchdog, 17e3), 0.030);
  EXPECT_GE(seconds(kCycleWatchdog, 47e3), 0.010);
}

TEST(WatchdogArithmetic, SettingIsTheLongestThatKeepsTheLimit) {
  for (const std::uint32_t limit_us : {1'000U, 12'345U, 30'000U, 500'000U, 1'000'000U, 10'000'000U}) {
    const WatchdogSetting setting = watchdog_setting_within(limit_us);
    EXPECT_LE(seconds(setting, 17e3), limit_us * 1e-6) << limit_us;
    const WatchdogSetting longer{.code = setting.code, .reload = setting.reload + 1};
    EXPECT_GT(seconds(longer, 17e3), limit_us * 1e-6) << limit_us;
    EXPECT_LE(setting.reload, 0xFFFU);
    EXPECT_LE(setting.code, 6U);
  }
}

TEST(WatchdogArithmetic, FinestDividerIsTakenUpToItsLastCount) {
  const WatchdogSetting full = watchdog_setting_within(963'765);  // 4 * 4096 periods at 17 kHz, rounded up
  EXPECT_EQ(full.code, 0U);
  EXPECT_EQ(full.reload, 0xFFFU);
  EXPECT_EQ(watchdog_setting_within(964'100).code, 1U);
}

TEST(WatchdogArithmetic, LimitBeyondTheHardwareGivesTheLongestThereIs) {
  const WatchdogSetting setting = watchdog_setting_within(4'000'000'000U);
  EXPECT_EQ(setting.code, 6U);
  EXPECT_EQ(setting.reload, 0xFFFU);
}

TEST(WatchdogArithmetic, TimesRoundToTheSafeSide) {
  for (std::uint32_t reload = 0; reload < 4096; reload += 37) {
    const WatchdogSetting setting{.code = 3, .reload = reload};
    EXPECT_GE(setting.longest_us(), seconds(setting, 17e3) * 1e6 - 1e-6);
    EXPECT_LE(setting.shortest_us(), seconds(setting, 47e3) * 1e6 + 1e-6);
  }
}

TEST(WatchdogArithmetic, EraseSettingOutlastsTheSlowestErase) {
  EXPECT_GE(seconds(kEraseWatchdog, 47e3), 1.6);
}

class WatchdogDriver : public testing::Test {
 protected:
  WatchdogDriver() {
    registers.kr.on_write = [this](std::uint32_t, std::uint32_t key) {
      keys.push_back(key);
      unlocked = key == 0x5555;
      return key;
    };
    const auto guarded = [this](std::uint32_t old, std::uint32_t written) { return unlocked ? written : old; };
    registers.pr.on_write = guarded;
    registers.rlr.on_write = guarded;
  }
  WatchdogRegisters<FakeRegister> registers;
  std::vector<std::uint32_t> keys;
  bool unlocked = false;
};

TEST_F(WatchdogDriver, StartUnlocksSetsAndRefreshes) {
  registers.sr.on_read = [this](std::uint32_t) { return registers.sr.reads < 40 ? 3U : 0U; };  // takes a while
  Watchdog<FakeRegister> watchdog(registers);
  EXPECT_TRUE(watchdog.start(kCycleWatchdog));
  EXPECT_EQ(keys, (std::vector<std::uint32_t>{0xCCCC, 0x5555, 0xAAAA}));
  EXPECT_EQ(registers.pr.value, kCycleWatchdog.code);
  EXPECT_EQ(registers.rlr.value, kCycleWatchdog.reload);
}

TEST_F(WatchdogDriver, SettingThatNeverArrivesIsReportedAndTheDogStillRuns) {
  registers.sr.on_read = [](std::uint32_t) { return 1U; };
  Watchdog<FakeRegister> watchdog(registers);
  EXPECT_FALSE(watchdog.start(kCycleWatchdog));
  EXPECT_EQ(keys.front(), 0xCCCCU);
  EXPECT_EQ(keys.back(), 0xAAAAU);
}

TEST_F(WatchdogDriver, RefreshNeitherUnlocksNorChangesAnything) {
  Watchdog<FakeRegister> watchdog(registers);
  watchdog.rt_refresh();
  EXPECT_EQ(keys, (std::vector<std::uint32_t>{0xAAAA}));
  EXPECT_EQ(registers.pr.writes + registers.rlr.writes, 0U);
}

TEST_F(WatchdogDriver, RefreshByTheCycleAtAnyMomentOfAChangeDoesNotLoseTheSetting) {
  for (const WatchdogSetting& setting : {kEraseWatchdog, kCycleWatchdog}) {
    for (int moment = 0; moment < 5; ++moment) {
      Watchdog<FakeRegister> watchdog(registers);
      const auto interrupt_before = [&](int which) {
        return [this, &watchdog, which, moment](std::uint32_t old, std::uint32_t written) {
          if (moment == which) {
            watchdog.rt_refresh();
          }
          return unlocked ? written : old;
        };
      };
      registers.pr.on_write = interrupt_before(0);
      registers.rlr.on_write = interrupt_before(1);
      registers.sr.on_read = [&](std::uint32_t) {
        if (moment == 2) {
          watchdog.rt_refresh();
        }
        return 0U;
      };
      registers.pr.value = registers.rlr.value = 7;
      EXPECT_TRUE(watchdog.change(setting));
      EXPECT_EQ(registers.pr.value, setting.code) << moment;
      EXPECT_EQ(registers.rlr.value, setting.reload) << moment;
      keys.clear();
      watchdog.rt_refresh();
      EXPECT_EQ(keys, (std::vector<std::uint32_t>{0xAAAA})) << "and refreshes work again";
    }
  }
}

TEST_F(WatchdogDriver, ChangeForAnEraseDoesNotStartAStoppedDog) {
  Watchdog<FakeRegister> watchdog(registers);
  EXPECT_TRUE(watchdog.change(kEraseWatchdog));
  EXPECT_EQ(keys, (std::vector<std::uint32_t>{0x5555, 0xAAAA}));
  EXPECT_EQ(registers.rlr.value, kEraseWatchdog.reload);
}

}  // namespace
}  // namespace capstan::stm32f4
