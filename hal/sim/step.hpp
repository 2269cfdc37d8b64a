// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

namespace capstan::sim {

/// One step of a plant and of everything around it.
constexpr double kStepS = 0.001;

/// A time in whole steps, to the nearest.
inline std::size_t steps(double seconds) {
  return static_cast<std::size_t>(std::floor(seconds / kStepS + 0.5));
}

/// What a counter of 32 bits shows. Through unsigned: wrap-around is what a counter does, and is defined there.
inline std::int32_t wrap(std::int64_t value) {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(value));
}

}  // namespace capstan::sim
