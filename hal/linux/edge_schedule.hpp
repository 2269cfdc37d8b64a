// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>

namespace capstan {

/// Which edges of a fixed grid of times are run and which are missed. The grid never moves, so a cycle is never made up
/// for by a shorter one: a cycle that cannot begin within half a period of its edge, or whose forerunner ends after its
/// edge, is skipped and counted. Two cycles therefore begin at least half a period apart, and edge = start + (run +
/// missed) * period.
class EdgeSchedule {
 public:
  using Time = std::chrono::nanoseconds;  ///< since any fixed moment

  EdgeSchedule(Time first_edge, Time period) : next_(first_edge), period_(period) {}

  /// Sleep until then.
  [[nodiscard]] auto next() const -> Time { return next_; }

  /// @return whether to run the cycle; false: too late for this edge, sleep again
  [[nodiscard]] auto rt_woke(Time now) -> bool {
    if (now - next_ <= period_ / 2) {
      return true;
    }
    rt_skip_past(now);
    return false;
  }

  /// The cycle has run.
  void rt_finished(Time now) {
    next_ += period_;
    if (now > next_) {
      rt_skip_past(now);
    }
  }

  [[nodiscard]] auto missed() const -> std::uint64_t { return missed_; }

 private:
  void rt_skip_past(Time now) {
    const auto edges = (now - next_) / period_ + 1;
    next_ += edges * period_;
    missed_ += static_cast<std::uint64_t>(edges);
  }

  Time next_;
  Time period_;
  std::uint64_t missed_ = 0;
};

}  // namespace capstan
