// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <bit>

#include "capstan/firmware/parameters/config.hpp"
#include "capstan/model/reciprocal.hpp"

namespace capstan {

/// Encoder counts and motor angle, with the division done once. An angle is within half a unit of its last place plus a
/// 128th of a unit for each rad.
class EncoderScale {
 public:
  constexpr explicit EncoderScale(const MotorConfig& motor)
      : counts_per_turn_(std::int64_t{motor.encoder_sign} * motor.encoder_counts_per_turn) {
    const std::int64_t size = counts_per_turn_ < 0 ? -counts_per_turn_ : counts_per_turn_;
    const std::int64_t angle = kTwoPi56 / std::max<std::int64_t>(size, 1);  // of one count, 2^-56 rad
    const int excess = 64 - std::countl_zero(static_cast<std::uint64_t>(angle)) - 31;
    const auto multiplier = static_cast<std::int32_t>(excess > 0 ? angle >> excess : angle);
    per_count_ = {counts_per_turn_ < 0 ? -multiplier : multiplier, 56 - Q24::kFrac - std::max(excess, 0)};
  }

  /// Saturated: 20 turns are all that an angle expresses.
  [[nodiscard]] constexpr auto angle_of(std::int64_t counts) const -> Q24 {
    return Q24::from_raw(per_count_(narrow_saturating<std::int64_t, std::int32_t>(counts)));
  }
  /// Nearest count; divides, so not for every cycle.
  [[nodiscard]] constexpr auto counts_of(Q24 angle) const -> std::int64_t {
    constexpr std::int64_t kTwoPi = Q24::from_double(6.283185307179586).raw();
    const std::int64_t scaled = angle.raw() * counts_per_turn_;
    return (scaled + (scaled < 0 ? -kTwoPi : kTwoPi) / 2) / kTwoPi;
  }

 private:
  static constexpr auto kTwoPi56 = static_cast<std::int64_t>(6.283185307179586 * 0x1p56);

  std::int64_t counts_per_turn_;  // with the encoder's sign
  ScaledFactor per_count_;
};

}  // namespace capstan
