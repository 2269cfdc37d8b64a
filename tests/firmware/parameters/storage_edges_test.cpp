// SPDX-License-Identifier: Apache-2.0
// Memory that fails in the middle, and sets that only just are none.
#include <gtest/gtest.h>

#include <vector>

#include "capstan/firmware/parameters/storage.hpp"
#include "capstan/tests/firmware/parameters/bank_image.hpp"
#include "capstan/tests/firmware/support.hpp"

namespace capstan {
namespace {

using test::distinct_config;
using test::FlashBanks;
using Image = test::BankImage;

using Set = std::array<AxisConfig, 2>;

auto set_of(std::uint32_t seed) -> Set {
  return {distinct_config(2 * seed), distinct_config(2 * seed + 1)};
}
auto same_set(const Set& a, const Set& b) -> bool {
  return test::same(a[0], b[0]) && test::same(a[1], b[1]);
}
auto result_of(const Image& image) -> LoadReport {
  FlashBanks banks;
  image.write(banks, 0);
  Set set{};
  return ParameterStorage(banks).load(set);
}

TEST(StorageEdges, AReadThatFailsAnywhereIsNeverASetAndNeverLooksAsIfNoneWasSaved) {
  FlashBanks banks;
  ASSERT_TRUE(ParameterStorage(banks).save(set_of(1)));
  ASSERT_TRUE(ParameterStorage(banks).save(set_of(2)));
  int refused = 0;
  for (long reads = 0;; ++reads) {
    banks.reads_left = reads;
    Set set{};
    const LoadResult result = ParameterStorage(banks).load(set).result;
    if (result == LoadResult::kLoaded) {
      EXPECT_TRUE(same_set(set, set_of(2))) << reads;
      break;
    }
    ++refused;
    ASSERT_TRUE(result == LoadResult::kUnreadable || result == LoadResult::kCorrupt) << reads;
  }
  EXPECT_GT(refused, 100) << "both headers, then entry by entry of both banks and of the newer one again";
}

TEST(StorageEdges, PowerMayGoInAnyByteOfTheKeyOrOfTheHeaderBehindIt) {
  const KeyDigest old_key = digest_of("tendon-27");
  const KeyDigest new_key = digest_of("tendon-28");
  FlashBanks banks;
  ASSERT_TRUE(ParameterStorage(banks).save(set_of(1), old_key));
  const FlashBanks before = banks;
  ASSERT_TRUE(ParameterStorage(banks).save(set_of(2), new_key));
  const long all = banks.bytes_changed - before.bytes_changed;
  constexpr long kKeyAndHeader = 4 * 8 + 20;
  for (long power = all - kKeyAndHeader; power < all; ++power) {
    FlashBanks cut = before;
    cut.power_left = power;
    EXPECT_FALSE(ParameterStorage(cut).save(set_of(2), new_key)) << power;
    Set set{};
    KeyDigest key;
    ASSERT_EQ(ParameterStorage(cut).load(set, &key).result, LoadResult::kLoaded) << power;
    EXPECT_TRUE(same_set(set, set_of(1)) && key == old_key) << power;
  }
}

TEST(StorageEdges, ADamagedBitInTheNewestSetIsReportedAndInTheOneBeforeItIsNot) {
  FlashBanks banks;
  ASSERT_TRUE(ParameterStorage(banks).save(set_of(1)));
  ASSERT_TRUE(ParameterStorage(banks).save(set_of(2), digest_of("tendon-27")));
  const std::size_t used = 20 + (2 * parameters().size() + 4) * 8;
  for (std::size_t byte = 0; byte < used; byte += byte < 20 ? 1 : 97) {
    FlashBanks aged = banks;
    aged.memory[0][byte] ^= 4;  // where the first save went
    Set set{};
    LoadReport report = ParameterStorage(aged).load(set);
    ASSERT_EQ(report.result, LoadResult::kLoaded);
    EXPECT_TRUE(same_set(set, set_of(2)));
    const bool sequence_lost = byte >= 8 && byte < 12;
    EXPECT_EQ(report.older, sequence_lost) << byte;
    aged = banks;
    aged.memory[1][byte] ^= 4;
    report = ParameterStorage(aged).load(set);
    ASSERT_EQ(report.result, LoadResult::kLoaded);
    EXPECT_TRUE(same_set(set, set_of(1)));
    EXPECT_TRUE(report.older) << byte;
    ASSERT_TRUE(ParameterStorage(aged).save(set_of(3)));
    EXPECT_FALSE(ParameterStorage(aged).load(set).older) << "a save ends it";
  }
}

TEST(StorageEdges, AMemoryThatOnlySaysItHasWrittenIsFoundAndTheOldSetStays) {
  FlashBanks banks;
  ASSERT_TRUE(ParameterStorage(banks).save(set_of(1)));
  banks.write_does_nothing = true;
  EXPECT_FALSE(ParameterStorage(banks).save(set_of(2)));
  Set set{};
  ASSERT_EQ(ParameterStorage(banks).load(set).result, LoadResult::kLoaded);
  EXPECT_TRUE(same_set(set, set_of(1)));
}

TEST(StorageEdges, MoreJointsThanABankHoldsAreRefusedBeforeAnythingIsErased) {
  FlashBanks banks;
  const std::vector<AxisConfig> many(FlashBanks::kSize / 8 / parameters().size() + 1);
  const long before = banks.bytes_changed;
  EXPECT_FALSE(ParameterStorage(banks).save(many));
  EXPECT_EQ(banks.bytes_changed, before);
}

TEST(StorageEdges, ASetThatEndsInTheMiddleOfAnEntryIsForeign) {
  Image image(1);
  image.add(0, "control.kp", Q24::from_double(3.5).raw());
  image.add_byte(0);
  EXPECT_EQ(result_of(image).result, LoadResult::kForeign);
}

TEST(StorageEdges, AValueBelowItsRangeGetsItsDefaultAndIsCounted) {
  Image image(1);
  image.add(0, "control.kp", Q24::from_double(-3.5).raw());
  const LoadReport report = result_of(image);
  EXPECT_EQ(report.result, LoadResult::kLoaded);
  EXPECT_EQ(report.out_of_range, 1U);
}

TEST(StorageEdges, AnErasedChecksumBehindSomethingElseIsNoUnfinishedSet) {
  FlashBanks banks;
  std::fill_n(banks.memory[0].begin(), 16, std::uint8_t{0});
  Set set{};
  EXPECT_EQ(ParameterStorage(banks).load(set).result, LoadResult::kCorrupt);
}

}  // namespace
}  // namespace capstan
