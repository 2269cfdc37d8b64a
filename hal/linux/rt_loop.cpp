// SPDX-License-Identifier: Apache-2.0
#include "capstan/hal/linux/rt_loop.hpp"

#include <malloc.h>
#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <fstream>
#include <stdexcept>

#include "capstan/hal/linux/edge_schedule.hpp"

namespace capstan {
namespace {

using std::chrono::nanoseconds;
constexpr std::int64_t kNsPerSecond = 1'000'000'000;

auto rt_now() -> nanoseconds {
  timespec time{};
  static_cast<void>(clock_gettime(CLOCK_MONOTONIC, &time));
  return nanoseconds(time.tv_sec * kNsPerSecond + time.tv_nsec);
}

void rt_sleep_until(nanoseconds moment) {
  const timespec time{.tv_sec = moment.count() / kNsPerSecond, .tv_nsec = moment.count() % kNsPerSecond};
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &time, nullptr) == EINTR) {
  }
}

struct PageFaults {
  std::uint64_t minor;
  std::uint64_t major;
};

auto rt_page_faults() -> PageFaults {
  rusage usage{};
  static_cast<void>(getrusage(RUSAGE_THREAD, &usage));
  return {static_cast<std::uint64_t>(usage.ru_minflt), static_cast<std::uint64_t>(usage.ru_majflt)};
}

/// The pages a cycle's stack will need exist before it needs them. Not inlined: the array must lie below the loop's own
/// frame.
[[gnu::noinline]] void touch_stack() {
  constexpr std::size_t kBytes = std::size_t{256} * 1024;
  constexpr std::size_t kSmallestPage = 4096;
  std::array<volatile unsigned char, kBytes> stack;
  for (std::size_t at = 0; at < kBytes; at += kSmallestPage) {
    stack[at] = 0;
  }
}

/// Locked kilobytes of this program, from the kernel: lock_memory() may have been called anywhere before, or not at
/// all.
auto memory_is_locked() -> bool {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    if (word == "VmLck:") {
      std::uint64_t kilobytes = 0;
      status >> kilobytes;
      return kilobytes > 0;
    }
  }
  return false;
}

auto reason(int error) -> std::string {
  return std::strerror(error);
}

}  // namespace

auto lock_memory() -> bool {
  // Freed memory stays in the program, and no allocation gets pages of its own that a free would give back.
  const bool kept = mallopt(M_TRIM_THRESHOLD, -1) == 1 && mallopt(M_MMAP_MAX, 0) == 1;
  return mlockall(MCL_CURRENT | MCL_FUTURE) == 0 && kept;
}

RtLoop::RtLoop(const RtOptions& options) : options_(options) {
  if (options.priority < sched_get_priority_min(SCHED_FIFO) || options.priority > sched_get_priority_max(SCHED_FIFO)) {
    throw std::runtime_error("Priority " + std::to_string(options.priority) + " does not exist; give one from 1 to 99");
  }
  if (options.cpu >= sysconf(_SC_NPROCESSORS_CONF)) {
    throw std::runtime_error("There is no processor " + std::to_string(options.cpu) + "; the last one is number " +
                             std::to_string(sysconf(_SC_NPROCESSORS_CONF) - 1));
  }
  if (options.period <= nanoseconds::zero()) {
    throw std::runtime_error("The period must be longer than 0; the firmware's is 1 ms");
  }
}

auto RtLoop::run_erased(ErasedCycle cycle, void* context) -> RtReport {
  RtReport report;
  prepare(report);
  if (options_.insist && !report.remarks.empty()) {
    throw std::runtime_error(report.remarks.front());
  }
  touch_stack();
  rt_run(cycle, context, report);
  return report;
}

void RtLoop::prepare(RtReport& report) const {
  if (options_.cpu >= 0) {
    cpu_set_t set;
    CPU_ZERO(&set);
    CPU_SET(static_cast<std::size_t>(options_.cpu), &set);
    if (const int error = pthread_setaffinity_np(pthread_self(), sizeof set, &set); error != 0) {
      report.remarks.push_back("The loop cannot stay on processor " + std::to_string(options_.cpu) + " (" +
                               reason(error) + "); choose one that this program may use (taskset -p $$ shows them)");
    }
  }
  const sched_param parameters{.sched_priority = options_.priority};
  const int error = pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameters);
  report.priority_granted = error == 0;
  if (error != 0) {
    static_cast<void>(prctl(PR_SET_TIMERSLACK, 1UL));  // an ordinary thread's sleeps are else lengthened by 50 us
    report.remarks.push_back("Real-time priority " + std::to_string(options_.priority) + " was refused (" +
                             reason(error) +
                             "); run as root or give the user 'rtprio 99' in /etc/security/limits.conf");
  }
  report.memory_locked = memory_is_locked();
  if (!report.memory_locked) {
    report.remarks.push_back(
        "Memory is not locked; run as root or give the user 'memlock unlimited' in /etc/security/limits.conf");
  }
}

void RtLoop::rt_run(ErasedCycle cycle, void* context, RtReport& report) {
  EdgeSchedule edges(rt_now() + options_.period, options_.period);
  const PageFaults before = rt_page_faults();
  constexpr std::uint64_t kLookEvery = 1000;
  nanoseconds last_cycle{};
  std::uint64_t page_faults = 0;
  while (!stop_.load(std::memory_order_relaxed)) {
    const nanoseconds edge = edges.next();
    rt_sleep_until(edge);
    const nanoseconds woke = rt_now();
    report.wake_up.rt_add(woke - edge);
    if (!edges.rt_woke(woke)) {
      continue;
    }
    if (report.cycles % kLookEvery == 0) {
      const PageFaults now = rt_page_faults();
      page_faults = now.minor - before.minor + now.major - before.major;
    }
    cycle(context, {report.cycles, edges.missed(), woke - edge, last_cycle, page_faults});
    ++report.cycles;
    const nanoseconds finished = rt_now();
    last_cycle = finished - woke;
    report.cycle.rt_add(last_cycle);
    edges.rt_finished(finished);
  }
  const PageFaults after = rt_page_faults();
  report.minor_faults = after.minor - before.minor;
  report.major_faults = after.major - before.major;
  report.overruns = edges.missed();
}

}  // namespace capstan
