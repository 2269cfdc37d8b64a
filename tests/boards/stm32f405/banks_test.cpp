// SPDX-License-Identifier: Apache-2.0
#include "capstan/boards/stm32f405/banks.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "capstan/boards/stm32f405/board.hpp"
#include "capstan/tests/hal/stm32f4/fake_register.hpp"

namespace capstan::stm32f405 {
namespace {

using stm32f4::FakeRegister;
namespace flash = stm32f4::flash;
namespace watchdog_bits = stm32f4::watchdog;

constexpr std::size_t kWords = 1024;

/// Flash that erases what it is told to, and notes which watchdog setting was in force meanwhile.
class BoardFlash : public testing::Test {
 protected:
  BoardFlash() : memory{std::vector<FakeRegister>(kWords), std::vector<FakeRegister>(kWords)} {
    registers.keyr.on_write = [this](std::uint32_t, std::uint32_t key) {
      if (key == flash::kKey2) {
        registers.cr.value &= ~flash::kCrLock;
      }
      return key;
    };
    registers.sr.on_write = stm32f4::write_one_to_clear(flash::kSrErrors);
    registers.cr.value = flash::kCrLock;
    registers.cr.on_write = [this](std::uint32_t, std::uint32_t written) {
      if ((written & flash::kCrStart) != 0) {
        reload_during_erase = dog.rlr.value;
        const std::uint32_t sector = (written >> flash::kCrSectorShift) & 0xFU;
        for (FakeRegister& word : memory.at(sector - 1)) {
          word.value = 0xFFFF'FFFF;
        }
      }
      return written & ~flash::kCrStart;
    };
    for (auto& bank : memory) {
      for (FakeRegister& word : bank) {
        word.on_write = [](std::uint32_t old, std::uint32_t written) { return old & written; };
      }
    }
  }

