// SPDX-License-Identifier: Apache-2.0
#include "capstan/firmware/telemetry/scope.hpp"

#include <gtest/gtest.h>

#include <random>

#include "capstan/firmware/control/modes.hpp"
#include "capstan/tests/firmware/support.hpp"

namespace capstan {
namespace {

/// A machine whose telemetry the test writes, and everything it ever was.
struct Recorded {
  MachineTelemetry machine;
  std::array<AxisTelemetry, 2> axes{};
};

class ScopeTest : public testing::Test {
 protected:
  /// One cycle: q2 of joint 0 is a random walk, joint 1 and the machine count.
  void cycle() {
    now_.machine.tick += 1;
    now_.axes[0].q2_rad += Q24::from_raw(static_cast<std::int32_t>(random_() % 2001) - 1000);
    now_.axes[1].current_a = Q24::from_raw(static_cast<std::int32_t>(now_.machine.tick) * 3);
    now_.axes[1].limits = static_cast<std::uint8_t>(now_.machine.tick % 32);
    all_.push_back(now_);
    scope_.rt_step(now_.machine, now_.axes);
  }
  void cycles(int count) {
    for (int i = 0; i < count; ++i) {
      cycle();
    }
  }
  static auto setup(std::size_t samples, std::size_t before, std::uint32_t every = 1) -> ScopeSetup {
    ScopeSetup setup;
    setup.channels = {find_signal("joint0.q2", 2), find_signal("joint1.current", 2), find_signal("joint1.limits", 2),
                      find_signal("machine.fault", 2)};
    setup.channel_count = 4;
    setup.samples = samples;
    setup.before = before;
    setup.every = every;
    return setup;
  }
  /// The capture against the record: sample `zero` of it was taken in cycle trigger_tick, the others around it.
  void expect_is_what_was_recorded() const {
    ASSERT_EQ(scope_.phase(), Scope::Phase::kDone);
    for (std::size_t i = 0; i < scope_.size(); ++i) {
      const auto tick = static_cast<std::int64_t>(scope_.trigger_tick()) + scope_.cycles_from_trigger(i);
      ASSERT_GE(tick, 1);
      const Recorded& then = all_[static_cast<std::size_t>(tick - 1)];
      ASSERT_EQ(scope_.raw(i, 0), then.axes[0].q2_rad.raw()) << "sample " << i;
      ASSERT_EQ(scope_.raw(i, 1), then.axes[1].current_a.raw());
      ASSERT_EQ(scope_.raw(i, 2), then.axes[1].limits);
      ASSERT_EQ(scope_.raw(i, 3), static_cast<int>(then.machine.first_fault));
    }
  }

