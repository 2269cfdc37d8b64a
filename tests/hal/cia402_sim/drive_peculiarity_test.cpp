// SPDX-License-Identifier: Apache-2.0
// Drives as they are sold, one peculiarity at a time: what the set-up makes of each, in a time that is a number.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "capstan/hal/cia402/drive_setup.hpp"
#include "capstan/hal/cia402_sim/peculiarity.hpp"
#include "capstan/tests/hal/cia402/support.hpp"
#include "capstan/tests/hal/cia402_sim/can_rig.hpp"

namespace capstan {
namespace {

using cia402::Anomaly;
using cia402::DriveSetup;
using cia402::Frame;
using cia402::ms;
using drive_sim::Peculiarity;
using enum drive_sim::Peculiarity;

/// For the names of tests.
auto test_name(Peculiarity peculiarity) -> std::string {
  std::string text = drive_sim::name(peculiarity);
  std::replace(text.begin(), text.end(), '-', '_');
  return text;
}

/// One drive, node 1, and its set-up; every millisecond both have their turn.
struct Bench {
  explicit Bench(const drive_sim::Peculiarities& peculiarities, cia402::SetupTask task = {})
      : drive(1, sim::PlantParameters{}, 1, peculiarities), setup(on_node_1(task), journal, 1) {
    cia402::Time now = ms(100);
    constexpr int kMostMs = 200'000;
    for (; took_ms < kMostMs && setup.phase() < DriveSetup::Phase::kDone; ++took_ms, now += ms(1)) {
      if (setup.phase() == DriveSetup::Phase::kReady) {
        setup.start();
      }
      std::vector<Frame> out;
      drive.tick(now, out);
      if (const auto request = setup.next(now)) {
        drive.receive(*request, now, out);
      }
      for (const Frame& frame : out) {
        setup.receive(frame);
      }
      most_torque = std::max(most_torque, drive.current_a());
      enabled |= drive.enabled();
    }
  }
  static auto on_node_1(cia402::SetupTask task) -> cia402::SetupTask {
    task.node = 1;
    return task;
  }
  [[nodiscard]] auto done() const -> bool { return setup.phase() == DriveSetup::Phase::kDone; }
  [[nodiscard]] auto said(const std::string& part) const -> bool {
    return std::any_of(setup.notes().begin(), setup.notes().end(),
                       [&part](const std::string& note) { return note.find(part) != std::string::npos; });
  }
  [[nodiscard]] auto refused(const std::string& part) const -> bool {
    return setup.phase() == DriveSetup::Phase::kFailed && setup.problem().find(part) != std::string::npos &&
           setup.problem().find("; ") != std::string::npos;
  }

