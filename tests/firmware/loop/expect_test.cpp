// SPDX-License-Identifier: Apache-2.0
// What a caller owes ends the program where it is not given: at once, before anything is read or written beyond its
// end.
#include "capstan/firmware/loop/expect.hpp"

#include <gtest/gtest.h>

#include <csignal>

#include "capstan/firmware/console/shell_input.hpp"
#include "capstan/firmware/control/excitation.hpp"
#include "capstan/firmware/control/force_control.hpp"
#include "capstan/firmware/control/palpation.hpp"
#include "capstan/firmware/safety/fault_log.hpp"
#include "capstan/firmware/safety/look_answer.hpp"
#include "capstan/firmware/telemetry/scope.hpp"
#include "capstan/firmware/telemetry/signals.hpp"
#include "capstan/tests/firmware/support.hpp"

namespace capstan {
namespace {

class Expect : public testing::Test {
 protected:
  void SetUp() override { testing::FLAGS_gtest_death_test_style = "threadsafe"; }
};

/// Ended by the trap and by nothing else.
auto trapped(int status) -> bool {
  return testing::KilledBySignal(SIGILL)(status) || testing::KilledBySignal(SIGTRAP)(status);
}

TEST_F(Expect, WhatHoldsIsPassedAndLookedAtOnce) {
  int looks = 0;
  CAPSTAN_EXPECT(++looks == 1);
  EXPECT_EQ(looks, 1);
}

TEST_F(Expect, WhatDoesNotHoldEndsTheProgram) {
  EXPECT_EXIT(CAPSTAN_EXPECT(1 + 1 == 3), trapped, "");
}

TEST_F(Expect, ForceControlWithoutALaw) {
  const ForceConfig none;
  ForceControl control(none);
  EXPECT_EXIT(static_cast<void>(control.rt_update(none)), trapped, "");
}

TEST_F(Expect, PalpationWithoutATensionLaw) {
  Palpation palpation;
  EXPECT_EXIT(palpation.begin(ForceConfig{}, {}), trapped, "");
}

TEST_F(Expect, CapturesThatDoNotFit) {
  ScopeSetup sound;
  sound.channel_count = 2;
  sound.samples = 100;
  sound.before = 10;
  Scope fits;
  EXPECT_TRUE(fits.start(sound));
  for (int wrong = 0; wrong < 5; ++wrong) {
    ScopeSetup setup = sound;
    setup.channel_count = wrong == 0 ? 0 : wrong == 1 ? ScopeSetup::kMostChannels + 1 : 2;
    setup.samples = wrong == 2 ? Scope::kWords : 100;
    setup.before = wrong == 3 ? 100 : 10;
    setup.every = wrong == 4 ? 0 : 1;
    Scope scope;
    EXPECT_EXIT(static_cast<void>(scope.start(setup)), trapped, "") << wrong;
  }
  Scope ended;
  EXPECT_TRUE(ended.start({}));
}

TEST_F(Expect, SignalThatThereIsNone) {
  const MachineTelemetry machine;
  EXPECT_EXIT(static_cast<void>(rt_raw(Signal{}, machine, {})), trapped, "");
}

TEST_F(Expect, SampleOfAFaultThatIsNotKept) {
  std::vector<std::uint32_t> memory(FaultLog::words_for(1));
  const FaultLog log(memory, 1);
  ASSERT_EQ(log.kept(), 0U);
  EXPECT_EXIT(static_cast<void>(log.raw(0, 0, 0)), trapped, "");
  EXPECT_EXIT(static_cast<void>(log.cycles_from_fault(0)), trapped, "");
}

TEST_F(Expect, ExcitationThatNobodyChecked) {
  ExcitationSetup setup;
  setup.from_khz = setup.to_khz = Q24{};
  EXPECT_EXIT(prepare_excitation(setup), trapped, "");
  setup.from_khz = Q24::from_double(0.001);
  setup.to_khz = Q24::from_int(100);  // harmonics of it do not fit
  EXPECT_EXIT(prepare_excitation(setup), trapped, "");
}

TEST_F(Expect, AnswerInTheRoomOfAnother) {
  test::Bench<1> bench;
  struct Endless final : Stream {
    void step(Session& /*session*/) override {}
    void cancel(Session& /*session*/) override {}
  };
  bench.shell.begin(bench.shell.make<Endless>());
  EXPECT_EXIT(static_cast<void>(bench.shell.make<Endless>()), trapped, "");
}

TEST_F(Expect, AnswerOfALookThatThereIsNone) {
  LookAnswer answer;
  EXPECT_EXIT(static_cast<void>(answer.rt_step(0, 0, 0, 0)), trapped, "");
}

}  // namespace
}  // namespace capstan
