// SPDX-License-Identifier: Apache-2.0
#include "capstan/firmware/loop/application.hpp"

#include <gtest/gtest.h>

#include "capstan/tests/firmware/loop/application_rig.hpp"

namespace capstan {
namespace {

using test::FakeIo;
using test::FlashBanks;
using Rig = test::ApplicationRig;

auto stored(const AxisConfig& config) -> FlashBanks {
  FlashBanks banks;
  EXPECT_TRUE(ParameterStorage(banks).save(std::span(&config, 1)));
  return banks;
}

/// A stiff set of parameters that is easy to tell from the defaults.
auto other_config() -> AxisConfig {
  AxisConfig config;
  config.limits.joint_max_rad = Q24::from_double(1.25);
  config.control.kp = Q24::from_double(0.75);
  return config;
}

TEST(Application, BeforeItsFirstCycleItIsInBootWithoutTorqueAndWithoutATemperature) {
  FakeIo<1> io;
  FlashBanks banks;
  const Application<FakeIo<1>> application(io, banks);
  EXPECT_EQ(application.telemetry().state, State::kBoot);
  EXPECT_TRUE(ScalarTraits<Q24>::is_missing(application.telemetry().temperature_c));
  EXPECT_EQ(io.writes, 0);
}

TEST(Application, StartsDisarmedAndStaysSo) {
  Rig rig;
  rig.ticks(100);
  EXPECT_EQ(rig.state(), State::kDisarmed);
  EXPECT_FALSE(rig.io.has_torque());
  EXPECT_EQ(rig.application.telemetry().conditions, 0U);
}

TEST(Application, WithoutASavedSetTheDefaultsAreInForceAndArmingIsAllowed) {
  Rig rig;
  EXPECT_TRUE(test::same(rig.application.config()[0], AxisConfig{}));
  EXPECT_TRUE(rig.arm());
  EXPECT_EQ(rig.state(), State::kHolding);
  EXPECT_TRUE(rig.io.has_torque());
}

TEST(Application, ASavedSetIsInForceFromTheFirstCycle) {
  Rig rig(stored(other_config()));
  EXPECT_TRUE(test::same(rig.application.config()[0], other_config()));
  ASSERT_TRUE(rig.arm());
  ASSERT_TRUE(rig.move(1.3));
  EXPECT_EQ(rig.state(), State::kHolding) << "1.3 rad is outside the saved joint_max";
}

TEST(Application, AnExperimentIsJudgedWhoeverBringsItAndTheReasonIsSaid) {
  Rig rig;
  ASSERT_TRUE(rig.arm());
  const ExperimentSetup sound{.recipe = Recipe::kTriangle,
                              .amplitude = Q24::from_double(0.2),
                              .rungs = {Q24::from_double(0.4)},
                              .rung_count = 1};
  ExperimentSetup too_far = sound;
  too_far.amplitude = Q24::from_int(3);
  ExperimentSetup nobody = sound;
  nobody.axis = 1;
  ExperimentSetup too_many = sound;
  too_many.rung_count = ExperimentSetup::kMostRungs + 1;
  const std::vector<std::pair<ExperimentSetup, std::string>> cases = {
      {too_far, "limits.joint_min"}, {nobody, "no such joint"}, {too_many, "at most 8"}};
  for (const auto& [setup, reason] : cases) {
    const char* problem = rig.application.begin_experiment(setup);
    ASSERT_NE(problem, nullptr) << reason;
    EXPECT_NE(std::string(problem).find(reason), std::string::npos) << problem;
    EXPECT_NE(std::string(problem).find("; "), std::string::npos) << "no cure: " << problem;
    rig.ticks(2);
    EXPECT_EQ(rig.state(), State::kHolding) << reason;
  }
  EXPECT_EQ(rig.application.begin_experiment(sound), nullptr);
  const char* problem = rig.application.begin_experiment(sound);
  ASSERT_NE(problem, nullptr);
  EXPECT_NE(std::string(problem).find("has not taken the last"), std::string::npos) << problem;
  rig.ticks(2);
  EXPECT_EQ(rig.state(), State::kExperiment);
}

TEST(Application, CorruptStorageMeansDefaultsBlocksArmingAndSaysSoUntilASetIsSaved) {
  FlashBanks banks = stored(other_config());
  banks.memory[0][60] ^= 4U;
  Rig rig(banks);
  EXPECT_TRUE(test::same(rig.application.config()[0], AxisConfig{}));
  rig.arm();
  EXPECT_EQ(rig.state(), State::kDisarmed);
  EXPECT_EQ(rig.application.telemetry().conditions, bit(Fault::kModelInvalid));
  ASSERT_TRUE(rig.application.save());
  rig.ticks(1);
  EXPECT_EQ(rig.application.telemetry().conditions, 0U);
  rig.arm();
  EXPECT_EQ(rig.state(), State::kHolding);
}

TEST(Application, AMemoryThatDoesNotAnswerIsNotTakenForAnEmptyOne) {
  FlashBanks banks = stored(other_config());
  banks.read_fails = true;
  Rig rig(banks);
  rig.arm();
  EXPECT_EQ(rig.state(), State::kDisarmed);
  EXPECT_EQ(rig.application.telemetry().conditions, bit(Fault::kStorageFailed));
  EXPECT_EQ(rig.application.load(), LoadResult::kUnreadable);
  rig.banks.read_fails = false;
  ASSERT_EQ(rig.application.load(), LoadResult::kLoaded);
  rig.ticks(1);
  EXPECT_TRUE(test::same(rig.application.config()[0], other_config()));
  rig.arm();
  EXPECT_EQ(rig.state(), State::kHolding);
}

TEST(Application, APowerCutInTheVeryFirstSaveLeavesSoundDefaultsAndArmingIsAllowed) {
  FlashBanks banks;
  const AxisConfig config = other_config();
  FlashBanks whole;
  ASSERT_TRUE(ParameterStorage(whole).save(std::span(&config, 1)));
  for (const long before_end : {1L, 3L, 10L, 19L, 200L}) {
    FlashBanks cut;
    cut.power_left = whole.bytes_changed - before_end;
    cut.tears_last_byte = true;
    ASSERT_FALSE(ParameterStorage(cut).save(std::span(&config, 1)));
    cut.power_left = -1;
    if (cut.memory == whole.memory) {
      continue;  // the last byte needed no more than the half of its bits that changed: the save is whole
    }
    Rig rig(cut);
    EXPECT_EQ(rig.application.telemetry().conditions, 0U) << before_end;
    EXPECT_TRUE(test::same(rig.application.config()[0], AxisConfig{})) << before_end;
    rig.arm();
    EXPECT_EQ(rig.state(), State::kHolding);
  }
}

TEST(Application, StoredValuesThatDoNotGoTogetherAreNotUsedAtAll) {
  AxisConfig crossed = other_config();
  crossed.limits.motor_min_rad = Q24::from_int(5);
  crossed.limits.motor_max_rad = Q24::from_int(-5);
  Rig rig(stored(crossed));
  EXPECT_TRUE(test::same(rig.application.config()[0], AxisConfig{}));
  EXPECT_EQ(rig.application.telemetry().conditions, bit(Fault::kModelInvalid));
}

TEST(Application, SaveAndLoadAreRefusedWithTorqueAndTheMemoryIsNotTouched) {
  Rig rig(stored(other_config()));
  rig.arm();
  rig.banks.bytes_changed = 0;
  EXPECT_FALSE(rig.application.save());
  EXPECT_EQ(rig.application.load(), LoadResult::kRefused);
  EXPECT_EQ(rig.banks.bytes_changed, 0);
  rig.request({.kind = Request::Kind::kDisarm});
  EXPECT_TRUE(rig.application.save());
}

TEST(Application, SaveIsRefusedWhileAnArmingIsUnderWay) {
  Rig rig;
  ASSERT_TRUE(rig.application.post({.kind = Request::Kind::kArm}));
  EXPECT_FALSE(rig.application.save());
}

TEST(Application, LoadBringsTheStoredSetIntoForce) {
  Rig rig(stored(other_config()));
  const AxisConfig defaults;
  ASSERT_TRUE(rig.application.configure(std::span(&defaults, 1), Rights::kMaintenance).taken());
  rig.ticks(1);
  ASSERT_EQ(rig.application.load(), LoadResult::kLoaded);
  EXPECT_TRUE(test::same(rig.application.config()[0], other_config()));
}

TEST(Application, LoadIsRefusedWhileAChangeIsUnderWay) {
  Rig rig(stored(other_config()));
  const AxisConfig defaults;
  ASSERT_TRUE(rig.application.configure(std::span(&defaults, 1), Rights::kMaintenance).taken());
  EXPECT_EQ(rig.application.load(), LoadResult::kRefused) << "or it would say 'loaded' and not be";
}

TEST(Application, WhoeverBringsASetItIsJudgedAndTheRefusalNamesJointAndReason) {
  using Refusal = SetAnswer::Refusal;
  Rig rig;
  AxisConfig crossed;
  crossed.limits.motor_min_rad = crossed.limits.motor_max_rad;
  const SetAnswer inconsistent = rig.application.configure(std::span(&crossed, 1), Rights::kMaintenance);
  EXPECT_EQ(inconsistent.refusal, Refusal::kInconsistent);
  EXPECT_EQ(inconsistent.axis, 0U);
  EXPECT_NE(std::string_view(inconsistent.reason).find("limits.motor_min"), std::string_view::npos);

  AxisConfig faster;
  faster.limits.current_a = Q24::from_int(5);
  const SetAnswer limit = rig.application.configure(std::span(&faster, 1), Rights::kOperator);
  EXPECT_EQ(limit.refusal, Refusal::kSafetyLimit);
  ASSERT_NE(limit.limit, nullptr);
  EXPECT_EQ(std::string_view(limit.limit->name), "current");
  EXPECT_TRUE(test::same(rig.application.config()[0], AxisConfig{})) << "nothing was changed";

  EXPECT_TRUE(rig.application.configure(std::span(&faster, 1), Rights::kMaintenance).taken());
  EXPECT_EQ(rig.application.configure(std::span(&faster, 1), Rights::kMaintenance).refusal, Refusal::kBusy);
}

TEST(Application, TheModelTheMotorAndTheLimitsDoNotChangeUnderTorque) {
  Rig rig;
  rig.arm();
  for (const ParameterInfo& parameter : parameters()) {
    AxisConfig changed;
    set_raw_value(changed, parameter, raw_value(changed, parameter) + 1);
    const bool allowed = parameter.change == ParameterChange::kAnyTime;
    EXPECT_EQ(rig.application.configure(std::span(&changed, 1), Rights::kMaintenance).taken(), allowed)
        << parameter.group << '.' << parameter.name;
    rig.ticks(1);
    const AxisConfig back;
    if (allowed) {
      EXPECT_TRUE(test::same(rig.application.config()[0], changed));
      ASSERT_TRUE(rig.application.configure(std::span(&back, 1), Rights::kMaintenance).taken());
    } else {
      EXPECT_TRUE(test::same(rig.application.config()[0], back));
    }
    rig.ticks(1);
  }
  EXPECT_EQ(rig.state(), State::kHolding);
}

TEST(Application, AFailedWriteReleasesAtOnceAndTorqueDoesNotComeBackByItself) {
  Rig rig;
  rig.arm();
  rig.ticks(10);
  rig.io.write_status = Status::kFailed;
  rig.ticks(1);
  EXPECT_EQ(rig.io.releases, 1);
  EXPECT_FALSE(rig.io.has_torque());
  rig.io.write_status = Status::kOk;
  rig.ticks(20);
  EXPECT_EQ(rig.state(), State::kFaulted);
  EXPECT_EQ(rig.fault(), Fault::kDriveFailed);
  EXPECT_FALSE(rig.io.has_torque());
}

TEST(Application, AnAmplifierThatTakesNothingBlocksArming) {
  Rig rig;
  rig.io.write_status = Status::kTimeout;
  rig.ticks(2);
  rig.arm();
  EXPECT_EQ(rig.state(), State::kDisarmed);
  EXPECT_EQ(rig.application.telemetry().conditions, bit(Fault::kDriveFailed));
}

TEST(Application, AFailedReadReleasesWithoutWritingAndIsAMissingSensor) {
  Rig rig;
  rig.arm();
  rig.ticks(10);
  const int writes = rig.io.writes;
  rig.io.read_status = Status::kFailed;
  rig.ticks(1);
  EXPECT_EQ(rig.io.writes, writes);
  EXPECT_EQ(rig.io.releases, 1);
  EXPECT_FALSE(rig.io.has_torque());
  rig.io.read_status = Status::kOk;
  rig.ticks(1);
  EXPECT_EQ(rig.fault(), Fault::kSensorMissing);
  EXPECT_FALSE(rig.io.has_torque());
}

TEST(Application, ARequestForAJointThatIsNotThereIsRefused) {
  Rig rig;
  EXPECT_FALSE(rig.application.post({.kind = Request::Kind::kMove, .axis = 1}));
  EXPECT_TRUE(rig.application.requests_taken());
}

TEST(Application, IsSettledOnlyWhenTheAnswerCanBeSeen) {
  Rig rig;
  EXPECT_TRUE(rig.application.requests_taken());
  ASSERT_TRUE(rig.application.post({.kind = Request::Kind::kArm}));
  EXPECT_FALSE(rig.application.requests_taken());
  EXPECT_FALSE(rig.application.post({.kind = Request::Kind::kMove})) << "one at a time";
  rig.ticks(1);
  EXPECT_TRUE(rig.application.requests_taken());
  EXPECT_EQ(rig.state(), State::kArmed);
}

TEST(Application, RecordingGivesEverySampleInOrderAndCountsWhatIsNotFetched) {
  Rig rig;
  SignalSample sample;
  Recorder& recorder = rig.application.recorder();
  rig.ticks(10);
  EXPECT_FALSE(recorder.next(sample)) << "nothing is recorded unasked";
  ASSERT_TRUE(recorder.start(&rig, {.signals = {find_signal("joint0.q1", 1)}, .count = 1}));
  rig.ticks(30);
  std::uint32_t last = 0;
  for (int i = 0; i < 30; ++i) {
    ASSERT_TRUE(recorder.next(sample));
    EXPECT_TRUE(i == 0 || sample.tick == last + 1);
    last = sample.tick;
  }
  EXPECT_EQ(recorder.dropped(), 0U);
  EXPECT_FALSE(recorder.start(&recorder, {.signals = {find_signal("joint0.q2", 1)}, .count = 1})) << "it is in use";
  rig.ticks(200);
  EXPECT_EQ(recorder.dropped(), 200U - 32U);
  ASSERT_TRUE(recorder.start(&rig, {.signals = {find_signal("joint0.q1", 1)}, .count = 1, .every = 10}));
  rig.ticks(30);
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(recorder.next(sample)) << "what was left of the run before is passed over";
    EXPECT_EQ(sample.tick % 10, 0U);
  }
  EXPECT_FALSE(recorder.next(sample));
}

/// A board of two axes with a joint on the first only.
struct HalfFittedIo : test::FakeIo<2> {
  auto read(Sensed<2>& sensed) noexcept -> Status {
    static_cast<void>(test::FakeIo<2>::read(sensed));
    sensed.axis[1] = {};
    return Status::kTimeout;
  }
};

TEST(Application, AJointThatIsNotFittedBlocksNothingOnceTheBoardIsTold) {
  HalfFittedIo io;
  test::FlashBanks banks;
  Application<HalfFittedIo> application(io, banks);
  const auto arm = [&] {
    EXPECT_TRUE(application.post({.kind = Request::Kind::kArm}));
    for (int i = 0; i < 10; ++i) {
      application.rt_tick();
    }
    return energised(application.telemetry().state);
  };
  EXPECT_FALSE(arm());
  EXPECT_EQ(application.telemetry().conditions, bit(Fault::kSensorMissing));
  Config<2> config{};
  config[1].motor.fitted = 0;
  ASSERT_TRUE(application.configure(config, Rights::kMaintenance).taken());
  EXPECT_TRUE(arm());
  EXPECT_TRUE(io.drive.axis[0].enabled);
  EXPECT_FALSE(io.drive.axis[1].enabled);
}

}  // namespace
}  // namespace capstan