  cia402::Journal journal;
  drive_sim::SimulatedDrive drive;
  DriveSetup setup;
  int took_ms = 0;
  double most_torque = 0.0;
  bool enabled = false;
};

TEST(DrivePeculiarity, ADriveWithoutAnyIsSetUpAndNothingIsLost) {
  const Bench bench({});
  ASSERT_TRUE(bench.done()) << bench.setup.problem();
  EXPECT_EQ(bench.setup.notes().size(), 1U) << "its rated current and limit alone";
  EXPECT_TRUE(bench.said("rated current of 1500 mA"));
}

// What runs away.

TEST(DrivePeculiarity, AStoredPolarityIsWrittenAndSaid) {
  Bench bench({kReversed});
  ASSERT_TRUE(bench.done()) << bench.setup.problem();
  EXPECT_EQ(bench.drive.objects().get(0x607E), 0U);
  EXPECT_TRUE(bench.said("had 128 (0080h) stored in object 607E:00, polarity"));
}

TEST(DrivePeculiarity, APolarityThatCanNotBeWrittenIsRefused) {
  EXPECT_TRUE(Bench({kReversedForGood}).refused("607E:00, polarity; with positions reversed"));
}

TEST(DrivePeculiarity, AStoredTorqueOffsetIsWrittenOrRefused) {
  Bench bench({kTorqueOffset});
  ASSERT_TRUE(bench.done()) << bench.setup.problem();
  EXPECT_EQ(bench.drive.objects().get(0x60B2), 0U);
  EXPECT_TRUE(bench.said("60B2:00, torque offset"));
  EXPECT_TRUE(Bench({kOffsetForGood}).refused("60B2:00, torque offset; it would push"));
}

TEST(DrivePeculiarity, AStoredLimitOfTorqueIsKeptAndOneOfZeroRefused) {
  const Bench bench({kMaxTorque});
  ASSERT_TRUE(bench.done()) << bench.setup.problem();
  EXPECT_EQ(bench.setup.setting().max_torque_permille, 50);
  EXPECT_TRUE(bench.said("never asked for more than 75 mA")) << "5 % of 1500 mA";
  EXPECT_TRUE(Bench({kNoMaxTorque}).refused("6072:00, max torque; set it with the maker's tool"));
}

// What is legal and was refused.

TEST(DrivePeculiarity, PdosThatAreValidFromTheFactoryAreDisabledWithTheIdentifierTheyHave) {
  Bench bench({kFactoryPdos});
  ASSERT_TRUE(bench.done()) << bench.setup.problem();
  EXPECT_EQ(bench.drive.objects().get(0x1402, 1), 0x80000401U);
  EXPECT_EQ(bench.drive.objects().get(0x1802, 1), 0xC0000381U);
  EXPECT_EQ(bench.drive.objects().get(0x1400, 1) & 0xBFFFFFFFU, 0x201U);
  EXPECT_EQ(bench.drive.objects().get(0x1800, 1) & 0xBFFFFFFFU, 0x181U);
}

struct Case {
  Peculiarity peculiarity;
  const char* said;  ///< empty: nothing is lost
};

class Accepted : public testing::TestWithParam<Case> {};

TEST_P(Accepted, AndWhatIsLostIsSaid) {
  const Bench bench({GetParam().peculiarity});
  ASSERT_TRUE(bench.done()) << bench.setup.problem();
  if (*GetParam().said == '\0') {
    EXPECT_EQ(bench.setup.notes().size(), 1U) << bench.setup.notes().front();
  } else {
    EXPECT_TRUE(bench.said(GetParam().said)) << bench.setup.notes().front();
  }
  EXPECT_FALSE(bench.enabled) << "no set-up gives torque";
}

INSTANTIATE_TEST_SUITE_P(DrivePeculiarity, Accepted,
                         testing::Values(Case{kNo605A, "lacks object 605A:00"}, Case{kNo605E, "lacks object 605E:00"},
                                         Case{kNo60C2, "lacks object 60C2:01"}, Case{kNo6061, "lacks object 6061:00"},
                                         Case{kNo607E, ""}, Case{kConstantOptions, ""},
                                         Case{kConstantPeriod, "keeps 2 (0002h) (the object can only be read)"},
                                         Case{kQuickStop2Or6, "has 2 (0002h), not 0 (0000h), in object 605A:00"},
                                         Case{kFaultReaction2, "has 2 (0002h), not 0 (0000h), in object 605E:00"},
                                         Case{kHeartbeat100, "has 100 ms, not 90 ms, in object 1016:01"},
                                         Case{kTwoObjects, "takes 2 objects in a message"}, Case{kSegmentedSdo, ""},
                                         Case{kSlowSdo, ""}, Case{kSlowBoot, ""},
                                         Case{kModeWhenEnabled, "shows mode 0 in object 6061:00"},
                                         Case{kNo6007, "tried at this start"}),
                         [](const testing::TestParamInfo<Case>& test) { return test_name(test.param.peculiarity); });

TEST(DrivePeculiarity, TheTimeOfAConsumerThatTakesNoneBelow100MsIs100Ms) {
  Bench bench({kHeartbeat100});
  EXPECT_EQ(bench.drive.objects().get(0x1016, 1), 0x007F0064U);
}

TEST(DrivePeculiarity, OptionsHaveTheBestOfTheValuesThatTheDriveTakes) {
  EXPECT_EQ(Bench({kQuickStop2Or6}).drive.objects().get(0x605A), 2U) << "6 would keep the torque";
  EXPECT_EQ(Bench({kFaultReaction2}).drive.objects().get(0x605E), 2U);
}

TEST(DrivePeculiarity, AStatusThatDoesNotFitComesInTwoMessages) {
  Bench bench({kTwoObjects});
  ASSERT_TRUE(bench.done()) << bench.setup.problem();
  EXPECT_EQ(bench.setup.setting().maps.status[0].bytes(), 6);
  EXPECT_EQ(bench.setup.setting().maps.status[1].id, 0x281U);
  EXPECT_EQ(bench.drive.objects().get(0x1801, 1) & 0xBFFFFFFFU, 0x281U);
  EXPECT_EQ(bench.drive.objects().get(0x1A01, 1), 0x60770010U);
}

TEST(DrivePeculiarity, PackedSetValuesThatDoNotFitAreRefusedWithTheCure) {
  EXPECT_TRUE(Bench({kTwoObjects}, {.layout = cia402::PdoLayout::kPacked, .place = 0, .drives = 3})
                  .refused("leave out --pdo packed"));
}

TEST(DrivePeculiarity, SlowDrivesTakeTheirTime) {
  EXPECT_GT(Bench({kSlowBoot}).took_ms, 4000);
  EXPECT_LT(Bench({kSlowSdo}).took_ms, 60'000);
}

// That torque goes when the firmware is gone.

TEST(DrivePeculiarity, ADriveThatGoesOnWithoutItsMasterIsRefusedUnlessAWatchdogLineEndsIt) {
  for (const Peculiarity peculiarity : {kGoesOn, kNo1016, kStaysForGood}) {
    EXPECT_TRUE(Bench({peculiarity}).refused("it stayed on when heartbeats stayed out; wire a watchdog line"));
    const Bench watched({peculiarity}, {.watchdog = true});
    EXPECT_TRUE(watched.done()) << watched.setup.problem();
    EXPECT_TRUE(watched.said("the watchdog line alone takes its torque away"));
  }
}

TEST(DrivePeculiarity, AStoredErrorBehaviourThatKeepsADriveOperationalIsWritten) {
  Bench bench({kStays});
  ASSERT_TRUE(bench.done()) << bench.setup.problem();
  EXPECT_EQ(bench.drive.objects().get(0x1029, 1), 0U);
}

TEST(DrivePeculiarity, ATrialEnablesNothingAndLeavesTheVoltageOff) {
  Bench stops({kNo6007});
  ASSERT_TRUE(stops.done()) << stops.setup.problem();
  EXPECT_FALSE(stops.enabled);
  EXPECT_EQ(stops.most_torque, 0.0);
  EXPECT_EQ(stops.drive.statusword() & 0x4FU, 0x40U) << "switch on disabled";
  Bench goes_on({kGoesOn});
  EXPECT_FALSE(goes_on.enabled);
  EXPECT_EQ(goes_on.drive.statusword() & 0x4FU, 0x40U);
  EXPECT_FALSE(goes_on.drive.operational()) << "a drive that is refused is left out of operation";
}

TEST(DrivePeculiarity, AProfileMaySayThatADriveStops) {
  const std::vector<cia402::DriveProfile> profiles = {
      cia402::parse_profile("name = mine\nnode = 1\nstops_without_master = yes\n", "mine")};
  const Bench bench({kGoesOn}, {.profiles = profiles});
  EXPECT_TRUE(bench.done()) << bench.setup.problem();
  EXPECT_TRUE(bench.said("known from its profile alone"));
}

// The rated current.

TEST(DrivePeculiarity, WithoutARatedCurrentItTakesAProfile) {
  EXPECT_TRUE(Bench({kNo6075}).refused("6075:00, motor rated current; torques on the bus are thousandths of it"));
  const std::vector<cia402::DriveProfile> profiles = {
      cia402::parse_profile("name = mine\nproduct = 402\nrated_current_ma = 1500\n", "mine")};
  const Bench bench({kNo6075}, {.profiles = profiles});
  EXPECT_TRUE(bench.done()) << bench.setup.problem();
  EXPECT_EQ(bench.setup.setting().rated_current_ma, 1500);
  EXPECT_TRUE(bench.said("is treated as mine"));
}

// In the cycle.

auto peculiar(Peculiarity peculiarity) -> test::CanRig::Peculiar {
  return {{std::uint8_t{1}, {peculiarity}}};
}

class Moves : public testing::TestWithParam<Peculiarity> {};

TEST_P(Moves, TheJointAsAnyOther) {
  test::CanRig rig({}, cia402::PdoLayout::kSeparate, peculiar(GetParam()));
  rig.arm();
  rig.application().post({.kind = Request::Kind::kMove,
                          .axis = 0,
                          .position_rad = Q24::from_double(0.3),
                          .speed_rad_s = Q24::from_int(1)});
  rig.cycles(1000);
  EXPECT_EQ(rig.state(), State::kHolding) << info(rig.fault()).name << rig.said();
  EXPECT_NEAR(rig.drive(0).truth().q2_rad, 0.3, 0.1);
  for (std::size_t i = 0; i < cia402::kAnomalies; ++i) {
    EXPECT_EQ(rig.count(static_cast<Anomaly>(i)), 0U) << cia402::info(static_cast<Anomaly>(i)).name;
  }
}

INSTANTIATE_TEST_SUITE_P(DrivePeculiarity, Moves,
                         testing::Values(kReversed, kTorqueOffset, kTwoObjects, kModeWhenEnabled, kFactoryPdos,
                                         kNo6007),
                         [](const testing::TestParamInfo<Peculiarity>& test) { return test_name(test.param); });

class Silence : public testing::TestWithParam<Peculiarity> {};

TEST_P(Silence, OfTheFirmwareEndsTheTorque) {
  test::CanRig rig({}, cia402::PdoLayout::kSeparate, peculiar(GetParam()));
  rig.arm();
  int after_ms = 0;
  for (; rig.drive(0).enabled() && after_ms < 1000; ++after_ms) {
    rig.silent_cycle();
  }
  EXPECT_LE(after_ms, 102) << "at once where 90 ms are taken, else after 100 ms";
  EXPECT_FALSE(rig.drive(0).enabled());
}

INSTANTIATE_TEST_SUITE_P(DrivePeculiarity, Silence,
                         testing::Values(kNo6007, kConstantOptions, kHeartbeat100, kQuickStop2Or6, kFaultReaction2,
                                         kStays, kTwoObjects),
                         [](const testing::TestParamInfo<Peculiarity>& test) { return test_name(test.param); });

TEST(DrivePeculiarity, AStoredLimitOfTorqueIsNeverExceeded) {
  test::CanRig rig({}, cia402::PdoLayout::kSeparate, peculiar(kMaxTorque));
  rig.arm();
  rig.application().post({.kind = Request::Kind::kMove,
                          .axis = 0,
                          .position_rad = Q24::from_double(0.4),
                          .speed_rad_s = Q24::from_int(2)});
  int most = 0;
  for (int i = 0; i < 500; ++i) {
    rig.cycle();
    most = std::max(most, std::abs(static_cast<std::int16_t>(rig.drive(0).objects().get(0x6071))));
  }
  EXPECT_LE(most, 50);
  EXPECT_GT(most, 40) << "and it was asked for";
}

TEST(DrivePeculiarity, AModeThatTurnsOutWrongWhenEnabledGetsNoTorque) {
  test::CanRig rig({}, cia402::PdoLayout::kSeparate, peculiar(kWrongMode));
  rig.cycles(3);
  rig.application().post({.kind = Request::Kind::kArm});
  double most = 0.0;
  for (int i = 0; i < 50; ++i) {
    rig.cycle();
    most = std::max(most, std::abs(rig.drive(0).current_a()));
  }
  EXPECT_EQ(most, 0.0);
  EXPECT_EQ(rig.count(Anomaly::kWrongMode), 1U);
  EXPECT_FALSE(rig.drive(0).enabled());
  EXPECT_FALSE(rig.drive(1).enabled());
}

TEST(DrivePeculiarity, AStatusThatIs20MsOldIsRefusedWhenArming) {
  test::CanRig rig({}, cia402::PdoLayout::kSeparate, peculiar(kOldStatus));
  rig.cycles(30);
  rig.application().post({.kind = Request::Kind::kArm});
  double most = 0.0;
  for (int i = 0; i < 150; ++i) {
    rig.cycle();
    most = std::max(most, std::abs(rig.drive(0).current_a()));
  }
  EXPECT_EQ(most, 0.0);
  EXPECT_EQ(rig.count(Anomaly::kAnswersLate), 1U);
  EXPECT_FALSE(rig.drive(0).enabled());
}

/// The motor observer's values for the axis behind the drives.
void commission(test::CanRig& rig) {
  const sim::PlantParameters plant;
  const std::span<AxisConfig> staged = rig.application().staging(&rig);
  for (AxisConfig& axis : staged) {
    axis.observer = {.inertia_gm2 = Q24::from_double(1000.0 * plant.motor_inertia_kgm2),
                     .coulomb_nm = Q24::from_double(0.0043),
                     .noise_a = Q24::from_double(std::hypot(plant.current_noise_a, plant.current_offset_a))};
  }
  ASSERT_TRUE(rig.application().configure(staged, Rights::kMaintenance).taken());
  rig.application().end_staging(&rig);
  rig.cycles(5);
}

// That positions are fresh no message can prove: the motor observer does it when torque comes, where it is
// commissioned.

TEST(DrivePeculiarity, PositionsThatAre20MsOldAreFoundWhenArmingByTheObserver) {
  test::CanRig rig({}, cia402::PdoLayout::kSeparate, peculiar(kOldPositions));
  commission(rig);
  rig.cycles(30);
  rig.application().post({.kind = Request::Kind::kArm});
  double most = 0.0;
  for (int i = 0; i < 200; ++i) {
    rig.cycle();
    most = std::max(most, std::abs(rig.drive(0).truth().q2_rad));
  }
  EXPECT_EQ(rig.state(), State::kFaulted);
  EXPECT_EQ(rig.fault(), Fault::kEncoderFrozen) << info(rig.fault()).name;
  EXPECT_LT(most, 0.01);
}

TEST(DrivePeculiarity, TheObserverLetsADriveComeToTorqueAndMove) {
  for (const Peculiarity peculiarity : {kNo605A, kTwoObjects, kModeWhenEnabled}) {
    test::CanRig rig({}, cia402::PdoLayout::kSeparate, peculiar(peculiarity));
    commission(rig);
    rig.arm();
    rig.application().post({.kind = Request::Kind::kMove,
                            .axis = 0,
                            .position_rad = Q24::from_double(0.4),
                            .speed_rad_s = Q24::from_int(1)});
    rig.cycles(1500);
    EXPECT_EQ(rig.state(), State::kHolding) << info(rig.fault()).name;
    EXPECT_NEAR(rig.drive(0).truth().q2_rad, 0.4, 0.1);
  }
}

TEST(DrivePeculiarity, NamesAreReadAndOthersRefusedWithTheList) {
  EXPECT_EQ(drive_sim::parse_peculiarity("reversed"), kReversed);
  EXPECT_EQ(drive_sim::parse_peculiarity("two-objects"), kTwoObjects);
  EXPECT_EQ(drive_sim::parse_peculiarity("wrong-mode"), kWrongMode);
  EXPECT_THROW(static_cast<void>(drive_sim::parse_peculiarity("green")), std::runtime_error);
}

}  // namespace
}  // namespace capstan
