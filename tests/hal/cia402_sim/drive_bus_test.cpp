// SPDX-License-Identifier: Apache-2.0
#include "capstan/hal/cia402_sim/drive_bus.hpp"

#include <gtest/gtest.h>

#include <sstream>
#include <stdexcept>

namespace capstan::drive_sim {
namespace {

TEST(DriveBus, IncidentsAreReadAsTheyAreWritten) {
  const Incident incident = parse_incident("2.5:short-status:12");
  EXPECT_EQ(incident.at_s, 2.5);
  EXPECT_EQ(incident.mischief, Mischief::kShortStatus);
  EXPECT_EQ(incident.node, 12);
  EXPECT_EQ(parse_incident("0:flood:1").mischief, Mischief::kFlood);
  EXPECT_EQ(parse_incident("0:silence:1").mischief, Mischief::kSilence);
}

TEST(DriveBus, WhatIsNoIncidentIsRefusedWithTheCure) {
  for (const char* text : {"", "1", "1:silence", "x:silence:1", "-1:silence:1", "nan:silence:1", "1:silence:0",
                           "1:silence:127", "1:silence:1x", "1:nonsense:1"}) {
    try {
      static_cast<void>(parse_incident(text));
      FAIL() << text;
    } catch (const std::runtime_error& problem) {
      EXPECT_NE(std::string(problem.what()).find("; "), std::string::npos) << problem.what();
    }
  }
}

}  // namespace
}  // namespace capstan::drive_sim
