// SPDX-License-Identifier: Apache-2.0
// Drives as they are sold, one peculiarity at a time: what the set-up makes of each, in a time that is a number.
#include <gtest/gtest.h>

#include <algorithm>

#include "capstan/hal/cia402/drive_setup.hpp"
#include "capstan/hal/cia402_sim/simulated_drive.hpp"
#include "capstan/tests/hal/cia402/support.hpp"
#include "capstan/tests/hal/cia402_sim/peculiar_name.hpp"

namespace capstan {
namespace {

using cia402::Anomaly;
using cia402::DriveSetup;
using cia402::Frame;
using cia402::ms;
using drive_sim::Peculiarity;
using enum drive_sim::Peculiarity;

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
  EXPECT_TRUE(Bench({kOffsetForGood}).refused("60B2:00, torque offset; it would give torque without a command"));
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

INSTANTIATE_TEST_SUITE_P(
    DrivePeculiarity, Accepted,
    testing::Values(Case{kNo605A, "lacks object 605A:00"}, Case{kNo605E, "lacks object 605E:00"},
                    Case{kNo60C2, "lacks object 60C2:01"}, Case{kNo6061, "lacks object 6061:00"}, Case{kNo607E, ""},
                    Case{kConstantOptions, ""}, Case{kConstantPeriod, "keeps 2 (0002h) (the object can only be read)"},
                    Case{kQuickStop2Or6, "has 2 (0002h), not 0 (0000h), in object 605A:00"},
                    Case{kFaultReaction2, "has 2 (0002h), not 0 (0000h), in object 605E:00"},
                    Case{kHeartbeat100, "has 100 ms, not 90 ms, in object 1016:01"},
                    Case{kTwoObjects, "takes 2 objects in a message"}, Case{kSegmentedSdo, ""}, Case{kSlowSdo, ""},
                    Case{kSlowBoot, ""}, Case{kModeWhenEnabled, "shows mode 0 in object 6061:00"},
                    Case{kNo6007, "tried at this start"}),
    [](const testing::TestParamInfo<Case>& test) { return test::test_name(test.param.peculiarity); });

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

/// What must be so in a drive that is going to be enabled.
void expect_safe(Bench& bench) {
  const auto value = [&bench](std::uint16_t index, std::uint8_t subindex, std::uint32_t otherwise) {
    const auto* const entry = bench.drive.objects().find(index, subindex);
    return entry == nullptr ? otherwise : entry->value;
  };
  EXPECT_EQ(value(0x607E, 0, 0), 0U);
  EXPECT_EQ(value(0x60B2, 0, 0), 0U);
  EXPECT_EQ(value(0x1029, 1, 0), 0U);
  EXPECT_NE(value(0x6007, 0, 1), 0U);
  EXPECT_GT(value(0x1016, 1, 0) & 0xFFFFU, 0U);
  EXPECT_LE(bench.setup.setting().max_torque_permille, static_cast<int>(value(0x6072, 0, 0)));
}

TEST(DrivePeculiarity, AnyTwoTogetherEndInASafeDriveOrInASentence) {
  int set_up = 0;
  for (int first = 0; first <= static_cast<int>(kStaysForGood); ++first) {
    for (int second = 0; second < first; ++second) {
      const auto one = static_cast<Peculiarity>(first);
      const auto other = static_cast<Peculiarity>(second);
      SCOPED_TRACE(std::string(drive_sim::name(one)) + " and " + drive_sim::name(other));
      Bench bench({one, other});
      EXPECT_FALSE(bench.enabled);
      if (bench.done()) {
        ++set_up;
        expect_safe(bench);
      } else {
        EXPECT_TRUE(bench.refused("Drive 1 "));
      }
    }
  }
  EXPECT_GT(set_up, 200) << "most of the 465 are legal";
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

TEST(DrivePeculiarity, NamesAreReadAndOthersRefusedWithTheList) {
  EXPECT_EQ(drive_sim::parse_peculiarity("reversed"), kReversed);
  EXPECT_EQ(drive_sim::parse_peculiarity("two-objects"), kTwoObjects);
  EXPECT_EQ(drive_sim::parse_peculiarity("wrong-mode"), kWrongMode);
  EXPECT_THROW(static_cast<void>(drive_sim::parse_peculiarity("green")), std::runtime_error);
}

}  // namespace
}  // namespace capstan
