// SPDX-License-Identifier: Apache-2.0
#include "capstan/hal/cia402/drive_profile.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>

#include "capstan/hal/cia402/setup_steps.hpp"

namespace capstan::cia402 {
namespace {

auto refusal(const std::string& text) -> std::string {
  try {
    static_cast<void>(parse_profile(text, "my.profile"));
  } catch (const std::runtime_error& problem) {
    return problem.what();
  }
  return "";
}

TEST(DriveProfile, IsReadAsItIsWritten) {
  const DriveProfile profile = parse_profile(
      "# a comment\n"
      "name = Acme Mover   # and another\r\n"
      "vendor = 0xAC3E\n"
      "product = 17\n"
      "\n"
      "rated_current = 3001:02 2\n"
      "objects_per_message = 2\n"
      "answer_ms = 25\n"
      "sdo_timeout_ms = 3000\n"
      "stops_without_master = yes\n"
      "values 605A:00 = 2 0x6\n"
      "require 2400:0F 1 = 0",
      "my.profile");
  EXPECT_EQ(profile.name, "Acme Mover");
  EXPECT_EQ(profile.vendor, 0xAC3EU);
  EXPECT_EQ(profile.product, 17U);
  EXPECT_EQ(profile.rated_current->index, 0x3001);
  EXPECT_EQ(profile.rated_current->subindex, 2);
  EXPECT_EQ(profile.rated_current->bytes, 2);
  EXPECT_EQ(profile.objects_per_message, 2U);
  EXPECT_EQ(profile.answer_ms, 25U);
  EXPECT_EQ(profile.sdo_timeout, std::chrono::milliseconds(3000));
  EXPECT_TRUE(profile.stops_without_master);
  ASSERT_EQ(profile.values.size(), 1U);
  EXPECT_EQ(profile.values[0].values, (std::vector<std::uint32_t>{2, 6}));
  ASSERT_EQ(profile.required.size(), 1U);
  EXPECT_EQ(profile.required[0].object.subindex, 0x0F);
}

TEST(DriveProfile, WhatIsNoneIsRefusedWithItsLineAndTheCure) {
  const std::string head = "name = x\nnode = 1\n";
  for (const char* line :
       {"green", "= 3", "green = 3", "vendor = acme", "node = 127", "values 605A = 2", "values 605A:00 2 = 2",
        "require 605A:00 = 2", "require 605A:00 5 = 2", "rated_current = 3001:01", "rated_current = 3001:0102 4",
        "objects_per_message = 1", "stops_without_master = perhaps", "rated_current_ma = 0", "answer_ms = -1",
        "values 605A:00 = 2;6", "rated_current_ma ="}) {
    const std::string said = refusal(head + line);
    EXPECT_EQ(said.find("my.profile, line 3 "), 0U) << line << ": " << said;
    EXPECT_NE(said.find("; "), std::string::npos) << said;
  }
  EXPECT_NE(refusal("name = x\n").find("does not say which drives it is for"), std::string::npos);
  EXPECT_NE(refusal("vendor = 1\n").find("does not say which drives it is for"), std::string::npos);
}

TEST(DriveProfile, TheFirstThatFitsInAllThatItSaysIsFound) {
  const std::vector<DriveProfile> profiles = {parse_profile("name = one\nvendor = 5\nnode = 3\n", ""),
                                              parse_profile("name = two\nvendor = 5\nproduct = 7\n", ""),
                                              parse_profile("name = three\nvendor = 5\n", "")};
  EXPECT_EQ(find_profile(profiles, 3, 5, 7)->name, "one");
  EXPECT_EQ(find_profile(profiles, 4, 5, 7)->name, "two");
  EXPECT_EQ(find_profile(profiles, 4, 5, std::nullopt)->name, "three");
  EXPECT_EQ(find_profile(profiles, 3, 6, 7), nullptr);
  EXPECT_EQ(find_profile(profiles, 3, std::nullopt, std::nullopt), nullptr);
}

TEST(DriveProfile, TheMakersInTheProgramAreFoundByTheirNumber) {
  for (const auto& [vendor, name] : std::vector<std::pair<std::uint32_t, std::string>>{
           {0xFB, "maxon EPOS4"}, {0x9A, "Elmo SimplIQ or Gold"}, {0xAB, "Copley Controls"}, {0x26C, "Nanotec"}}) {
    const DriveProfile* const found = find_profile(known_profiles(), 1, vendor, 0);
    ASSERT_NE(found, nullptr) << name;
    EXPECT_EQ(found->name, name);
    EXPECT_FALSE(found->note.empty()) << "no drive was at hand, and the start says what was not verified";
  }
}

TEST(DriveProfile, ItsValuesReplaceThoseOfTheTableAndItsOwnObjectsAreRequired) {
  const DriveProfile profile =
      parse_profile("name = x\nnode = 1\nvalues 605A:00 = 6\nrequire 2400:01 2 = 3\nrated_current = 3001:01 4\n", "");
  const std::vector<SetupStep> steps = setup_steps(drive_maps(PdoLayout::kSeparate, 1, 0, 1), profile);
  const auto of = [&steps](std::uint16_t index) {
    return std::find_if(steps.begin(), steps.end(),
                        [index](const SetupStep& step) { return step.object.index == index; });
  };
  EXPECT_EQ(of(0x605A)->values, std::vector<std::uint32_t>{6});
  ASSERT_NE(of(0x2400), steps.end());
  EXPECT_EQ(of(0x2400)->need, SetupStep::Need::kRequired);
  EXPECT_EQ(of(0x6075), steps.end());
  EXPECT_EQ(of(0x3001)->meaning, SetupStep::Meaning::kRatedCurrent);
}

}  // namespace
}  // namespace capstan::cia402
