// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>

namespace capstan {

/// Distribution of short times in bins of 1 us. Fixed size, so the cycle may fill it; the maximum is exact, however
/// long.
class TimeHistogram {
 public:
  static constexpr std::size_t kBins = 2000;  ///< the last one holds all that is longer

  void rt_add(std::chrono::nanoseconds time) {
    constexpr std::int64_t kNsPerBin = 1000;
    const std::int64_t bin = std::clamp<std::int64_t>(time.count() / kNsPerBin, 0, kBins - 1);
    ++bins_[static_cast<std::size_t>(bin)];
    ++count_;
    maximum_ = std::max(maximum_, time);
  }

  [[nodiscard]] auto count() const -> std::uint64_t { return count_; }
  [[nodiscard]] auto maximum() const -> std::chrono::nanoseconds { return maximum_; }
  /// Samples from `first_us` up to, not including, `end_us`.
  [[nodiscard]] auto between(std::size_t first_us, std::size_t end_us) const -> std::uint64_t {
    std::uint64_t sum = 0;
    for (std::size_t bin = first_us; bin < std::min(end_us, kBins); ++bin) {
      sum += bins_[bin];
    }
    return sum;
  }
  /// The time that this share of samples (0 to 1) does not exceed, rounded up to a whole microsecond; 0 without
  /// samples.
  [[nodiscard]] auto quantile(double share) const -> std::chrono::nanoseconds {
    const double wanted = share * static_cast<double>(count_);
    std::uint64_t sum = 0;
    for (std::size_t bin = 0; bin + 1 < kBins && count_ > 0; ++bin) {
      sum += bins_[bin];
      if (static_cast<double>(sum) >= wanted) {
        return std::min<std::chrono::nanoseconds>(maximum_, std::chrono::microseconds(bin + 1));
      }
    }
    return maximum_;
  }

 private:
  std::array<std::uint64_t, kBins> bins_{};
  std::uint64_t count_ = 0;
  std::chrono::nanoseconds maximum_{};
};

}  // namespace capstan
