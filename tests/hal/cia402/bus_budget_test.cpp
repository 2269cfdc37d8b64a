// SPDX-License-Identifier: Apache-2.0
#include "capstan/hal/cia402/bus_budget.hpp"

#include <gtest/gtest.h>

namespace capstan::cia402 {
namespace {

constexpr BitRates kClassical{1'000'000, 0};
constexpr BitRates kFd{1'000'000, 5'000'000};

// can-utils' canframelen for a worst case of stuffing: 8 bytes 135 bits, 4 bytes 95, none 55.
TEST(BusBudget, LongestClassicalFramesAreThoseOfTheTextbook) {
  EXPECT_EQ(longest_frame_ns(8, false, kClassical), 135'000U);
  EXPECT_EQ(longest_frame_ns(4, false, kClassical), 95'000U);
  EXPECT_EQ(longest_frame_ns(0, false, kClassical), 55'000U);
  EXPECT_EQ(longest_frame_ns(8, false, {500'000, 0}), 270'000U);
}

// Independent estimate at 1/5 Mbit/s: 57, 73, 90, 106 and 170 us.
TEST(BusBudget, LongestFdFramesAreWithinOneMicrosecondOfTheEstimate) {
  EXPECT_NEAR(static_cast<double>(longest_frame_ns(8, true, kFd)), 57e3, 1e3);
  EXPECT_NEAR(static_cast<double>(longest_frame_ns(16, true, kFd)), 73e3, 1e3);
  EXPECT_NEAR(static_cast<double>(longest_frame_ns(24, true, kFd)), 90e3, 1e3);
  EXPECT_NEAR(static_cast<double>(longest_frame_ns(32, true, kFd)), 106e3, 1e3);
  EXPECT_NEAR(static_cast<double>(longest_frame_ns(64, true, kFd)), 170e3, 1e3);
}

// Four separate drives: 4 x 95 + 4 x 135 + 55 = 975 us; again 135 + 31 = 166 us.
TEST(BusBudget, FourDrivesOnOneClassicalBusAreRefused) {
  const BusBudget budget = bus_budget(PdoLayout::kSeparate, 4, kClassical);
  EXPECT_EQ(budget.frames, 9U);
  EXPECT_EQ(budget.cyclic_ns, 975'000U);
  EXPECT_EQ(budget.with_retransmission_ns(), 1'141'000U);
  EXPECT_FALSE(budget.fits());
}

TEST(BusBudget, TheCuresFit) {
  const BusBudget two = bus_budget(PdoLayout::kSeparate, 2, kClassical);
  EXPECT_EQ(two.cyclic_ns, 515'000U);
  EXPECT_EQ(two.with_retransmission_ns(), 681'000U);
  EXPECT_TRUE(two.fits());
  // Three packed: 3 x 2 bytes in one message, 115 + 3 x 135 + 55 = 575 us.
  const BusBudget packed = bus_budget(PdoLayout::kPacked, 3, kClassical);
  EXPECT_EQ(packed.cyclic_ns, 575'000U);
  EXPECT_TRUE(packed.fits());
  EXPECT_FALSE(bus_budget(PdoLayout::kSeparate, 3, kClassical).fits());
  EXPECT_TRUE(bus_budget(PdoLayout::kSeparate, 4, kFd).fits());
}

// Four packed: 135 + 4 x 135 + 55 = 730 us, 896 with one message again: more than 800.
TEST(BusBudget, EightyPercentIsTheLimitNotTheWholeCycle) {
  const BusBudget packed = bus_budget(PdoLayout::kPacked, 4, kClassical);
  EXPECT_EQ(packed.cyclic_ns, 730'000U);
  EXPECT_EQ(packed.with_retransmission_ns(), 896'000U);
  EXPECT_FALSE(packed.fits());
}

TEST(PdoMap, WordsAreIndexSubindexAndBits) {
  const DriveMaps separate = drive_maps(PdoLayout::kSeparate, 3, 0, 2);
  EXPECT_EQ(separate.torque.id, 0x203U);
  EXPECT_EQ(separate.torque.word(0), 0x60400010U);
  EXPECT_EQ(separate.torque.word(1), 0x60710010U);
  EXPECT_EQ(separate.torque.bytes(), 4);
  EXPECT_EQ(separate.controlword.count, 0);
  EXPECT_EQ(separate.status[0].id, 0x183U);
  EXPECT_EQ(separate.status[0].word(0), 0x60410010U);
  EXPECT_EQ(separate.status[0].word(1), 0x60640020U);
  EXPECT_EQ(separate.status[0].word(2), 0x60770010U);
  EXPECT_EQ(separate.status[0].bytes(), 8);
}

TEST(PdoMap, InAPackedMessageEachDriveSkipsWhatIsNotItsOwn) {
  const DriveMaps packed = drive_maps(PdoLayout::kPacked, 3, 1, 3);
  EXPECT_EQ(packed.torque.id, 0x200U);
  EXPECT_EQ(packed.torque.word(0), 0x00030010U);  // CiA 301: 0003h INTEGER16 is a dummy
  EXPECT_EQ(packed.torque.word(1), 0x60710010U);
  EXPECT_EQ(packed.torque.word(2), 0x00030010U);
  EXPECT_EQ(packed.torque.bytes(), 6);
  EXPECT_EQ(packed.torque.offset(object::kTargetTorque), 2U);
  EXPECT_EQ(packed.controlword.id, 0x303U);
  EXPECT_EQ(packed.controlword.word(0), 0x60400010U);
  EXPECT_EQ(packed.controlword.transmission, 255);
}

TEST(BusBudget, AStatusInTwoMessagesCostsASecondFrame) {
  std::array<DriveMaps, 2> maps = {drive_maps(PdoLayout::kSeparate, 1, 0, 2),
                                   drive_maps(PdoLayout::kSeparate, 9, 1, 2, 2)};
  EXPECT_EQ(maps[1].status[0].bytes(), 6);
  EXPECT_EQ(maps[1].status[1].id, 0x289U);
  EXPECT_EQ(maps[1].status[1].word(0), 0x60770010U);
  // SYNC 55, set values 2 x 95, status 135, 115 and 75 bits
  EXPECT_EQ(bus_budget(PdoLayout::kSeparate, maps, kClassical).cyclic_ns, 570'000U);
}

}  // namespace
}  // namespace capstan::cia402
