// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/scalar.hpp"

namespace capstan {

/// A state that goes part of the way to a target at each step: x += g (target - x), 0 <= g <= 1.
/// In fixed point it is kept to 2^-54. A state kept to 2^-24 would stand still where the step is below half a unit, and
/// with a time constant of a minute that is 0.2 % before the target.
template <typename Scalar>
class WideState {
 public:
  using Gain = typename ScalarTraits<Scalar>::Gain;

  constexpr WideState() = default;
  constexpr explicit WideState(Scalar start) : value_(start) {}
  [[nodiscard]] constexpr auto value() const -> Scalar { return value_; }
  constexpr void approach(Scalar target, Gain gain) { value_ += (target - value_) * gain; }

 private:
  Scalar value_{};
};

template <>
class WideState<Q24> {
 public:
  constexpr WideState() = default;
  constexpr explicit WideState(Q24 start) : wide_(std::int64_t{start.raw()} * (std::int64_t{1} << kExtraBits)) {}
  [[nodiscard]] constexpr auto value() const -> Q24 { return Q24::from_wide(shift_right_rounded<kExtraBits>(wide_)); }
  constexpr void approach(Q24 target, Q30 gain) { wide_ += distance(target) * gain.raw(); }
  /// The same with the gain `mantissa` 2^-(30 + shift).
  /// @pre 0 <= mantissa <= 2^30, 0 <= shift < 62
  constexpr void approach(Q24 target, std::int32_t mantissa, int shift) {
    const std::int64_t half = shift > 0 ? std::int64_t{1} << (shift - 1) : 0;
    wide_ += (distance(target) * mantissa + half) >> shift;
  }

 private:
  static constexpr int kExtraBits = 30;
  /// Less than 2^32, so that its product with a gain stays below 2^62.
  [[nodiscard]] constexpr auto distance(Q24 target) const -> std::int64_t {
    return std::int64_t{target.raw()} - value().raw();
  }

  std::int64_t wide_ = 0;  // 2^-54
};

/// First-order low-pass x += g (u - x), g = dt / (T + dt), for time constants from nothing to hours.
/// @tparam SecondsPerUnit  the unit of the time constant: 1 for s, 60 for minutes, because a quantity ends at 128
template <typename Scalar, std::int32_t SecondsPerUnit = 1>
class LowPass {
 public:
  constexpr LowPass(SamplePeriod<Scalar> dt, Scalar time_constant)
      : gain_(dt.filter_gain(time_constant * SecondsPerUnit)) {}
  constexpr void start(Scalar value) { state_ = WideState<Scalar>(value); }
  constexpr auto update(Scalar input) -> Scalar {
    state_.approach(input, gain_);
    return state_.value();
  }
  [[nodiscard]] constexpr auto value() const -> Scalar { return state_.value(); }

 private:
  typename ScalarTraits<Scalar>::Gain gain_;
  WideState<Scalar> state_{};
};

template <std::int32_t SecondsPerUnit>
class LowPass<Q24, SecondsPerUnit> {
 public:
  constexpr LowPass(SamplePeriod<Q24> dt, Q24 time_constant) {
    // g = 1 / (T rate + 1), to 30 significant bits however small it is.
    constexpr std::int64_t kOne = std::int64_t{1} << Q24::kFrac;
    const std::int64_t time = time_constant.raw() > 0 ? time_constant.raw() : 0;
    const std::int64_t denominator = time * SecondsPerUnit * dt.rate_hz() + kOne;
    std::int64_t numerator = kOne;
    while (2 * numerator <= denominator) {  // at most 27 rounds: the denominator is below 2^51
      numerator *= 2;
      ++shift_;
    }
    // Long division, since numerator 2^30 is too wide for one step.
    std::int64_t mantissa = numerator / denominator;
    std::int64_t rest = numerator % denominator;
    for (int bit = 0; bit < 30; ++bit) {
      rest *= 2;
      mantissa = 2 * mantissa + (rest >= denominator ? 1 : 0);
      rest -= rest >= denominator ? denominator : 0;
    }
    mantissa_ = static_cast<std::int32_t>(mantissa + (2 * rest >= denominator ? 1 : 0));
  }
  constexpr void start(Q24 value) { state_ = WideState<Q24>(value); }
  constexpr auto update(Q24 input) -> Q24 {
    state_.approach(input, mantissa_, shift_);
    return state_.value();
  }
  [[nodiscard]] constexpr auto value() const -> Q24 { return state_.value(); }

 private:
  std::int32_t mantissa_ = 0;
  int shift_ = 0;
  WideState<Q24> state_{};
};

}  // namespace capstan
