// SPDX-License-Identifier: Apache-2.0
#include "capstan/firmware/parameters/storage.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "capstan/tests/firmware/parameters/bank_image.hpp"
#include "capstan/tests/firmware/support.hpp"

namespace capstan {
namespace {

using test::distinct_config;
using test::FlashBanks;
using Image = test::BankImage;
using test::same;

constexpr std::size_t kAxes = 2;
using Set = std::array<AxisConfig, kAxes>;

auto set_of(std::uint32_t seed) -> Set {
  return {distinct_config(2 * seed), distinct_config(2 * seed + 1)};
}
auto same_set(const Set& a, const Set& b) -> bool {
  return same(a[0], b[0]) && same(a[1], b[1]);
}

auto saved(FlashBanks& banks, std::span<const AxisConfig> set) -> bool {
  return ParameterStorage(banks).save(set);
}
auto loaded(FlashBanks& banks, std::span<AxisConfig> set) -> LoadResult {
  return ParameterStorage(banks).load(set).result;
}

TEST(Storage, TheTestsOwnChecksumIsTheStandardOne) {
  const std::string digits = "123456789";
  EXPECT_EQ(Image::crc32({digits.begin(), digits.end()}), 0xCBF43926U);
}

TEST(Storage, WhatWasNeverSavedIsEmpty) {
  FlashBanks banks;
  Set set = set_of(1);
  EXPECT_EQ(loaded(banks, set), LoadResult::kEmpty);
  EXPECT_TRUE(same_set(set, set_of(1)));
}

TEST(Storage, ASavedSetLoadsWithEveryParameterOfEveryJoint) {
  FlashBanks banks;
  ASSERT_TRUE(saved(banks, set_of(1)));
  Set set{};
  ASSERT_EQ(loaded(banks, set), LoadResult::kLoaded);
  EXPECT_TRUE(same_set(set, set_of(1)));
}

TEST(Storage, AKeyIsSavedWithTheParametersAndASetWithoutOneHasNone) {
  FlashBanks banks;
  const KeyDigest key = digest_of("tendon-27");
  const Set all = set_of(1);
  ASSERT_TRUE(ParameterStorage(banks).save(all, key));
  Set set{};
  KeyDigest found;
  ASSERT_EQ(ParameterStorage(banks).load(set, &found).result, LoadResult::kLoaded);
  EXPECT_EQ(found, key);
  EXPECT_TRUE(same_set(set, all));
  ASSERT_TRUE(ParameterStorage(banks).save(all));
  ASSERT_EQ(ParameterStorage(banks).load(set, &found).result, LoadResult::kLoaded);
  EXPECT_FALSE(found.is_set());
}

TEST(Storage, ThreeHundredSavesInARowEachLoadBack) {
  FlashBanks banks;
  for (std::uint32_t i = 0; i < 300; ++i) {
    ASSERT_TRUE(saved(banks, set_of(i % 40)));
    if (i % 10 == 0) {
      Set set{};
      ASSERT_EQ(loaded(banks, set), LoadResult::kLoaded);
      ASSERT_TRUE(same_set(set, set_of(i % 40))) << i;
    }
  }
}

struct Cut {
  bool tears_last_byte;
  bool erases_backwards;
};
class StoragePowerCut : public testing::TestWithParam<Cut> {};

using OneAxis = std::array<AxisConfig, 1>;
auto one_of(std::uint32_t seed) -> OneAxis {
  OneAxis set = {distinct_config(seed)};
  set[0].coupled_to.fill(-1);  // there is no other joint
  set[0].tip.pitch = -1;
  return set;
}
auto is(const OneAxis& set, std::uint32_t seed) -> bool {
  return same(set[0], one_of(seed)[0]);
}

TEST_P(StoragePowerCut, LeavesTheOldOrTheNewSetAfterEveryByteAndSavingWorksAgain) {
  FlashBanks before;
  ASSERT_TRUE(saved(before, one_of(1)));
  ASSERT_TRUE(saved(before, one_of(2)));  // both banks are in use, so the save must erase
  FlashBanks whole = before;
  whole.bytes_changed = 0;
  ASSERT_TRUE(saved(whole, one_of(3)));
  const long cost = whole.bytes_changed;
  ASSERT_GT(cost, 8 * static_cast<long>(parameters().size()));

  int old_sets = 0;
  for (long cut = 0; cut < cost; ++cut) {
    FlashBanks banks = before;
    banks.power_left = cut;
    banks.tears_last_byte = GetParam().tears_last_byte;
    banks.erases_backwards = GetParam().erases_backwards;
    EXPECT_FALSE(saved(banks, one_of(3))) << "a save without power must not report success, cut at " << cut;
    OneAxis set{};
    ASSERT_EQ(loaded(banks, set), LoadResult::kLoaded) << "cut at " << cut;
    old_sets += is(set, 2) ? 1 : 0;
    ASSERT_TRUE(is(set, 2) || is(set, 3)) << "cut at " << cut;

    banks.power_left = -1;
    ASSERT_TRUE(saved(banks, one_of(4))) << "cut at " << cut;
    ASSERT_EQ(loaded(banks, set), LoadResult::kLoaded);
    ASSERT_TRUE(is(set, 4)) << "cut at " << cut;
  }
  EXPECT_GE(old_sets, cost - 1) << "the new set becomes valid with its last byte, not before";
}
INSTANTIATE_TEST_SUITE_P(Kinds, StoragePowerCut,
                         testing::Values(Cut{false, false}, Cut{true, false}, Cut{false, true}, Cut{true, true}));

TEST(Storage, TheVeryFirstSaveCutShortIsNeitherASetNorCorruptionAndTheNextOneWorks) {
  for (const bool torn : {false, true}) {
    FlashBanks whole;
    ASSERT_TRUE(saved(whole, set_of(1)));
    int unfinished = 0;
    for (long cut = 0; cut < whole.bytes_changed; ++cut) {
      FlashBanks banks;
      banks.power_left = cut;
      banks.tears_last_byte = torn;
      EXPECT_FALSE(saved(banks, set_of(1)));
      if (banks.memory == whole.memory) {
        continue;  // the half of the last byte that was torn had nothing left to write
      }
      Set set{};
      const LoadResult result = loaded(banks, set);
      ASSERT_TRUE(result == LoadResult::kEmpty || result == LoadResult::kUnfinished) << "cut at " << cut;
      unfinished += result == LoadResult::kUnfinished ? 1 : 0;
      banks.power_left = -1;
      ASSERT_TRUE(saved(banks, set_of(2)));
      ASSERT_EQ(loaded(banks, set), LoadResult::kLoaded);
      ASSERT_TRUE(same_set(set, set_of(2)));
    }
    EXPECT_GE(unfinished, 15) << "the cuts within the header";
  }
}

TEST(Storage, ASingleSetThatIsDamagedIsCorruptAndNotTakenForACutSave) {
  FlashBanks banks;
  ASSERT_TRUE(saved(banks, set_of(1)));
  const std::size_t bank = banks.memory[0][0] == 0xFF ? 1 : 0;
  const std::size_t length = 20 + 8 * 2 * parameters().size();
  for (std::size_t byte = 0; byte < length; ++byte) {
    for (unsigned bit = 0; bit < 8; ++bit) {
      FlashBanks damaged = banks;
      damaged.memory[bank][byte] = static_cast<std::uint8_t>(damaged.memory[bank][byte] ^ (1U << bit));
      Set set{};
      const bool last_byte_of_crc_aged = byte == 19 && (banks.memory[bank][byte] & (1U << bit)) == 0;
      ASSERT_EQ(loaded(damaged, set), last_byte_of_crc_aged ? LoadResult::kUnfinished : LoadResult::kCorrupt)
          << byte << " bit " << bit;
    }
  }
}

TEST(Storage, ADamagedBitAnywhereInTheNewSetBringsTheOldOneBack) {
  FlashBanks banks;
  ASSERT_TRUE(saved(banks, set_of(1)));
  FlashBanks only_first = banks;
  ASSERT_TRUE(saved(banks, set_of(2)));
  const std::size_t newest = banks.memory[0] == only_first.memory[0] ? 1 : 0;
  const std::size_t used = 20 + kAxes * parameters().size() * 8;
  for (std::size_t byte = 0; byte < used; ++byte) {
    for (unsigned bit = byte < 20 ? 0U : byte % 8; bit < 8; bit += byte < 20 ? 1 : 8) {
      FlashBanks damaged = banks;
      damaged.memory[newest][byte] = static_cast<std::uint8_t>(damaged.memory[newest][byte] ^ (1U << bit));
      Set set{};
      ASSERT_EQ(loaded(damaged, set), LoadResult::kLoaded) << byte;
      ASSERT_TRUE(same_set(set, set_of(1))) << "byte " << byte << " bit " << bit;
    }
  }
}

TEST(Storage, TwoBrokenBanksAreReportedAsCorrupt) {
  FlashBanks banks;
  ASSERT_TRUE(saved(banks, set_of(1)));
  ASSERT_TRUE(saved(banks, set_of(2)));
  banks.memory[0][100] ^= 1U;
  banks.memory[1][200] ^= 1U;
  Set set{};
  EXPECT_EQ(loaded(banks, set), LoadResult::kCorrupt);
}

TEST(Storage, GarbageInBothBanksIsCorruptAndASaveCuresIt) {
  FlashBanks banks;
  std::uint32_t noise = 1;
  for (auto& bank : banks.memory) {
    for (std::uint8_t& cell : bank) {
      noise = noise * 1664525U + 1013904223U;
      cell = static_cast<std::uint8_t>(noise >> 24);
    }
  }
  Set set{};
  EXPECT_EQ(loaded(banks, set), LoadResult::kCorrupt);
  EXPECT_TRUE(saved(banks, set_of(5)));
  ASSERT_EQ(loaded(banks, set), LoadResult::kLoaded);
  EXPECT_TRUE(same_set(set, set_of(5)));
}

TEST(Storage, UnknownAndImpossibleEntriesAreIgnoredAndTheOthersLoad) {
  FlashBanks banks;
  Image image(1);
  image.add_hash(0xDEADBEEF, 42);
  image.add(0, "control.kp", Q24::from_double(3.5).raw());
  image.add(0, "control.ki", Q24::from_double(101.0).raw());  // above its range
  image.add(1, "control.kp", Q24::from_double(4.5).raw());
  image.add(9, "control.kp", Q24::from_double(5.5).raw());  // no such joint
  image.write(banks, 0);
  Set set{};
  ASSERT_EQ(loaded(banks, set), LoadResult::kLoaded);
  EXPECT_EQ(set[0].control.kp, Q24::from_double(3.5));
  EXPECT_EQ(set[1].control.kp, Q24::from_double(4.5));
  EXPECT_EQ(set[0].control.ki_per_s, AxisConfig{}.control.ki_per_s);
}

TEST(Storage, AJointThatCanNotBeMeantIsLeftOutOfAStoredSetAndCounted) {
  FlashBanks banks;
  Image image(1);
  image.add(0, "axis_coupling.joint", 0);    // itself
  image.add(0, "axis_coupling.joint_2", 1);  // the other
  image.add(1, "axis_coupling.joint", 2);    // of two joints
  image.add(1, "tip.pitch", 1);
  image.write(banks, 0);
  Set set{};
  const LoadReport report = ParameterStorage(banks).load(set);
  ASSERT_EQ(report.result, LoadResult::kLoaded);
  EXPECT_EQ(report.out_of_range, 3U);
  EXPECT_EQ(set[0].coupled_to, (std::array<std::int32_t, 3>{-1, 1, -1}));
  EXPECT_EQ(set[1].coupled_to, (std::array<std::int32_t, 3>{-1, -1, -1}));
  EXPECT_EQ(set[1].tip.pitch, -1);
}

TEST(Storage, AFractionOfAKnotThatWasStoredOnceIsReadAsItsLawReadIt) {
  FlashBanks banks;
  Image image(1);
  image.add(0, "table.knots", Q24::from_double(2.5).raw());
  image.add(0, "table.factor", Q24::from_double(1.25).raw());
  image.write(banks, 0);
  Set set{};
  const LoadReport report = ParameterStorage(banks).load(set);
  ASSERT_EQ(report.result, LoadResult::kLoaded);
  EXPECT_EQ(report.out_of_range, 0U);
  EXPECT_EQ(raw_value(set[0], *find_parameter("table.knots")), Q24::from_int(3).raw());
  EXPECT_EQ(raw_value(set[0], *find_parameter("table.factor")), Q24::from_int(1).raw());
}

TEST(Storage, ValuesThatDoNotGoTogetherAreCorruptAndNotUsed) {
  FlashBanks banks;
  Image image(1);
  image.add(0, "limits.motor_min", Q24::from_int(5).raw());
  image.add(0, "limits.motor_max", Q24::from_int(-5).raw());
  image.write(banks, 0);
  Set set{};
  EXPECT_EQ(loaded(banks, set), LoadResult::kCorrupt);
}

TEST(Storage, TheSequenceNumberMayWrap) {
  FlashBanks banks;
  Image image(0xFFFFFFFFU);
  image.add(0, "control.kp", Q24::from_double(3.5).raw());
  image.write(banks, 0);
  ASSERT_TRUE(saved(banks, set_of(1)));
  Set set{};
  ASSERT_EQ(loaded(banks, set), LoadResult::kLoaded);
  EXPECT_TRUE(same_set(set, set_of(1)));
}

TEST(Storage, ASaveThatTheMemoryRefusesIsReportedAndTheOldSetStays) {
  FlashBanks banks;
  ASSERT_TRUE(saved(banks, set_of(1)));
  banks.write_fails = true;
  EXPECT_FALSE(saved(banks, set_of(2)));
  Set set{};
  ASSERT_EQ(loaded(banks, set), LoadResult::kLoaded);
  EXPECT_TRUE(same_set(set, set_of(1)));
}

/// A set as a firmware of half as many parameters would have stored it: some that are still there, one that has another
/// name today, and one that today's range does not take.
auto older_set(std::uint32_t sequence) -> Image {
  Image image(sequence);
  for (std::uint8_t axis = 0; axis < kAxes; ++axis) {
    image.add(axis, "motor.encoder_counts", 8192);
    image.add(axis, "control.kp", Q24::from_double(3.5).raw());
    image.add(axis, "limits.following_time", Q24::from_double(11.0).raw());   // today up to 10 s
    image.add(axis, "control.servo_stiffness", Q24::from_double(7.0).raw());  // today control.stiffness
    image.add(axis, "limits.joint_max", Q24::from_double(1.25).raw());
  }
  return image;
}

TEST(StorageMigration, AnOlderSetCarriesOverWhatItHasAndTheRestGetsItsDefaultAndIsCounted) {
  FlashBanks banks;
  older_set(3).write(banks, 1);
  Set set{};
  const LoadReport report = ParameterStorage(banks).load(set);
  ASSERT_EQ(report.result, LoadResult::kLoaded);
  Set wanted{};
  for (AxisConfig& axis : wanted) {
    axis.motor.encoder_counts_per_turn = 8192;
    axis.control.kp = Q24::from_double(3.5);
    axis.limits.joint_max_rad = Q24::from_double(1.25);
  }
  EXPECT_TRUE(same_set(set, wanted));
  EXPECT_TRUE(report.migrated());
  EXPECT_EQ(report.unknown, 2);
  EXPECT_EQ(report.out_of_range, 2);
  EXPECT_EQ(report.absent, 2 * (parameters().size() - 4));
  ASSERT_NE(report.first_default, nullptr);
}

TEST(StorageMigration, ASetOfThisVersionHasNothingToReportWithAKeyOrWithout) {
  FlashBanks banks;
  const Set all = set_of(1);
  for (const KeyDigest& key : {KeyDigest{}, digest_of("tendon-27")}) {
    ASSERT_TRUE(ParameterStorage(banks).save(all, key));
    Set set{};
    EXPECT_FALSE(ParameterStorage(banks).load(set).migrated());
  }
}

TEST(StorageMigration, ANewerFormatIsRefusedEvenBesideAnOlderSetAndIsNoCorruption) {
  FlashBanks banks;
  older_set(3).write(banks, 0);
  Image newer(4, 2);
  newer.add(0, "control.kp", Q24::from_double(1.5).raw());
  newer.add_byte(0x5A);  // whatever its entries look like
  newer.write(banks, 1);
  Set set{};
  const LoadReport report = ParameterStorage(banks).load(set);
  EXPECT_EQ(report.result, LoadResult::kForeign);
  EXPECT_EQ(report.format, 2U);
  // A save takes the bank of the older set, and is the newest from then on; the foreign one stays where it is.
  const auto foreign = banks.memory[1];
  ASSERT_TRUE(saved(banks, set_of(7)));
  EXPECT_EQ(banks.memory[1], foreign);
  ASSERT_EQ(loaded(banks, set), LoadResult::kLoaded);
  EXPECT_TRUE(same_set(set, set_of(7)));
}

TEST(StorageMigration, AnotherFormatWhoseChecksumIsWrongIsCorrupt) {
  FlashBanks banks;
  Image newer(4, 2);
  newer.add(0, "control.kp", 1);
  newer.write(banks, 0);
  banks.memory[0][22] ^= 1U;
  Set set{};
  EXPECT_EQ(loaded(banks, set), LoadResult::kCorrupt);
}

TEST(StorageMigration, PowerMayGoAtAnyByteOfTheFirstSaveAfterIt) {
  FlashBanks before;
  older_set(3).write(before, 0);
  FlashBanks whole = before;
  ASSERT_TRUE(saved(whole, set_of(1)));
  for (long cut = 0; cut < whole.bytes_changed; ++cut) {
    FlashBanks banks = before;
    banks.power_left = cut;
    static_cast<void>(saved(banks, set_of(1)));
    Set set{};
    ASSERT_EQ(loaded(banks, set), LoadResult::kLoaded) << cut;
    ASSERT_EQ(set[0].motor.encoder_counts_per_turn, 8192)
        << "the old one, for the new one lacks its last byte, " << cut;
  }
}

}  // namespace
}  // namespace capstan
