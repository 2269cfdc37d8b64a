// SPDX-License-Identifier: Apache-2.0
#include "capstan/firmware/safety/maintenance.hpp"

#include <gtest/gtest.h>

#include <string>

namespace capstan {
namespace {

using Hash = std::array<std::uint32_t, 8>;
constexpr std::uint32_t kNow = 0xFFFFFF00U;  // the time wraps soon after
using Attempt = Maintenance::Attempt;

// Expected values: FIPS 180-4's examples, and coreutils' sha256sum.
TEST(Sha256, GivesTheStandardsExamples) {
  EXPECT_EQ(sha256("abc"),
            (Hash{0xba7816bf, 0x8f01cfea, 0x414140de, 0x5dae2223, 0xb00361a3, 0x96177a9c, 0xb410ff61, 0xf20015ad}));
  EXPECT_EQ(sha256(""),
            (Hash{0xe3b0c442, 0x98fc1c14, 0x9afbf4c8, 0x996fb924, 0x27ae41e4, 0x649b934c, 0xa495991b, 0x7852b855}));
  EXPECT_EQ(sha256("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
            (Hash{0x248d6a61, 0xd20638b8, 0xe5c02693, 0x0c3e6039, 0xa33ce459, 0x64ff2167, 0xf6ecedd4, 0x19db06c1}));
}

TEST(Sha256, GoesOnOverBlocksWhateverRemainsOfTheLast) {
  EXPECT_EQ(sha256(std::string(64, '0')),
            (Hash{0x60e05bd1, 0xb195af2f, 0x94112fa7, 0x197a5c88, 0x28905884, 0x0ce7c6df, 0x9693756b, 0xc6250f55}));
  EXPECT_EQ(sha256(std::string(119, '0')),
            (Hash{0xc4487f9d, 0x6420e356, 0x98f9d9b4, 0x952e0a9f, 0x4735b0ce, 0x1729cdc6, 0x8672ff30, 0xf20c6af2}));
}

TEST(KeyDigest, IsTheBeginningOfTheHashOfPrefixAndKey) {
  EXPECT_EQ(digest_of("tendon-27").words,
            (std::array<std::uint32_t, 4>{0xa0be2973, 0xaa3ee0ac, 0xf905017c, 0x9770da69}));
  EXPECT_NE(digest_of("tendon-27"), digest_of("tendon-28"));
  EXPECT_TRUE(digest_of("").is_set());
  EXPECT_FALSE(KeyDigest{}.is_set());
}

TEST(Maintenance, WithoutAStoredKeyItOpensForAnybodyAndOnlyWhenAsked) {
  Maintenance maintenance;
  EXPECT_FALSE(maintenance.is_open(kNow));
  EXPECT_EQ(maintenance.open("", {}, kNow), Attempt::kOpened);
  EXPECT_TRUE(maintenance.is_open(kNow));
  maintenance.close();
  EXPECT_FALSE(maintenance.is_open(kNow));
}

TEST(Maintenance, OnlyTheWholeKeyOpens) {
  const KeyDigest stored = digest_of("tendon-27");
  for (const char* wrong : {"", "tendon-2", "tendon-277", "Tendon-27", "capstan maintenance tendon-27"}) {
    Maintenance maintenance;
    EXPECT_EQ(maintenance.open(wrong, stored, kNow), Attempt::kWrong) << wrong;
    EXPECT_FALSE(maintenance.is_open(kNow)) << wrong;
  }
  Maintenance maintenance;
  EXPECT_EQ(maintenance.open("tendon-27", stored, kNow), Attempt::kOpened);
  EXPECT_TRUE(maintenance.is_open(kNow));
}

TEST(Maintenance, AfterAWrongKeyEvenTheRightOneWaitsThreeSeconds) {
  const KeyDigest stored = digest_of("tendon-27");
  Maintenance maintenance;
  EXPECT_EQ(maintenance.open("guess", stored, kNow), Attempt::kWrong);
  EXPECT_EQ(maintenance.open("tendon-27", stored, kNow + 2'999), Attempt::kTooSoon);
  EXPECT_FALSE(maintenance.is_open(kNow + 2'999));
  EXPECT_EQ(maintenance.open("tendon-27", stored, kNow + 3'000), Attempt::kOpened);
}

TEST(Maintenance, AWrongKeyDoesNotCloseWhatIsOpenAndTenMinutesDo) {
  const KeyDigest stored = digest_of("tendon-27");
  Maintenance maintenance;
  EXPECT_EQ(maintenance.open("tendon-27", stored, kNow), Attempt::kOpened);
  EXPECT_EQ(maintenance.open("guess", stored, kNow + 1), Attempt::kWrong);
  EXPECT_TRUE(maintenance.is_open(kNow + 599'999));
  EXPECT_FALSE(maintenance.is_open(kNow + 600'000));
  EXPECT_FALSE(maintenance.is_open(kNow + 1)) << "once closed it stays so, also when the time has wrapped";
}

}  // namespace
}  // namespace capstan