  std::mt19937 random_{5};
  Recorded now_;
  std::vector<Recorded> all_;
  Scope scope_;
};

TEST_F(ScopeTest, AFaultIsCapturedWithWhatLedToItAndWhatFollowed) {
  ScopeSetup wanted = setup(1000, 300);
  wanted.trigger = ScopeTrigger::kFault;
  ASSERT_TRUE(scope_.start(wanted));
  cycles(2741);
  EXPECT_EQ(scope_.phase(), Scope::Phase::kWaiting);
  now_.machine.first_fault = Fault::kOverCurrent;
  cycles(699);
  EXPECT_EQ(scope_.phase(), Scope::Phase::kFilling);
  cycles(1);
  expect_is_what_was_recorded();
  EXPECT_EQ(scope_.size(), 1000U);
  EXPECT_EQ(scope_.trigger_tick(), 2742U) << "the first cycle with the fault";
  EXPECT_EQ(scope_.cycles_from_trigger(0), -300);
  EXPECT_EQ(scope_.cycles_from_trigger(999), 699);
  cycles(5000);
  expect_is_what_was_recorded();
}

TEST_F(ScopeTest, AnEarlyTriggerIsNotMissedAndHasFewerSamplesBeforeIt) {
  ScopeSetup wanted = setup(100, 50);
  wanted.trigger = ScopeTrigger::kFault;
  ASSERT_TRUE(scope_.start(wanted));
  cycles(7);
  now_.machine.first_fault = Fault::kOverrun;
  cycles(50);
  expect_is_what_was_recorded();
  EXPECT_EQ(scope_.size(), 57U);
  EXPECT_EQ(scope_.cycles_from_trigger(0), -7);
}

TEST_F(ScopeTest, EveryTriggerOnASignalFiresInTheCycleThatTheRecordSays) {
  for (const ScopeTrigger trigger :
       {ScopeTrigger::kRising, ScopeTrigger::kFalling, ScopeTrigger::kAbove, ScopeTrigger::kBelow}) {
    for (const std::int32_t offset : {-20'000, -300, 0, 300, 20'000}) {
      cycles(3);
      ScopeSetup wanted = setup(40, 10);
      wanted.trigger = trigger;
      wanted.trigger_signal = find_signal("joint0.q2", 2);
      wanted.level = now_.axes[0].q2_rad.raw() + offset;
      ASSERT_TRUE(scope_.start(wanted));
      const std::size_t begin = all_.size();
      for (int i = 0; i < 2'000'000 && (i == 0 || scope_.phase() != Scope::Phase::kDone); ++i) {
        cycle();
      }
      expect_is_what_was_recorded();
      std::size_t expected = begin;  // by brute force over the record
      for (;; ++expected) {
        const bool above = all_[expected].axes[0].q2_rad.raw() >= wanted.level;
        const bool was = expected > begin ? all_[expected - 1].axes[0].q2_rad.raw() >= wanted.level : above;
        if ((trigger == ScopeTrigger::kRising && above && !was) ||
            (trigger == ScopeTrigger::kFalling && !above && was) || (trigger == ScopeTrigger::kAbove && above) ||
            (trigger == ScopeTrigger::kBelow && !above)) {
          break;
        }
      }
      EXPECT_EQ(scope_.trigger_tick(), all_[expected].machine.tick);
    }
  }
}

TEST_F(ScopeTest, ASlowerCaptureTakesOneSampleEverySoManyCycles) {
  ScopeSetup wanted = setup(50, 20, 7);
  ASSERT_TRUE(scope_.start(wanted));
  cycles(50 * 7);
  expect_is_what_was_recorded();
  EXPECT_EQ(scope_.size(), 50U);
  EXPECT_EQ(scope_.cycles_from_trigger(21) - scope_.cycles_from_trigger(20), 7);
}

TEST_F(ScopeTest, EightChannelsOfAThousandSamplesFit) {
  ScopeSetup wanted = setup(1000, 999);
  wanted.channel_count = 8;
  for (std::size_t i = 4; i < 8; ++i) {
    wanted.channels[i] = find_signal("joint1.q1", 2);
  }
  ASSERT_TRUE(scope_.start(wanted));
  cycles(1000);
  expect_is_what_was_recorded();
  EXPECT_EQ(scope_.size(), 1000U);
}

TEST_F(ScopeTest, SkippedCyclesAreCounted) {
  ASSERT_TRUE(scope_.start(setup(100, 0)));
  now_.machine.overruns = 4;
  cycles(50);
  now_.machine.overruns += 3;
  cycles(50);
  expect_is_what_was_recorded();
  EXPECT_EQ(scope_.dropped(), 3U);
}

TEST_F(ScopeTest, ACaptureCanBeStoppedAndStartedAnewAtAnyTime) {
  ScopeSetup wanted = setup(100, 50);
  wanted.trigger = ScopeTrigger::kFault;
  ASSERT_TRUE(scope_.start(wanted));
  EXPECT_FALSE(scope_.start(wanted)) << "one at a time";
  cycles(20);
  EXPECT_EQ(scope_.phase(), Scope::Phase::kWaiting);
  ASSERT_TRUE(scope_.start({}));
  cycles(1);
  EXPECT_EQ(scope_.phase(), Scope::Phase::kIdle);
  ASSERT_TRUE(scope_.start(setup(30, 5)));
  cycles(30);
  expect_is_what_was_recorded();
}

TEST(Signals, EveryOneIsFoundByItsPrintedNameAndNoOther) {
  test::StringSink sink;
  Print out(sink);
  for (const SignalInfo& info : joint_signals()) {
    print_name(out, {&info, 1});
    const Signal found = find_signal(sink.take(), 2);
    EXPECT_EQ(found.info, &info);
    EXPECT_EQ(found.axis, 1);
  }
  for (const SignalInfo& info : machine_signals()) {
    print_name(out, {&info});
    EXPECT_EQ(find_signal(sink.take(), 2).info, &info);
  }
  for (const char* wrong : {"", "joint0", "joint0.", "joint0.q", "joint0.q22", "joint2.q2", "joint.q2", "joint00.q2",
                            "machine", "machine.q2", "joint0.state", "jointx.q2", "q2", "joint0 q2"}) {
    EXPECT_EQ(find_signal(wrong, 2).info, nullptr) << wrong;
  }
}

TEST(Signals, TheOneOfLimitsExplainsEachOfItsBits) {
  const std::string_view doc = find_signal("joint0.limits", 1).info->doc;
  for (const LimitInfo& info : kLimitTable) {
    const std::string said = " " + std::to_string(bit(info.limit)) + " " + info.name;
    EXPECT_NE(doc.find(said), std::string_view::npos) << doc << " lacks" << said;
  }
  EXPECT_NE(doc.find(" 64 corridor"), std::string_view::npos) << doc;
}

}  // namespace
}  // namespace capstan