  stm32f4::FlashRegisters<FakeRegister> registers;
  stm32f4::WatchdogRegisters<FakeRegister> dog;
  stm32f4::Watchdog<FakeRegister> watchdog{dog};
  std::array<std::vector<FakeRegister>, 2> memory;
  FlashBanks<FakeRegister> banks{registers, watchdog, {std::span(memory[0]), std::span(memory[1])}};
  std::uint32_t reload_during_erase = 0;
};

TEST_F(BoardFlash, WatchdogIsLongDuringAnEraseAndShortAfterIt) {
  ASSERT_TRUE(banks.erase(0));
  EXPECT_EQ(reload_during_erase, stm32f4::kEraseWatchdog.reload);
  EXPECT_EQ(dog.rlr.value, stm32f4::kCycleWatchdog.reload);
  EXPECT_EQ(dog.pr.value, stm32f4::kCycleWatchdog.code);
}

TEST_F(BoardFlash, NothingIsErasedWhileTheWatchdogStaysShort) {
  dog.sr.on_read = [](std::uint32_t) { return watchdog_bits::kSrBusy; };
  memory[0][0].value = 5;
  EXPECT_FALSE(banks.erase(0));
  EXPECT_EQ(memory[0][0].value, 5U);
}

TEST_F(BoardFlash, BanksAreTheirOwnSectors) {
  memory[0][0].value = 5;
  ASSERT_TRUE(banks.erase(1));
  EXPECT_EQ(memory[0][0].value, 5U);
  EXPECT_EQ(memory[1][0].value, 0xFFFF'FFFFU);
}

TEST_F(BoardFlash, WhatIsWrittenIsReadBackFromAnyOffset) {
  ASSERT_TRUE(banks.erase(0));
  const std::vector<std::uint8_t> bytes = {1, 2, 3, 4, 5, 6, 7, 8};
  ASSERT_TRUE(banks.write(0, 12, bytes));
  std::vector<std::uint8_t> part(5);
  ASSERT_TRUE(banks.read(0, 13, part));
  EXPECT_EQ(part, (std::vector<std::uint8_t>{2, 3, 4, 5, 6}));
}

TEST_F(BoardFlash, HalfWordsAndPlacesBeyondTheBankAreRefused) {
  ASSERT_TRUE(banks.erase(0));
  const std::vector<std::uint8_t> word(4);
  EXPECT_FALSE(banks.write(0, 2, word));
  EXPECT_FALSE(banks.write(0, 0, std::span(word).first(3)));
  EXPECT_FALSE(banks.write(0, 4 * kWords, word));
  std::vector<std::uint8_t> out(8);
  EXPECT_FALSE(banks.read(0, 4 * kWords - 4, out));
  EXPECT_FALSE(banks.read(0, SIZE_MAX - 2, out));
}

/// Both kinds of bank under the firmware's own storage.
void expect_to_keep_a_set(Banks& banks) {
  AxisConfig saved;
  saved.limits.current_a = Q24::from_double(2.25);
  ParameterStorage storage(banks);
  for (int round = 0; round < 3; ++round) {
    saved.limits.joint_max_rad = Q24::from_int(round + 1);
    ASSERT_TRUE(storage.save(std::span(&saved, 1)));
    AxisConfig loaded;
    ASSERT_EQ(storage.load(std::span(&loaded, 1)).result, LoadResult::kLoaded);
    EXPECT_EQ(loaded.limits.current_a, saved.limits.current_a);
    EXPECT_EQ(loaded.limits.joint_max_rad, saved.limits.joint_max_rad);
  }
}

TEST_F(BoardFlash, KeepsASetOfParametersOverSeveralSaves) {
  for (auto& bank : memory) {
    for (FakeRegister& word : bank) {
      word.value = 0xFFFF'FFFF;
    }
  }
  expect_to_keep_a_set(banks);
}

TEST(RamBanks, KeepASetOfParametersOverSeveralSaves) {
  RamBanks banks;
  expect_to_keep_a_set(banks);
}

TEST(RamBanks, BehaveLikeFlash) {
  RamBanks banks;
  const std::vector<std::uint8_t> first = {0xF0};
  const std::vector<std::uint8_t> second = {0x3C};
  std::vector<std::uint8_t> out(1);
  ASSERT_TRUE(banks.write(0, 7, first));
  ASSERT_TRUE(banks.write(0, 7, second));
  ASSERT_TRUE(banks.read(0, 7, out));
  EXPECT_EQ(out[0], 0x30) << "without an erase bits can only be cleared";
  ASSERT_TRUE(banks.erase(0));
  ASSERT_TRUE(banks.read(0, 7, out));
  EXPECT_EQ(out[0], 0xFF);
  EXPECT_FALSE(banks.write(0, RamBanks::kSize, first));
  EXPECT_FALSE(banks.read(0, RamBanks::kSize, out));
}

TEST(Board, SetValueIsPreciseOnEveryClockOfTheBoard) {
  for (const std::uint32_t timer_hz : {168'000'000U, stm32f4::kInternalHz}) {
    EXPECT_GE(timer_hz / kSetValueHz, 1'000U);
    EXPECT_LE(timer_hz / kSetValueHz, 0x1'0000U);
  }
}

TEST_F(BoardFlash, AWatchdogThatTakesNothingOverIsGivenTheShortSettingAgainAndSaysSo) {
  ASSERT_TRUE(watchdog.start(stm32f4::kCycleWatchdog));
  EXPECT_TRUE(watchdog.taken());
  dog.sr.on_read = [](std::uint32_t) { return watchdog_bits::kSrBusy; };
  EXPECT_FALSE(banks.erase(0));
  EXPECT_EQ(dog.rlr.value, stm32f4::kCycleWatchdog.reload);
  EXPECT_EQ(dog.pr.value, stm32f4::kCycleWatchdog.code);
  EXPECT_FALSE(watchdog.taken());
}

}  // namespace
}  // namespace capstan::stm32f405
