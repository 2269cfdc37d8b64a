// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <type_traits>

#include "capstan/model/term.hpp"

namespace capstan {

/// The joint's own measurement is late: y(t) = y0(t - D), linear between samples. It acts on the finished sum, because
/// a late sensor delays every part of the law alike; that is what tells it from viscous drag.
template <typename Scalar>
class TransportDelay {
 public:
  /// Longest delay that can be held, in samples; a longer one is cut to it. On the target 127 ms at 1 kHz, as late as a
  /// web camera's pictures; on the host the longest delay of kInfo still fits in a log of 17 kHz.
  static constexpr std::int32_t kMaxSamples = std::is_same_v<Scalar, double> ? 2047 : 127;

  static constexpr TermInfo<0, 1> kInfo = {
      .name = "transport_delay",
      .equation = "y(t) = y0(t - D)",
      .source = "sampling of two sensors by different clocks",
      .confusable_with = "transmission_viscous",
      .exciting_motion = "a multisine or chirp over a decade with fast reversals",
      .coefficients = {},
      .shapes = {{{"delay", "s", 0.0, 0.12, 0.0, "how much later the joint sensor reports than the motor's",
                   ShapeScale::kRatio, ShapeOf::kTime}}},
      .relations = {.doubles = {"transmission_viscous"}, .shown_by = Motion::kSpeeds | Motion::kFast},
  };

  constexpr TransportDelay(SamplePeriod<Scalar> dt, const std::array<Scalar, 1>& shape) {
    dt.split(shape[0], whole_, fraction_);
    if (whole_ >= kMaxSamples) {
      whole_ = kMaxSamples;
      fraction_ = {};
    }
  }

  constexpr void restart() { oldest_age_ = -1; }
  constexpr auto update(Scalar y) -> Scalar {
    newest_ = (newest_ + 1) % kSize;
    history_[newest_] = y;
    if (oldest_age_ < whole_) {
      before_ = ++oldest_age_ == 0 ? y : late_;  // what was before the first sample counts as that
    } else {
      before_ = late_;
    }
    late_ = history_[(newest_ - static_cast<std::uint32_t>(oldest_age_)) % kSize];
    return ScalarTraits<Scalar>::between(late_, before_, fraction_);
  }

 private:
  static constexpr std::uint32_t kSize = kMaxSamples + 1;
  static_assert((kSize & (kSize - 1)) == 0, "so that the remainder is a mask");

  std::array<Scalar, kSize> history_{};
  std::uint32_t newest_ = 0;
  std::int32_t whole_ = 0;
  typename ScalarTraits<Scalar>::Gain fraction_{};
  std::int32_t oldest_age_ = -1;  ///< no more than what is asked for
  Scalar late_{};                 ///< y of `whole_` samples ago, and of one more
  Scalar before_{};
};

}  // namespace capstan
