// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/model/scalar.hpp"

namespace capstan {

/// Whether a signal has turned round lately: a play of the signal follows it, and is behind by its whole half width
/// where the signal went one way for as long. A return of less than a twentieth of a turn is noise.
template <typename Scalar>
class TurnPlay {
 public:
  /// @param turn  way since a reversal, in the signal's unit, up to which it counts as near to it
  /// @returns true near to a reversal
  constexpr auto update(Scalar signal, Scalar turn) -> bool {
    // Behind by kBehind of it the signal is at the one side until 1 - kBehind and at the other from 1 + kBehind on.
    const Scalar half = turn * ScalarTraits<Scalar>::from(1.0 / (1.0 + kBehind));
    middle_ = clamp(middle_, signal - half, signal + half);
    return abs(signal - middle_) < half * ScalarTraits<Scalar>::from(kBehind);
  }
  constexpr void restart() { middle_ = {}; }

 private:
  static constexpr double kBehind = 0.9;
  Scalar middle_{};
};

}  // namespace capstan
