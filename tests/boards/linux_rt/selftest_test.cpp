// SPDX-License-Identifier: Apache-2.0
#include "capstan/boards/linux_rt/selftest.hpp"

#include <gtest/gtest.h>

#include <sstream>

namespace capstan {
namespace {

using std::chrono::microseconds;

/// A machine with nothing to complain about.
auto sound() -> SelftestResult {
  SelftestResult result;
  result.machine.real_time = true;
  result.loop.cycles = 10'000;
  result.loop.priority_granted = true;
  result.loop.memory_locked = true;
  result.firmware.state = State::kHolding;
  for (int i = 0; i < 10'000; ++i) {
    result.loop.wake_up.rt_add(microseconds(20));
    result.loop.cycle.rt_add(microseconds(40));
  }
  return result;
}

auto printed(const SelftestResult& result) -> std::string {
  std::ostringstream out;
  print_selftest(out, result);
  return out.str();
}

void expect_failure(const SelftestResult& result, const std::string& named) {
  const Verdict verdict = judge(result);
  ASSERT_EQ(verdict.failures.size(), 1U);
  EXPECT_NE(verdict.failures[0].find(named), std::string::npos) << verdict.failures[0];
  EXPECT_NE(verdict.failures[0].find("; "), std::string::npos) << "a next step is missing";
  EXPECT_NE(printed(result).find("verdict: fail; "), std::string::npos);
}

TEST(Selftest, ASoundMachinePassesWithoutNotes) {
  EXPECT_TRUE(judge(sound()).failures.empty());
  EXPECT_TRUE(judge(sound()).notes.empty());
  EXPECT_NE(printed(sound()).find("verdict: pass; "), std::string::npos);
}

TEST(Selftest, OneMissedCycleFails) {
  SelftestResult result = sound();
  result.loop.overruns = 1;
  result.loop.wake_up.rt_add(microseconds(900));
  expect_failure(result, "1 of 10001 cycles were missed");
  EXPECT_NE(judge(result).failures[0].find("woken too late"), std::string::npos);
}

TEST(Selftest, TellsALongCycleFromALateWakeUp) {
  SelftestResult result = sound();
  result.loop.overruns = 1;
  result.loop.cycle.rt_add(microseconds(1500));
  expect_failure(result, "took too long");
}

TEST(Selftest, OnePageFaultFails) {
  SelftestResult result = sound();
  result.loop.minor_faults = 1;
  expect_failure(result, "1 page faults");
}

TEST(Selftest, WhatTheMachineDidNotGrantFails) {
  SelftestResult result = sound();
  result.loop.remarks = {"Memory is not locked; run as root"};
  expect_failure(result, "Memory is not locked");
}

TEST(Selftest, AFaultOfTheFirmwareFailsAndIsNamed) {
  SelftestResult result = sound();
  result.firmware.first_fault = Fault::kFollowingError;
  expect_failure(result, "following_error");
}

TEST(Selftest, AJointWithoutTorqueFails) {
  SelftestResult result = sound();
  result.firmware.state = State::kDisarmed;
  expect_failure(result, "no torque at the end");
}

TEST(Selftest, ALoopThatNeverRanFails) {
  SelftestResult result = sound();
  result.loop.cycles = 0;
  expect_failure(result, "Not one cycle");
}

TEST(Selftest, AKernelWithoutRealTimeAndALongWakeUpAreNotesNotFailures) {
  SelftestResult result = sound();
  result.machine.real_time = false;
  result.loop.wake_up.rt_add(microseconds(101));
  EXPECT_TRUE(judge(result).failures.empty());
  EXPECT_EQ(judge(result).notes.size(), 2U);
}

TEST(Selftest, EverySampleStandsInOneLineOfTheHistogram) {
  SelftestResult result = sound();
  result.loop.wake_up.rt_add(std::chrono::seconds(3));
  const std::string text = printed(result);
  std::istringstream lines(text.substr(text.find("cycle\n")));
  std::string line;
  std::getline(lines, line);
  std::uint64_t wake_up = 0;
  while (std::getline(lines, line) && !line.empty()) {
    std::istringstream fields(line);
    std::string range;
    std::uint64_t count = 0;
    fields >> range >> count;
    wake_up += count;
  }
  EXPECT_EQ(wake_up, 10'001U);
}

TEST(Selftest, KnowsTheKernelItRunsOn) {
  EXPECT_EQ(machine_info().kernel.rfind("Linux ", 0), 0U);
}

}  // namespace
}  // namespace capstan
