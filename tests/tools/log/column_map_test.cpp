// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/log/column_map.hpp"

#include <gtest/gtest.h>

#include "capstan/tools/support/errors.hpp"

namespace capstan::tools {
namespace {

TEST(ColumnMap, AMappingNamesWantedAndSource) {
  const ColumnMapping mapping = parse_mapping("axis0/q1_rad=q1_motor_rad");
  EXPECT_EQ(mapping.wanted, "axis0/q1_rad");
  EXPECT_EQ(mapping.expression, "q1_motor_rad");
  EXPECT_FALSE(mapping.scaled());
}

TEST(ColumnMap, AFactorMayBeNegativeAndSurroundedByBlanks) {
  const ColumnMapping mapping = parse_mapping(" axis0/tau_Nm = current * -0.0369 ");
  EXPECT_EQ(mapping.wanted, "axis0/tau_Nm");
  ASSERT_TRUE(mapping.scaled());
  EXPECT_EQ(mapping.scaled()->first, "current");
  EXPECT_EQ(mapping.scaled()->second, -0.0369);
}

TEST(ColumnMap, EveryBadMappingIsRefusedWithTheFormExpected) {
  for (const char* bad : {"axis0/q1_rad", "=x", "axis0/q1_rad=", "a=b*", "a=b*0", "a=b*nan"}) {
    try {
      parse_mapping(bad);
      FAIL() << bad;
    } catch (const BadInput& error) {
      EXPECT_NE(std::string(error.what()).find("--map axis0/q1_rad=q1_motor_rad"), std::string::npos) << error.what();
    }
  }
}

TEST(ColumnMap, TheSameColumnIsNotMappedTwice) {
  EXPECT_THROW(parse_mappings({"a=b", "a=c"}), BadInput);
  EXPECT_EQ(parse_mappings({"a=b", "c=b"}).size(), 2U);
}

TEST(ColumnMap, WhatNothingReadsIsRefusedWithTheNameThatWasMeant) {
  const std::vector<std::string> targets = {"camera"};
  EXPECT_NO_THROW(expect_read(parse_mappings({"time_s=t", "axis0/q1_rad=a", "axis17/tau_Nm=b", "axis1/tau_out_Nm=c",
                                              "temperature_C=d", "site=e", "tip_left/qz=f", "camera=g"}),
                              targets));
  for (const char* bad : {"foo", "axis0/q2_deg", "axis0/tau", "axis/q1_rad", "q1_rad", "tip_left/q1_rad", "other"}) {
    EXPECT_THROW(expect_read(parse_mappings({std::string(bad) + "=x"}), targets), BadInput) << bad;
  }
  try {
    expect_read(parse_mappings({"axis3/tau_nm=current_A*0.0369"}), {});
    FAIL();
  } catch (const BadInput& error) {
    EXPECT_NE(std::string(error.what()).find("did you mean axis3/tau_Nm? read are time_s, "), std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace capstan::tools
