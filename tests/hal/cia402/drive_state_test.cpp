// SPDX-License-Identifier: Apache-2.0
#include "capstan/hal/cia402/drive_state.hpp"

#include <gtest/gtest.h>

namespace capstan::cia402 {
namespace {

// CiA 402-2 table "state coding": x is any bit.
TEST(DriveState, FollowsTheStandardsTableWhateverTheOtherBitsAre) {
  for (unsigned others = 0; others <= 0xFFFF; ++others) {
    const auto with = [others](unsigned mask, unsigned value) {
      return static_cast<std::uint16_t>((others & ~mask) | value);
    };
    EXPECT_EQ(drive_state(with(0x4F, 0x00)), DriveState::kNotReady);
    EXPECT_EQ(drive_state(with(0x4F, 0x40)), DriveState::kSwitchOnDisabled);
    EXPECT_EQ(drive_state(with(0x6F, 0x21)), DriveState::kReadyToSwitchOn);
    EXPECT_EQ(drive_state(with(0x6F, 0x23)), DriveState::kSwitchedOn);
    EXPECT_EQ(drive_state(with(0x6F, 0x27)), DriveState::kOperationEnabled);
    EXPECT_EQ(drive_state(with(0x6F, 0x07)), DriveState::kQuickStopActive);
    EXPECT_EQ(drive_state(with(0x4F, 0x0F)), DriveState::kFaultReaction);
    EXPECT_EQ(drive_state(with(0x4F, 0x08)), DriveState::kFault);
  }
}

TEST(DriveState, BitsThatStandForNoStateAreUnknown) {
  for (const unsigned word : {0x01U, 0x02U, 0x05U, 0x09U, 0x0BU, 0x41U, 0x48U, 0x4FU, 0x6FU, 0x67U, 0x03U, 0x25U}) {
    EXPECT_EQ(drive_state(static_cast<std::uint16_t>(word)), DriveState::kUnknown) << word;
  }
}

TEST(DriveState, TorqueIsReachedStepByStepAndFromNowhereElse) {
  EXPECT_EQ(towards_torque(DriveState::kSwitchOnDisabled), 0x06);
  EXPECT_EQ(towards_torque(DriveState::kReadyToSwitchOn), 0x07);
  EXPECT_EQ(towards_torque(DriveState::kSwitchedOn), 0x0F);
  EXPECT_EQ(towards_torque(DriveState::kOperationEnabled), 0x0F);
  for (const DriveState state : {DriveState::kNotReady, DriveState::kQuickStopActive, DriveState::kFaultReaction,
                                 DriveState::kFault, DriveState::kUnknown}) {
    EXPECT_EQ(towards_torque(state), 0x00) << name(state);
  }
}

}  // namespace
}  // namespace capstan::cia402
