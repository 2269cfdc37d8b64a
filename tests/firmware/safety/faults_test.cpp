// SPDX-License-Identifier: Apache-2.0
#include "capstan/firmware/safety/faults.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <set>
#include <sstream>
#include <string>

#include "capstan/firmware/safety/supervisor.hpp"

namespace capstan {
namespace {

auto readme() -> std::string {
  std::ifstream file(CAPSTAN_FIRMWARE_PAGE);
  EXPECT_TRUE(file) << CAPSTAN_FIRMWARE_PAGE;
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

TEST(Faults, NamesAreUniqueAndCausesAndCuresAreGiven) {
  std::set<std::string> names;
  for (const FaultInfo& fault : kFaultTable) {
    EXPECT_TRUE(names.insert(fault.name).second) << fault.name;
    EXPECT_FALSE(std::string(fault.cause).empty()) << fault.name;
    EXPECT_FALSE(std::string(fault.cure).empty()) << fault.name;
  }
}

// Numbers are in logs and on the wire: this list may grow, and no line of it may change.
TEST(Faults, NumbersAreThoseThatWereGivenOut) {
  const std::array<const char*, 22> given_out = {
      "none",         "overrun",         "sensor_missing",   "sensor_invalid", "encoder_jump",   "following_error",
      "over_current", "estimator_range", "link_lost",        "emergency_stop", "model_invalid",  "drive_failed",
      "board_clock",  "encoder_frozen",  "current_mismatch", "winding_hot",    "storage_failed", "supply_low",
      "watchdog",     "encoder_motion",  "limit_cycle",      "overspeed"};
  ASSERT_EQ(kFaultTable.size(), given_out.size());
  for (std::size_t i = 0; i < given_out.size(); ++i) {
    EXPECT_STREQ(info(static_cast<Fault>(i)).name, given_out[i]);
  }
}

TEST(Faults, EveryFaultHasABitOfItsOwn) {
  FaultSet all = 0;
  for (const FaultInfo& fault : kFaultTable) {
    EXPECT_EQ(all & bit(fault.code), 0U) << fault.name;
    all |= bit(fault.code);
    EXPECT_EQ(bit(fault.code) == 0, fault.code == Fault::kNone);
  }
}

TEST(Faults, TheLowestOfASetIsTheOneWithTheLowestNumber) {
  EXPECT_EQ(lowest(0), Fault::kNone);
  EXPECT_EQ(lowest(bit(Fault::kOverspeed)), Fault::kOverspeed);
  EXPECT_EQ(lowest(bit(Fault::kWatchdog) | bit(Fault::kSensorMissing) | bit(Fault::kDriveFailed)),
            Fault::kSensorMissing);
}

TEST(Faults, TheReadmeListsEveryFaultWithItsNumberAndNoOther) {
  const std::string text = readme();
  std::size_t rows = 0;
  for (const FaultInfo& fault : kFaultTable) {
    if (fault.code == Fault::kNone) {
      continue;
    }
    const std::string row = "| " + std::to_string(static_cast<int>(fault.code)) + " | `" + fault.name + "` |";
    EXPECT_NE(text.find(row), std::string::npos) << "docs/firmware.md lacks the row " << row;
    ++rows;
  }
  const std::size_t begin = text.find("## Faults");
  ASSERT_NE(begin, std::string::npos);
  const std::string section = text.substr(begin, text.find("\n## ", begin + 1) - begin);
  std::size_t listed = 0;
  std::istringstream section_lines(section);
  for (std::string line; std::getline(section_lines, line);) {
    listed += line.rfind("| ", 0) == 0 && std::isdigit(static_cast<unsigned char>(line[2])) != 0 ? 1U : 0U;
  }
  EXPECT_EQ(listed, rows) << "docs/firmware.md lists a fault that does not exist";
}

TEST(Faults, TheReadmeListsEveryTransition) {
  const std::string text = readme();
  for (const Transition& transition : kTransitions) {
    const std::string row = std::string("| ") + name(transition.from) + " |";
    bool found = false;
    std::istringstream readme_lines(text);
    for (std::string line; std::getline(readme_lines, line);) {
      found = found || (line.rfind(row, 0) == 0 &&
                        line.find(std::string("| ") + name(transition.to) + " |") != std::string::npos);
    }
    EXPECT_TRUE(found) << name(transition.from) << " to " << name(transition.to);
  }
}

}  // namespace
}  // namespace capstan
