// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>

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
  constexpr void approach(Q24 target, Q30 gain) { wide_ += way(target, gain.raw()); }
  /// The same with the gain `mantissa` 2^-(30 + shift).
  /// @pre 0 <= mantissa <= 2^30, 0 <= shift < 62
  constexpr void approach(Q24 target, std::int32_t mantissa, int shift) {
    const std::int64_t way_there = way(target, mantissa);
    wide_ += shift > 0 ? shift_right_rounded<1>(way_there >> (shift - 1)) : way_there;
  }

 private:
  static constexpr int kExtraBits = 30;
  /// The distance is less than 2^32, so its product with a gain stays below 2^62; in two products, each of 32 bits.
  [[nodiscard]] constexpr auto way(Q24 target, std::int32_t gain) const -> std::int64_t {
    return wide_product(target.raw(), gain) - wide_product(value().raw(), gain);
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
    // g = 1 / (T rate + 1), to 30 significant bits however small it is: the denominator, of 25 to 51 bits, goes to 32.
    constexpr std::int64_t kOne = std::int64_t{1} << Q24::kFrac;
    const std::int64_t time = time_constant.raw() > 0 ? time_constant.raw() : 0;
    const auto denominator = static_cast<std::uint64_t>(time * SecondsPerUnit * dt.rate_hz() + kOne);
    const int bits = 64 - std::countl_zero(denominator);
    const std::uint64_t normalised = bits > 32 ? denominator >> (bits - 32) : denominator << (32 - bits);
    mantissa_ = static_cast<std::int32_t>(((std::uint64_t{1} << 61) + normalised / 2) / normalised);
    shift_ = bits - 1 - Q24::kFrac;
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
