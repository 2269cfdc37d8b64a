// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <string>
#include <type_traits>
#include <vector>

#include "capstan/hal/linux/time_histogram.hpp"

namespace capstan {

struct RtOptions {
  std::chrono::nanoseconds period = std::chrono::milliseconds(1);
  int priority = 80;    ///< SCHED_FIFO, 1 to 99; above the kernel's interrupt threads (50), below its watchdogs (99)
  int cpu = -1;         ///< processor to stay on; -1: any
  bool insist = false;  ///< what the machine does not grant is an error, not a remark
};

/// What a cycle is told about the loop it runs in.
struct RtTick {
  std::uint64_t index = 0;                ///< cycles run before this one
  std::uint64_t overruns = 0;             ///< edges missed before this one
  std::chrono::nanoseconds late{};        ///< from this one's edge to the thread running
  std::chrono::nanoseconds last_cycle{};  ///< what the last one took
  std::uint64_t page_faults = 0;          ///< of the thread since the first cycle, looked at once a second
};

struct RtReport {
  std::uint64_t cycles = 0;
  std::uint64_t overruns = 0;      ///< edges skipped because a cycle began or ended too late
  std::uint64_t minor_faults = 0;  ///< page faults of the thread between the first cycle and the last
  std::uint64_t major_faults = 0;  ///< those that had to wait for a disk
  bool priority_granted = false;
  bool memory_locked = false;
  TimeHistogram wake_up;  ///< from the edge to the thread running
  TimeHistogram cycle;    ///< from there to the cycle's end
  /// What the machine did not grant: "sentence; cure".
  std::vector<std::string> remarks;
};

/// The real-time thread's loop: absolute sleeps on the monotonic clock, locked and touched memory, real-time priority.
/// Nothing in it allocates, prints or locks. Missed edges are skipped by the rule of EdgeSchedule. One run for each
/// object.
class RtLoop {
 public:
  /// Throws std::runtime_error with "sentence; cure" if the options are out of range.
  explicit RtLoop(const RtOptions& options);

  /// Runs `rt_cycle(const RtTick&)` on every edge in the calling thread, which it turns into a real-time one, until
  /// stop(). Throws std::runtime_error, before the first cycle, if something is not granted and the options insist.
  template <typename Cycle>
  auto run(Cycle&& rt_cycle) -> RtReport {
    return run_erased(
        [](void* context, const RtTick& tick) { (*static_cast<std::remove_reference_t<Cycle>*>(context))(tick); },
        &rt_cycle);
  }

  /// Ends run() after the cycle that is under way. Callable from any thread, from the cycle and from a signal handler.
  void stop() { stop_.store(true, std::memory_order_relaxed); }

 private:
  using ErasedCycle = void (*)(void*, const RtTick&);
  auto run_erased(ErasedCycle cycle, void* context) -> RtReport;
  void prepare(RtReport& report) const;
  void rt_run(ErasedCycle cycle, void* context, RtReport& report);

  RtOptions options_;
  std::atomic<bool> stop_ = false;
};
static_assert(std::atomic<bool>::is_always_lock_free, "stop() is called from signal handlers");

/// Locks all memory of the program, now and later, and keeps the allocator from giving any back. Call it once at start,
/// before threads are made. Returns false if the machine does not allow it.
[[nodiscard]] auto lock_memory() -> bool;

}  // namespace capstan
