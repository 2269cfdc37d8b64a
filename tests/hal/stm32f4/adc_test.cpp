// SPDX-License-Identifier: Apache-2.0
#include "capstan/hal/stm32f4/adc.hpp"

#include <gtest/gtest.h>

#include "capstan/tests/hal/stm32f4/fake_analogue.hpp"

namespace capstan::stm32f4 {
namespace {

class Scan : public testing::Test {
 protected:
  static constexpr std::size_t kChannels = 5;
  Scan() : scan(chip.adc1, chip.adc_common, chip.dma2) {
    chip.memory_neighbour = &scan;
    scan.start({10, 11, 12, 13, 14});
    for (std::size_t i = 0; i < kChannels; ++i) {
      chip.channel_values[10 + i] = 100 * static_cast<std::uint32_t>(i + 1);
    }
  }
  auto take() -> bool {
    chip.millisecond_passes();
    scan.rt_begin();
    return scan.rt_finish(raw);
  }
  const std::array<std::uint32_t, kChannels> all_{100, 200, 300, 400, 500};
  FakeAnalogue chip;
  AdcScan<FakeRegister, kChannels> scan;
  std::array<std::uint32_t, kChannels> raw{};
};

TEST_F(Scan, StreamIsChannel0OfDma2Stream0InWordsFromTheDataRegister) {
  const auto& stream = chip.dma2.stream[0];
  EXPECT_EQ(stream.cr.value >> 25U, 0U);                // CHSEL
  EXPECT_EQ((stream.cr.value >> 11U) & 0xFU, 0b1010U);  // PSIZE and MSIZE: words
  EXPECT_EQ((stream.cr.value >> 6U) & 3U, 0U);          // from peripheral to memory
  EXPECT_EQ((stream.cr.value >> 8U) & 7U, 0b101U);      // circular, memory increments, peripheral does not
  EXPECT_EQ(stream.cr.value & 1U, 1U);
  EXPECT_EQ(stream.ndtr.value, 5U);
  EXPECT_EQ(stream.par.value, static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(&chip.adc1.dr)));
}

TEST_F(Scan, SequenceAndSamplingTimesAreThoseOfItsChannels) {
  EXPECT_EQ(chip.adc1.sqr[0].value, 4U << 20U);
  EXPECT_EQ(chip.adc1.sqr[2].value, 10U | 11U << 5U | 12U << 10U | 13U << 15U | 14U << 20U);
  EXPECT_EQ(chip.adc1.smpr[0].value, 0b010'010'010'010'010U);
  EXPECT_EQ(chip.adc1.smpr[1].value, 0U);
  EXPECT_EQ(chip.adc1.cr1.value, 1U << 8U);
}

TEST_F(Scan, EveryCycleBringsFreshResultsInOrder) {
  for (int cycle = 0; cycle < 5; ++cycle) {
    chip.channel_values[12] = 300 + static_cast<std::uint32_t>(cycle);
    ASSERT_TRUE(take()) << cycle;
    EXPECT_EQ(raw[0], 100U);
    EXPECT_EQ(raw[2], 300U + static_cast<std::uint32_t>(cycle));
    EXPECT_EQ(raw[4], 500U);
  }
  EXPECT_EQ(scan.failures(), 0U);
}

TEST_F(Scan, ConverterThatNeverAnswersCostsABoundedWaitAndNoOldValueIsTaken) {
  ASSERT_TRUE(take());
  chip.converter_answers = false;
  raw.fill(7);
  const std::uint32_t before = chip.dma2.isr[0].reads;
  EXPECT_FALSE(take());
  EXPECT_LE(chip.dma2.isr[0].reads - before, 700U);
  EXPECT_EQ(raw[0], 7U);
  chip.converter_answers = true;
  EXPECT_TRUE(take());
  EXPECT_EQ(raw, all_);
}

TEST_F(Scan, OverrunLosesOneSnapshotAndTheOrderIsRightAgainAfterIt) {
  chip.overrun_at = 2;  // two results are in memory, three are not: without mending all would be shifted for ever
  EXPECT_FALSE(take());
  EXPECT_TRUE(take());
  EXPECT_EQ(raw, all_);
  EXPECT_EQ(scan.failures(), 1U);
}

TEST_F(Scan, OverrunOfTheLastResultIsSeenAlthoughTheTransfersBeforeItWentWell) {
  chip.overrun_at = 4;
  EXPECT_FALSE(take());
  EXPECT_TRUE(take());
}

TEST_F(Scan, NothingIsConvertedBeforeTheConverterHasSettled) {
  for (int failure = 0; failure < 3; ++failure) {
    chip.overrun_at = failure == 0 ? std::optional<std::size_t>(1) : std::nullopt;
    chip.transfer_error_next = failure == 1;
    chip.converter_answers = failure != 2;
    EXPECT_FALSE(take());
    chip.converter_answers = true;
    EXPECT_TRUE(take());
    EXPECT_EQ(raw, all_) << failure;
  }
  EXPECT_EQ(chip.unsettled_conversions, 0);
}

TEST_F(Scan, TransferErrorSwitchesTheStreamOffAndTheNextCycleOnAgain) {
  chip.transfer_error_next = true;
  EXPECT_FALSE(take());
  EXPECT_TRUE(take());
  EXPECT_EQ(raw, all_);
}

TEST_F(Scan, StreamThatStaysOnIsMissingUntilItLetsGo) {
  chip.stream_stays_on = true;
  chip.overrun_at = 0;
  EXPECT_FALSE(take());
  const std::uint32_t before = chip.dma2.stream[0].cr.reads;
  EXPECT_FALSE(take());
  EXPECT_LE(chip.dma2.stream[0].cr.reads - before, 700U);
  chip.stream_stays_on = false;
  EXPECT_FALSE(take()) << "set up now; the converter settles until the next cycle";
  EXPECT_TRUE(take());
  EXPECT_EQ(raw, all_);
  EXPECT_EQ(scan.failures(), 3U);
}

}  // namespace
}  // namespace capstan::stm32f4
