// SPDX-License-Identifier: Apache-2.0
#include "capstan/hal/stm32f4/flash_sectors.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "capstan/tests/hal/stm32f4/fake_register.hpp"

namespace capstan::stm32f4 {
namespace {

/// Flash as in RM0090 section 3.6: locked until both keys came in order, programming only clears bits and only while
/// the program bit and the word size are set, errors latch and block until written with 1.
class Flash : public testing::Test {
 protected:
  static constexpr std::size_t kWords = 16;
  Flash() : memory(kWords), driver(registers) {
    registers.cr.value = flash::kCrLock;
    registers.keyr.on_write = [this](std::uint32_t old, std::uint32_t key) {
      if (old == flash::kKey1 && key == flash::kKey2) {
        registers.cr.value &= ~flash::kCrLock;
      }
      return key;
    };
    registers.cr.on_write = [this](std::uint32_t old, std::uint32_t written) { return control(old, written); };
    registers.sr.on_write = write_one_to_clear(flash::kSrErrors);
    registers.sr.on_read = [this](std::uint32_t value) {
      if (busy_reads > 0) {
        --busy_reads;
        return value | flash::kSrBusy;
      }
      return value;
    };
    for (FakeRegister& word : memory) {
      word.value = 0x1234'5678;
      word.on_write = [this](std::uint32_t old, std::uint32_t written) { return program(old, written); };
    }
  }

  auto control(std::uint32_t old, std::uint32_t written) -> std::uint32_t {
    if ((old & flash::kCrLock) != 0) {
      return old;
    }
    if ((written & flash::kCrStart) != 0 && (written & flash::kCrSectorErase) != 0) {
      erased_sector = (written >> flash::kCrSectorShift) & 0xFU;
      busy_reads = 1000;
      for (FakeRegister& word : memory) {
        word.value = 0xFFFF'FFFF;
      }
    }
    return written & ~flash::kCrStart;
  }

  auto program(std::uint32_t old, std::uint32_t written) -> std::uint32_t {
    const std::uint32_t needed = flash::kCrProgram | flash::kCrWordSize;
    const bool allowed = (registers.cr.value & (needed | flash::kCrLock)) == needed;
    if (!allowed || (registers.sr.value & flash::kSrErrors) != 0) {
      registers.sr.value |= 1U << 7U;  // sequence error
      return old;
    }
    busy_reads = 20;
    return old & written;
  }

  FlashRegisters<FakeRegister> registers;
  std::vector<FakeRegister> memory;
  FlashSectors<FakeRegister> driver;
  int busy_reads = 0;
  std::uint32_t erased_sector = 99;
};

TEST_F(Flash, ErasesTheSectorAndLocksAgain) {
  EXPECT_TRUE(driver.erase(2));
  EXPECT_EQ(erased_sector, 2U);
  EXPECT_EQ(memory[5].value, 0xFFFF'FFFFU);
  EXPECT_NE(registers.cr.value & flash::kCrLock, 0U);
}

TEST_F(Flash, ProgramsErasedWordsAndLocksAgain) {
  ASSERT_TRUE(driver.erase(1));
  const std::vector<std::uint32_t> words = {0xDEAD'BEEF, 0, 42};
  EXPECT_TRUE(driver.program(memory, 4, words));
  EXPECT_EQ(memory[4].value, 0xDEAD'BEEFU);
  EXPECT_EQ(memory[5].value, 0U);
  EXPECT_EQ(memory[6].value, 42U);
  EXPECT_EQ(memory[7].value, 0xFFFF'FFFFU);
  EXPECT_NE(registers.cr.value & flash::kCrLock, 0U);
}

TEST_F(Flash, ProgrammingWithoutAnEraseIsReported) {
  const std::vector<std::uint32_t> words = {0xFFFF'0000};
  EXPECT_FALSE(driver.program(memory, 0, words));
}

TEST_F(Flash, ErrorLeftByAnEarlierAttemptDoesNotFailThisOne) {
  registers.sr.value = 1U << 7U;
  ASSERT_TRUE(driver.erase(1));
  registers.sr.value = 1U << 4U;
  const std::vector<std::uint32_t> words = {7};
  EXPECT_TRUE(driver.program(memory, 0, words));
}

TEST_F(Flash, FlashThatDoesNotUnlockIsReportedAndLeftAlone) {
  registers.keyr.on_write = nullptr;
  EXPECT_FALSE(driver.erase(1));
  EXPECT_EQ(erased_sector, 99U);
}

TEST_F(Flash, ErrorDuringAnEraseIsReported) {
  registers.cr.on_write = [this](std::uint32_t old, std::uint32_t written) {
    if ((written & flash::kCrStart) != 0) {
      registers.sr.value |= 1U << 4U;  // write protected
    }
    return control(old, written);
  };
  EXPECT_FALSE(driver.erase(1));
}

TEST_F(Flash, WordsBeyondTheSectorAreRefusedWhole) {
  ASSERT_TRUE(driver.erase(1));
  const std::vector<std::uint32_t> words = {1, 2, 3};
  EXPECT_FALSE(driver.program(memory, kWords - 2, words));
  EXPECT_EQ(memory[kWords - 2].value, 0xFFFF'FFFFU);
}

TEST_F(Flash, DataCacheIsResetOnlyWhileItIsOff) {
  registers.acr.value = flash::kAcrDataCache | 5U;
  bool reset_seen = false;
  registers.acr.on_write = [&](std::uint32_t, std::uint32_t written) {
    if ((written & flash::kAcrDataCacheReset) != 0) {
      reset_seen = true;
      EXPECT_EQ(written & flash::kAcrDataCache, 0U);
    }
    return written;
  };
  ASSERT_TRUE(driver.erase(1));
  EXPECT_TRUE(reset_seen);
  EXPECT_EQ(registers.acr.value, flash::kAcrDataCache | 5U);
}

}  // namespace
}  // namespace capstan::stm32f4
