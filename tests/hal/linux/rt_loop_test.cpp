// SPDX-License-Identifier: Apache-2.0
#include "capstan/hal/linux/rt_loop.hpp"

#include <gtest/gtest.h>
#include <sched.h>

#include <cstdlib>
#include <new>
#include <stdexcept>
#include <thread>

namespace {
thread_local std::uint64_t allocations = 0;
}  // namespace

// Every allocation of this program passes here, so that a test can tell whether the loop makes any. Not inlined: the
// compiler would see malloc meet delete and take it for a mistake.
[[gnu::noinline]] void* operator new(std::size_t size) {
  ++allocations;
  if (void* memory = std::malloc(size)) {
    return memory;
  }
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* memory) noexcept {
  std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}

namespace capstan {
namespace {

using std::chrono::milliseconds;
using std::chrono::nanoseconds;
using std::chrono::steady_clock;

// What a loaded machine does to the figures is its own affair: these tests assert only what must hold on any.

/// In a thread of its own, as boards do: it would make the test's own thread a real-time one.
template <typename Cycle>
auto run_in_thread(RtLoop& loop, Cycle&& cycle) -> RtReport {
  RtReport report;
  std::thread([&] { report = loop.run(cycle); }).join();
  return report;
}

TEST(RtLoop, RunsUntilToldToStopAndNeverFasterThanItsPeriod) {
  RtLoop loop({});
  constexpr std::uint64_t kCycles = 300;
  const auto start = steady_clock::now();
  const RtReport report = run_in_thread(loop, [&](const RtTick& tick) {
    if (tick.index + 1 == kCycles) {
      loop.stop();
    }
  });
  const auto took = steady_clock::now() - start;
  EXPECT_EQ(report.cycles, kCycles);
  EXPECT_EQ(report.cycle.count(), kCycles);
  EXPECT_GE(report.wake_up.count(), kCycles);
  EXPECT_GE(took, milliseconds(kCycles + report.overruns)) << "every cycle and every missed edge takes a period";
}

TEST(RtLoop, CountsItsCyclesWithoutGaps) {
  RtLoop loop({.period = std::chrono::microseconds(200)});
  std::uint64_t expected = 0;
  bool gap = false;
  static_cast<void>(run_in_thread(loop, [&](const RtTick& tick) {
    gap = gap || tick.index != expected;
    if (++expected == 100) {
      loop.stop();
    }
  }));
  EXPECT_FALSE(gap);
}

TEST(RtLoop, ALongCycleIsCountedAndTheNextOneIsToldAndNotHurried) {
  RtLoop loop({});
  std::uint64_t told = 0;
  steady_clock::time_point end_of_long;
  steady_clock::time_point begin_of_second_after;
  const RtReport report = run_in_thread(loop, [&](const RtTick& tick) {
    if (tick.index == 5) {
      std::this_thread::sleep_for(milliseconds(10));
      end_of_long = steady_clock::now();
    } else if (tick.index == 6) {
      told = tick.overruns;
    } else if (tick.index == 7) {
      begin_of_second_after = steady_clock::now();
      loop.stop();
    }
  });
  EXPECT_GE(told, 9U) << "ten periods passed inside one cycle";
  EXPECT_GE(report.overruns, told);
  EXPECT_GE(report.cycle.maximum(), milliseconds(10));
  EXPECT_GE(begin_of_second_after - end_of_long, std::chrono::microseconds(500))
      << "two cycles at once would be a burst";
}

TEST(RtLoop, DoesNotAllocateWhileItRuns) {
  RtLoop loop({});
  std::uint64_t at_first = 0;
  std::uint64_t at_last = 0;
  static_cast<void>(run_in_thread(loop, [&](const RtTick& tick) {
    if (tick.index == 0) {
      at_first = allocations;
    }
    at_last = allocations;
    if (tick.index == 99) {
      loop.stop();
    }
  }));
  EXPECT_EQ(at_last, at_first);
  EXPECT_GT(at_first, 0U) << "the counter works: start-up does allocate";
}

TEST(RtLoop, WhatIsNotGrantedIsSaidWithACure) {
  RtLoop loop({});
  const RtReport report = run_in_thread(loop, [&](const RtTick&) { loop.stop(); });
  EXPECT_EQ(report.remarks.empty(), report.priority_granted && report.memory_locked);
  for (const std::string& remark : report.remarks) {
    EXPECT_NE(remark.find("; "), std::string::npos) << remark;
  }
}

TEST(RtLoop, RunsAtTheGrantedRealTimePriority) {
  RtLoop loop({.priority = 42});
  int policy = -1;
  sched_param parameters{};
  const RtReport report = run_in_thread(loop, [&](const RtTick&) {
    static_cast<void>(pthread_getschedparam(pthread_self(), &policy, &parameters));
    loop.stop();
  });
  if (!report.priority_granted) {
    GTEST_SKIP() << "this machine grants no real-time priority";
  }
  EXPECT_EQ(policy, SCHED_FIFO);
  EXPECT_EQ(parameters.sched_priority, 42);
}

TEST(RtLoop, InsistingOnMemoryThatIsNotLockedIsRefusedBeforeTheFirstCycle) {
  RtLoop loop({.insist = true});
  bool ran = false;
  bool refused = false;
  std::thread([&] {
    try {
      static_cast<void>(loop.run([&](const RtTick&) {
        ran = true;
        loop.stop();
      }));
    } catch (const std::runtime_error&) {
      refused = true;
    }
  }).join();
  EXPECT_TRUE(refused) << "this program has not called lock_memory()";
  EXPECT_FALSE(ran);
}

TEST(RtLoop, ImpossibleOptionsAreRefused) {
  EXPECT_THROW(RtLoop({.priority = 0}), std::runtime_error);
  EXPECT_THROW(RtLoop({.priority = 100}), std::runtime_error);
  EXPECT_THROW(RtLoop({.cpu = 100'000}), std::runtime_error);
  EXPECT_THROW(RtLoop({.period = nanoseconds(0)}), std::runtime_error);
}

}  // namespace
}  // namespace capstan
