// SPDX-License-Identifier: Apache-2.0
#include "capstan/hal/cia402/drive_link.hpp"

#include <gtest/gtest.h>

#include "capstan/tests/hal/cia402/support.hpp"

namespace capstan::cia402 {
namespace {

struct Rig {
  explicit Rig(const DriveSetting& of = setting()) : drive(of, journal, 1) {}
  Journal journal;
  DriveLink drive;
  Time now = ms(1000);

  /// One cycle: SYNC, this statusword's low byte in answer, then the command.
  auto cycle(int low_byte, const AxisDrive& wanted) -> DriveLink::Command {
    now += ms(1);
    drive.rt_status(status(low_byte), now, now);
    drive.rt_heartbeat(frame(0x701, {5}), now);
    sensed = drive.rt_sense(now, true);
    return drive.rt_command(wanted);
  }
  void enable() {
    for (const int low_byte : {kSwitchOnDisabled, kReady, kSwitchedOn, kEnabled}) {
      static_cast<void>(cycle(low_byte, amperes(0)));
    }
  }
  [[nodiscard]] auto count(Anomaly anomaly) const -> std::uint32_t { return journal.count(anomaly, 1); }
  AxisSensed sensed;
};

TEST(DriveLink, AStatusMessageBecomesCountsAndAmperes) {
  Rig rig;
  static_cast<void>(rig.cycle(kSwitchOnDisabled, {}));
  EXPECT_EQ(rig.sensed.encoder_counts, 0x00010203);
  EXPECT_EQ(rig.sensed.encoder, Quality::kOk);
  EXPECT_NEAR(rig.sensed.current_a.to_double(), -0.1 * 2.0, 1e-6) << "-100 permille of 2 A";
  EXPECT_EQ(rig.sensed.current, Quality::kOk);
  EXPECT_EQ(rig.drive.state(), DriveState::kSwitchOnDisabled);
}

TEST(DriveLink, GoesToTorqueStepByStepAndGivesNoneBefore) {
  Rig rig;
  EXPECT_EQ(rig.cycle(kSwitchOnDisabled, amperes(1)).controlword, 0x06);
  EXPECT_EQ(rig.cycle(kReady, amperes(1)).controlword, 0x07);
  const DriveLink::Command last = rig.cycle(kSwitchedOn, amperes(1));
  EXPECT_EQ(last.controlword, 0x0F);
  EXPECT_EQ(last.torque_permille, 0);
  const DriveLink::Command on = rig.cycle(kEnabled, amperes(1));
  EXPECT_EQ(on.controlword, 0x0F);
  EXPECT_EQ(on.torque_permille, 500) << "1 A of 2 A";
  EXPECT_EQ(rig.cycle(kEnabled, amperes(-0.5)).torque_permille, -250);
  EXPECT_EQ(rig.cycle(kEnabled, amperes(100)).torque_permille, 32767) << "saturates, never wraps";
  EXPECT_EQ(rig.cycle(kEnabled, amperes(-100)).torque_permille, -32767) << "the same either way";
}

TEST(DriveLink, SaysWhenTheDriveFollowsItsSetValue) {
  Rig rig;
  for (const int low_byte : {kSwitchOnDisabled, kReady, kSwitchedOn}) {
    static_cast<void>(rig.cycle(low_byte, amperes(1)));
    EXPECT_FALSE(rig.sensed.follows);
  }
  EXPECT_EQ(rig.cycle(kEnabled, amperes(1)).torque_permille, 500);
  EXPECT_TRUE(rig.sensed.follows) << "in the cycle whose command is the first with torque";
}

TEST(DriveLink, WithoutEnableItIsVoltageOffInTheSameCycle) {
  Rig rig;
  rig.enable();
  const DriveLink::Command off = rig.cycle(kEnabled, amperes(1, false));
  EXPECT_EQ(off.controlword, 0x00);
  EXPECT_EQ(off.torque_permille, 0);
  EXPECT_TRUE(rig.drive.rt_sound());
}

TEST(DriveLink, AStatusOfAnotherLengthIsNotUsed) {
  Rig rig;
  rig.drive.rt_status(frame(0x181, {0x50, 0x02, 0x03}), ms(1), ms(0));
  rig.drive.rt_status(frame(0x181, {0x50, 0x02, 0x03, 0, 0, 0, 0, 0, 0}), ms(1), ms(0));
  EXPECT_EQ(rig.count(Anomaly::kStatusLength), 2U);
  EXPECT_EQ(rig.drive.rt_sense(ms(1), true).encoder, Quality::kMissing);
  EXPECT_EQ(rig.count(Anomaly::kStatusMissing), 1U);
}

TEST(DriveLink, HeartbeatsThatWaitedWhileAnotherBusWasSetUpDoNotLoseIt) {
  Rig rig;
  for (std::int64_t i = 0; i < 24; ++i) {
    rig.drive.rt_heartbeat(frame(0x701, {5}), ms(40 * i));
  }
  static_cast<void>(rig.drive.rt_sense(ms(10'000), false));
  EXPECT_TRUE(rig.drive.rt_sound());
  rig.drive.rt_heartbeat(frame(0x701, {5}), ms(960));  // the next that waited
  static_cast<void>(rig.drive.rt_sense(ms(10'090), false));
  EXPECT_TRUE(rig.drive.rt_sound());
  static_cast<void>(rig.drive.rt_sense(ms(10'091), false));
  EXPECT_FALSE(rig.drive.rt_sound()) << "one that is silent from then on is lost in 90 ms";
}

TEST(DriveLink, AnAnswerToAnEarlierSyncIsNotUsed) {
  Rig rig;
  rig.drive.rt_status(status(kEnabled), ms(1), ms(2));
  EXPECT_EQ(rig.count(Anomaly::kStatusLate), 1U);
  EXPECT_EQ(rig.drive.rt_sense(ms(3), true).encoder, Quality::kMissing);
}

TEST(DriveLink, AValueIsUsedForOneCycleOnly) {
  Rig rig;
  static_cast<void>(rig.cycle(kSwitchOnDisabled, {}));
  EXPECT_EQ(rig.drive.rt_sense(ms(1002), true).encoder, Quality::kMissing);
  EXPECT_EQ(rig.drive.rt_sense(ms(1003), false).current, Quality::kMissing);
  EXPECT_EQ(rig.count(Anomaly::kStatusMissing), 1U) << "without a SYNC there is nothing to miss";
}

TEST(DriveLink, TheSameStatusTwiceIsCountedADifferentOneMakesBothInvalid) {
  Rig rig;
  rig.drive.rt_status(status(kEnabled), ms(1), ms(0));
  rig.drive.rt_status(status(kEnabled), ms(1), ms(0));
  EXPECT_EQ(rig.count(Anomaly::kStatusRepeated), 1U);
  EXPECT_EQ(rig.drive.rt_sense(ms(1), true).encoder, Quality::kOk);
  rig.drive.rt_status(status(kEnabled), ms(2), ms(1));
  rig.drive.rt_status(status(kFaulted), ms(2), ms(1));
  EXPECT_EQ(rig.count(Anomaly::kStatusContradicts), 1U);
  const AxisSensed sensed = rig.drive.rt_sense(ms(2), true);
  EXPECT_EQ(sensed.encoder, Quality::kInvalid);
  EXPECT_EQ(sensed.current, Quality::kInvalid);
  rig.drive.rt_status(status(kEnabled), ms(3), ms(2));
  EXPECT_EQ(rig.drive.rt_sense(ms(3), true).encoder, Quality::kOk) << "and the next one counts again";
  for (std::int64_t i = 4; i < 102; ++i) {
    EXPECT_FALSE(rig.drive.rt_sound()) << "but torque waits until it has been calm for 100 cycles";
    rig.drive.rt_heartbeat(frame(0x701, {5}), ms(i));
    static_cast<void>(rig.drive.rt_sense(ms(i), false));
  }
  static_cast<void>(rig.drive.rt_sense(ms(102), false));
  EXPECT_TRUE(rig.drive.rt_sound());
}

TEST(DriveLink, AStatuswordOfNoStateTakesTheTorqueAway) {
  Rig rig;
  rig.enable();
  const DriveLink::Command command = rig.cycle(0x4F, amperes(1));
  EXPECT_EQ(command.controlword, 0x00);
  EXPECT_FALSE(rig.drive.rt_sound());
  EXPECT_EQ(rig.count(Anomaly::kStatusUnknown), 1U);
  EXPECT_EQ(rig.journal.detail(Anomaly::kStatusUnknown, 1), 0x024FU);
}

TEST(DriveLink, AMissedHeartbeatLosesTheDriveForGood) {
  Rig rig;
  rig.enable();
  const Time last = rig.now;
  const auto silent_cycle = [&](std::int64_t after) {
    rig.drive.rt_status(status(kEnabled), last + ms(after), last + ms(after));
    static_cast<void>(rig.drive.rt_sense(last + ms(after), true));
    return rig.drive.rt_command(amperes(1));
  };
  EXPECT_EQ(silent_cycle(90).torque_permille, 500);
  EXPECT_TRUE(rig.drive.rt_sound());
  const DriveLink::Command command = silent_cycle(91);
  EXPECT_EQ(command.controlword, 0x00);
  EXPECT_FALSE(rig.drive.rt_sound());
  EXPECT_EQ(rig.count(Anomaly::kHeartbeatLost), 1U);
  static_cast<void>(rig.cycle(kEnabled, amperes(0, false)));
  static_cast<void>(rig.cycle(kEnabled, amperes(1)));
  EXPECT_FALSE(rig.drive.rt_sound()) << "its configuration may be gone";
  EXPECT_EQ(rig.count(Anomaly::kHeartbeatLost), 1U) << "one loss, not one a cycle";
}

TEST(DriveLink, ABootUpOrAnotherStateThanOperationalLosesTheDrive) {
  for (const auto& [state, anomaly] :
       {std::pair{0, Anomaly::kRestarted}, {4, Anomaly::kNotOperational}, {127, Anomaly::kNotOperational}}) {
    Rig rig;
    rig.enable();
    rig.drive.rt_heartbeat(frame(0x701, {state}), rig.now);
    EXPECT_EQ(rig.count(anomaly), 1U);
    EXPECT_FALSE(rig.drive.rt_sound());
    EXPECT_EQ(rig.cycle(kEnabled, amperes(1)).controlword, 0x00);
  }
}

TEST(DriveLink, AMalformedHeartbeatDoesNotCount) {
  Rig rig;
  static_cast<void>(rig.cycle(kSwitchOnDisabled, {}));
  const Time last = rig.now;
  rig.drive.rt_heartbeat(frame(0x701, {}), last + ms(50));
  rig.drive.rt_heartbeat(frame(0x701, {5, 5}), last + ms(50));
  EXPECT_EQ(rig.count(Anomaly::kHeartbeatLength), 2U);
  rig.drive.rt_heartbeat(frame(0x701, {0x85}), last + ms(50));  // the toggle bit of node guarding
  EXPECT_EQ(rig.count(Anomaly::kHeartbeatState), 1U);
  EXPECT_TRUE(rig.drive.rt_sound());
  static_cast<void>(rig.drive.rt_sense(last + ms(91), false));
  EXPECT_FALSE(rig.drive.rt_sound());
}

TEST(DriveLink, AnEmergencyIsKeptWithItsCodeAndOneOfAnotherLengthIsNot) {
  Rig rig;
  rig.drive.rt_emergency(frame(0x081, {0x30, 0x81, 0x11, 0, 0, 0, 0, 0}));
  EXPECT_EQ(rig.count(Anomaly::kEmergency), 1U);
  EXPECT_EQ(rig.journal.emergency(1, 0).code, 0x8130);
  EXPECT_EQ(rig.journal.emergency(1, 0).error_register, 0x11);
  rig.drive.rt_emergency(frame(0x081, {0x30, 0x81, 0x11}));
  EXPECT_EQ(rig.count(Anomaly::kEmergency), 1U);
  EXPECT_EQ(rig.count(Anomaly::kEmergencyLength), 1U);
}

TEST(DriveLink, ADriveThatDropsItsTorqueIsNotEnabledAgainBeforeTheFirmwareLetsGo) {
  Rig rig;
  rig.enable();
  EXPECT_EQ(rig.cycle(kSwitchOnDisabled, amperes(1)).controlword, 0x00);
  EXPECT_FALSE(rig.drive.rt_sound());
  EXPECT_EQ(rig.count(Anomaly::kDroppedOut), 1U);
  EXPECT_EQ(rig.cycle(kSwitchOnDisabled, amperes(1)).controlword, 0x00);
  EXPECT_EQ(rig.count(Anomaly::kDroppedOut), 1U);
  static_cast<void>(rig.cycle(kSwitchOnDisabled, amperes(0, false)));
  EXPECT_TRUE(rig.drive.rt_sound());
  EXPECT_EQ(rig.cycle(kSwitchOnDisabled, amperes(1)).controlword, 0x06);
}

TEST(DriveLink, ADriveThatDoesNotEnableIsGivenUpAfter200Cycles) {
  Rig rig;
  for (int i = 0; i < 200; ++i) {
    EXPECT_EQ(rig.cycle(kReady, amperes(1)).controlword, 0x07);
  }
  EXPECT_EQ(rig.cycle(kReady, amperes(1)).controlword, 0x00);
  EXPECT_EQ(rig.count(Anomaly::kNotEnabled), 1U);
  EXPECT_FALSE(rig.drive.rt_sound());
}

TEST(DriveLink, AFaultIsResetByAnEdgeOnceTheTorqueIsGivenUp) {
  Rig rig;
  rig.enable();
  EXPECT_EQ(rig.cycle(kFaulted, amperes(1)).controlword, 0x00) << "no reset while torque is wanted";
  EXPECT_EQ(rig.count(Anomaly::kDriveFault), 1U);
  EXPECT_EQ(rig.count(Anomaly::kDroppedOut), 0U) << "one cause, one sentence";
  EXPECT_FALSE(rig.drive.rt_sound());
  int edges = 0;
  std::uint16_t before = 0x80;
  for (int i = 0; i < 1000; ++i) {
    const std::uint16_t word = rig.cycle(kFaulted, amperes(0, false)).controlword;
    EXPECT_TRUE(word == 0x00 || word == 0x80);
    edges += before == 0x00 && word == 0x80 ? 1 : 0;
    before = word;
  }
  EXPECT_EQ(edges, 2);
  EXPECT_FALSE(rig.drive.rt_sound());
  EXPECT_EQ(rig.cycle(kSwitchOnDisabled, amperes(0, false)).controlword, 0x00);
  EXPECT_TRUE(rig.drive.rt_sound());
}

/// Node 1, whose status comes in two messages.
auto split_setting() -> DriveSetting {
  DriveSetting split = setting();
  split.maps = drive_maps(PdoLayout::kSeparate, 1, 0, 1, 2);
  return split;
}

TEST(DriveLink, AStatusInTwoMessagesIsOneOnlyWhenBothHaveCome) {
  Journal journal;
  DriveLink drive(split_setting(), journal, 1);
  const Frame first = frame(0x181, {kReady, 0x02, 0x03, 0x02, 0x01, 0x00});
  const Frame second = frame(0x281, {0x9C, 0xFF});
  drive.rt_status(second, ms(1), ms(0), 1);
  drive.rt_status(first, ms(1), ms(0), 0);
  const AxisSensed whole = drive.rt_sense(ms(1), true);
  EXPECT_EQ(whole.encoder_counts, 0x00010203);
  EXPECT_NEAR(whole.current_a.to_double(), -0.2, 1e-6);
  EXPECT_EQ(drive.state(), DriveState::kReadyToSwitchOn);
  drive.rt_status(first, ms(2), ms(1), 0);
  EXPECT_EQ(drive.rt_sense(ms(2), true).encoder, Quality::kMissing);
  drive.rt_status(second, ms(3), ms(2), 1);
  EXPECT_EQ(drive.rt_sense(ms(3), true).current, Quality::kMissing) << "halves of two cycles are no whole";
  EXPECT_EQ(journal.count(Anomaly::kStatusMissing, 1), 2U);
  drive.rt_status(frame(0x281, {0x9C, 0xFF, 0}), ms(4), ms(3), 1);
  EXPECT_EQ(journal.count(Anomaly::kStatusLength, 1), 1U);
}

TEST(DriveLink, TorqueStaysWithinTheLimitThatIsStoredInTheDrive) {
  DriveSetting limited = setting();
  limited.max_torque_permille = 50;
  Rig rig(limited);
  rig.enable();
  EXPECT_EQ(rig.cycle(kEnabled, amperes(0.05)).torque_permille, 25);
  EXPECT_EQ(rig.cycle(kEnabled, amperes(1)).torque_permille, 50);
  EXPECT_EQ(rig.cycle(kEnabled, amperes(-1)).torque_permille, -50);
}

/// Answers to the question for object 6061.
auto mode(int shown) -> Frame {
  return frame(0x581, {0x4F, 0x61, 0x60, 0x00, shown, 0, 0, 0});
}

auto asking_setting() -> DriveSetting {
  DriveSetting asking = setting();
  asking.asks_mode = true;
  return asking;
}

struct AskingRig : Rig {
  AskingRig() : Rig(asking_setting()) { enable(); }
};

TEST(DriveLink, ADriveThatShowsItsModeWhenEnabledGetsTorqueAfterIt) {
  AskingRig rig;
  EXPECT_EQ(rig.cycle(kEnabled, amperes(1)).torque_permille, 0);
  EXPECT_TRUE(rig.drive.rt_asks_mode());
  EXPECT_FALSE(rig.drive.rt_asks_mode()) << "once";
  EXPECT_EQ(rig.cycle(kEnabled, amperes(1)).torque_permille, 0) << "no answer yet";
  EXPECT_FALSE(rig.sensed.follows);
  rig.drive.rt_mode(mode(10));
  EXPECT_EQ(rig.cycle(kEnabled, amperes(1)).torque_permille, 500);
  EXPECT_TRUE(rig.sensed.follows);
  EXPECT_FALSE(rig.drive.rt_asks_mode());
  static_cast<void>(rig.cycle(kEnabled, amperes(0, false)));
  for (const int low_byte : {kSwitchOnDisabled, kReady, kSwitchedOn, kEnabled}) {
    EXPECT_EQ(rig.cycle(low_byte, amperes(1)).torque_permille, 0) << "each time it is enabled";
  }
  EXPECT_TRUE(rig.drive.rt_asks_mode());
}

TEST(DriveLink, ADriveThatIsEnabledInAnotherModeIsLost) {
  AskingRig rig;
  for (int i = 0; i < 5; ++i) {
    EXPECT_TRUE(rig.drive.rt_sound());
    EXPECT_EQ(rig.cycle(kEnabled, amperes(1)).torque_permille, 0);
    EXPECT_TRUE(rig.drive.rt_asks_mode());
    rig.drive.rt_mode(mode(8));
  }
  EXPECT_FALSE(rig.drive.rt_sound());
  EXPECT_EQ(rig.count(Anomaly::kWrongMode), 1U);
  EXPECT_EQ(rig.journal.detail(Anomaly::kWrongMode, 1), 8U);
  EXPECT_EQ(rig.cycle(kEnabled, amperes(1)).controlword, 0x00);
}

TEST(DriveLink, ADriveThatDoesNotSayItsModeGetsNoTorque) {
  AskingRig rig;
  for (int i = 0; i < 1201; ++i) {
    EXPECT_EQ(rig.cycle(kEnabled, amperes(1)).torque_permille, 0);
    static_cast<void>(rig.drive.rt_asks_mode());
  }
  EXPECT_EQ(rig.count(Anomaly::kModeUnknown), 1U);
  EXPECT_FALSE(rig.drive.rt_sound());
}

TEST(DriveLink, AnAnswerAboutTheModeThatNobodyAskedForIsCountedOnly) {
  Rig rig;
  rig.enable();
  rig.drive.rt_mode(mode(8));
  EXPECT_EQ(rig.count(Anomaly::kSdoUnexpected), 1U);
  EXPECT_TRUE(rig.drive.rt_sound());
}

TEST(DriveLink, ADriveThatFollowsEachControlwordAfterMoreThan10CyclesIsNotEnabled) {
  for (const int cycles : {10, 11}) {
    Rig rig;
    static_cast<void>(rig.cycle(kSwitchOnDisabled, {}));
    for (const int low_byte : {kSwitchOnDisabled, kReady, kSwitchedOn}) {
      for (int i = 0; i < cycles; ++i) {
        static_cast<void>(rig.cycle(low_byte, amperes(1)));
      }
    }
    EXPECT_EQ(rig.cycle(kEnabled, amperes(1)).torque_permille, cycles == 10 ? 500 : 0);
    EXPECT_EQ(rig.count(Anomaly::kAnswersLate), cycles == 10 ? 0U : 1U);
  }
}

TEST(DriveLink, OneFastAnswerIsEnough) {
  Rig rig;
  static_cast<void>(rig.cycle(kSwitchOnDisabled, {}));
  static_cast<void>(rig.cycle(kSwitchOnDisabled, amperes(1)));
  for (int i = 0; i < 100; ++i) {
    static_cast<void>(rig.cycle(kReady, amperes(1)));  // its power stage takes its time
  }
  static_cast<void>(rig.cycle(kSwitchedOn, amperes(1)));
  EXPECT_EQ(rig.cycle(kEnabled, amperes(1)).torque_permille, 500);
}

}  // namespace
}  // namespace capstan::cia402
