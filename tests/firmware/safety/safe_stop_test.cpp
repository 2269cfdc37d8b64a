// SPDX-License-Identifier: Apache-2.0
#include "capstan/firmware/safety/safe_stop.hpp"

#include <gtest/gtest.h>

namespace capstan {
namespace {

constexpr StopMeans kAll = {.brake = true, .shorted_phases = true, .opposing_current = true};
constexpr StopMeans kElectric = {.shorted_phases = true, .opposing_current = true};
constexpr StopMeans kCurrentOnly = {.opposing_current = true};

struct Expected {
  Fault fault;
  SafeStop electric;
  SafeStop current_only;
};

// Written from what each fault says has failed, not from the table.
constexpr std::array<Expected, 21> kExpected = {{
    {Fault::kOverrun, SafeStop::kShortedPhases, SafeStop::kTorqueOff},
    {Fault::kSensorMissing, SafeStop::kShortedPhases, SafeStop::kTorqueOff},
    {Fault::kSensorInvalid, SafeStop::kShortedPhases, SafeStop::kTorqueOff},
    {Fault::kEncoderJump, SafeStop::kShortedPhases, SafeStop::kTorqueOff},
    {Fault::kFollowingError, SafeStop::kShortedPhases, SafeStop::kOpposingCurrent},
    {Fault::kOverCurrent, SafeStop::kTorqueOff, SafeStop::kTorqueOff},
    {Fault::kEstimatorRange, SafeStop::kShortedPhases, SafeStop::kOpposingCurrent},
    {Fault::kLinkLost, SafeStop::kShortedPhases, SafeStop::kOpposingCurrent},
    {Fault::kEmergencyStop, SafeStop::kTorqueOff, SafeStop::kTorqueOff},
    {Fault::kModelInvalid, SafeStop::kShortedPhases, SafeStop::kTorqueOff},
    {Fault::kDriveFailed, SafeStop::kTorqueOff, SafeStop::kTorqueOff},
    {Fault::kBoardClock, SafeStop::kShortedPhases, SafeStop::kTorqueOff},
    {Fault::kEncoderFrozen, SafeStop::kShortedPhases, SafeStop::kTorqueOff},
    {Fault::kCurrentMismatch, SafeStop::kTorqueOff, SafeStop::kTorqueOff},
    {Fault::kWindingHot, SafeStop::kShortedPhases, SafeStop::kTorqueOff},
    {Fault::kStorageFailed, SafeStop::kShortedPhases, SafeStop::kTorqueOff},
    {Fault::kSupplyLow, SafeStop::kTorqueOff, SafeStop::kTorqueOff},
    {Fault::kWatchdog, SafeStop::kTorqueOff, SafeStop::kTorqueOff},
    {Fault::kEncoderMotion, SafeStop::kShortedPhases, SafeStop::kTorqueOff},
    {Fault::kLimitCycle, SafeStop::kShortedPhases, SafeStop::kTorqueOff},
    {Fault::kOverspeed, SafeStop::kShortedPhases, SafeStop::kTorqueOff},
}};

TEST(SafeStop, EachFaultIsStoppedByWhatItLeavesToBeReliedOn) {
  EXPECT_EQ(kExpected.size() + 1, kFaultTable.size()) << "a fault without a row here";
  for (const Expected& row : kExpected) {
    EXPECT_EQ(safe_stop(bit(row.fault), kElectric), row.electric) << info(row.fault).name;
    EXPECT_EQ(safe_stop(bit(row.fault), kCurrentOnly), row.current_only) << info(row.fault).name;
    EXPECT_EQ(safe_stop(bit(row.fault), kAll), SafeStop::kBrake) << info(row.fault).name;
    EXPECT_EQ(safe_stop(bit(row.fault), {}), SafeStop::kTorqueOff) << info(row.fault).name;
  }
}

TEST(SafeStop, TwoFaultsLeaveOnlyWhatBothLeave) {
  EXPECT_EQ(safe_stop(bit(Fault::kLinkLost) | bit(Fault::kEncoderFrozen), kCurrentOnly), SafeStop::kTorqueOff);
  EXPECT_EQ(safe_stop(bit(Fault::kEncoderFrozen) | bit(Fault::kDriveFailed), kElectric), SafeStop::kTorqueOff);
}

}  // namespace
}  // namespace capstan
