// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

namespace capstan::tools {

/// Small reproducible generator (SplitMix64): the same log always gets the same verdict, on every machine.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  auto bits() -> std::uint64_t {
    state_ += 0x9E3779B97F4A7C15u;
    std::uint64_t x = state_;
    x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9u;
    x = (x ^ (x >> 27)) * 0x94D049BB133111EBu;
    return x ^ (x >> 31);
  }
  /// In [0, 1).
  auto uniform() -> double { return static_cast<double>(bits() >> 11) * 0x1.0p-53; }
  /// Standard normal (Box-Muller).
  auto normal() -> double {
    return std::sqrt(-2.0 * std::log(1.0 - uniform())) * std::cos(2.0 * std::numbers::pi * uniform());
  }

 private:
  std::uint64_t state_;
};

}  // namespace capstan::tools
