// SPDX-License-Identifier: Apache-2.0
#include "capstan/hal/cia402/journal.hpp"

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace capstan::cia402 {
namespace {

TEST(Journal, CountsEachSourceForItself) {
  Journal journal;
  journal.note(Anomaly::kStatusLength, 1, 3);
  journal.note(Anomaly::kStatusLength, 1, 5);
  journal.note(Anomaly::kStatusLength, 4, 9);
  EXPECT_EQ(journal.count(Anomaly::kStatusLength, 1), 2U);
  EXPECT_EQ(journal.detail(Anomaly::kStatusLength, 1), 5U);
  EXPECT_EQ(journal.count(Anomaly::kStatusLength, 4), 1U);
  EXPECT_EQ(journal.count(Anomaly::kStatusLength, Journal::kBus), 0U);
  EXPECT_EQ(journal.count(Anomaly::kStatusLength), 3U);
  EXPECT_EQ(journal.count(Anomaly::kStatusLate), 0U);
}

TEST(Journal, KeepsTheLastEmergenciesInOrder) {
  Journal journal;
  for (std::uint16_t code = 1; code <= 10; ++code) {
    journal.note(Emergency{static_cast<std::uint16_t>(0x8100 + code), 0x11}, 2);
  }
  EXPECT_EQ(journal.count(Anomaly::kEmergency, 2), 10U);
  for (std::uint32_t number = 2; number < 10; ++number) {
    EXPECT_EQ(journal.emergency(2, number).code, 0x8101 + number);
    EXPECT_EQ(journal.emergency(2, number).error_register, 0x11);
  }
}

TEST(Journal, EveryAnomalyHasANameASentenceAndACureOfItsOwn) {
  std::set<std::string> names;
  std::set<std::string> sentences;
  for (std::size_t i = 0; i < kAnomalies; ++i) {
    const AnomalyInfo& entry = info(static_cast<Anomaly>(i));
    EXPECT_TRUE(names.insert(entry.name).second) << entry.name;
    EXPECT_TRUE(sentences.insert(entry.sentence).second) << entry.sentence;
    EXPECT_GT(std::string(entry.cure).size(), 10U) << entry.name;
  }
}

// Codes as makers' manuals list them.
TEST(Journal, EmergencyCodesHaveTheirMeaning) {
  EXPECT_STREQ(emergency_text(0x8130), "the drive missed this firmware's heartbeat");
  EXPECT_STREQ(emergency_text(0x2310), "continuous over-current");
  EXPECT_STREQ(emergency_text(0x8611), "the following error is too large");
  EXPECT_STREQ(emergency_text(0x0000), "the error is over");
  EXPECT_STREQ(emergency_text(0x4299), "a temperature is wrong") << "the class, where the code is not listed";
  EXPECT_STREQ(emergency_text(0xFFFF), "an error that only the drive's manual explains");
}

TEST(Journal, AbortCodesHaveTheirMeaning) {
  EXPECT_STREQ(abort_text(0x06020000), "there is no such object");
  EXPECT_STREQ(abort_text(0x06090030), "value out of range");
  EXPECT_STREQ(abort_text(0x12345678), "a reason that the standard does not know");
}

}  // namespace
}  // namespace capstan::cia402
