// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace capstan::sim {

/// Pseudo-random numbers, the same on every machine: a counter passed through the splitmix64 finaliser.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  std::uint64_t next() {
    state_ += 0x9e3779b97f4a7c15U;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9U;
    z = (z ^ (z >> 27U)) * 0x94d049bb133111ebU;
    return z ^ (z >> 31U);
  }

  /// Mean 0, standard deviation 1, never beyond 6: the sum of twelve 16-bit uniform integers. Chosen over Box-Muller
  /// because it is exact in integers, whereas log and cos differ between C libraries in the last bit.
  double normal() {
    std::int64_t sum = 0;
    for (int word = 0; word < 3; ++word) {
      for (std::uint64_t bits = next(), lane = 0; lane < 4; ++lane, bits >>= 16U) {
        sum += static_cast<std::int64_t>(bits & 0xffffU);
      }
    }
    constexpr std::int64_t kMean = 12 * 65535 / 2;
    return static_cast<double>(sum - kMean) / 65536.0;
  }

 private:
  std::uint64_t state_;
};

}  // namespace capstan::sim
