// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>

#include "capstan/model/scalar.hpp"

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
  constexpr explicit WideState(Q24 start)
      : wide_(std::int64_t{start.raw()} * (std::int64_t{1} << kExtraBits) + kHalf) {}
  /// Always between the start and the targets so far, so there is nothing to saturate.
  [[nodiscard]] constexpr auto value() const -> Q24 {
    return Q24::from_raw(just_32_bits(static_cast<std::int32_t>(wide_ >> kExtraBits)));
  }
  /// @pre 0 <= gain <= 1
  constexpr void approach(Q24 target, Q30 gain) { wide_ = add_way(wide_, target, gain.raw()); }
  /// The same with the gain high 2^-30 + low 2^-62, for gains of a millionth and less.
  constexpr void approach(Q24 target, std::int32_t high, std::int32_t low) {
    const std::int64_t rest = add_way(0, target, low) >> 32;
    wide_ = add_way(wide_, target, high) + rest;
  }

 private:
  static constexpr int kExtraBits = 30;
  static constexpr std::int64_t kHalf = std::int64_t{1} << (kExtraBits - 1);
  /// The distance is less than 2^32, so its product with a gain stays below 2^63; in two products, each of 32 bits.
  [[nodiscard]] constexpr auto add_way(std::int64_t sum, Q24 target, std::int32_t gain) const -> std::int64_t {
    return sum + wide_product(just_32_bits(target.raw()), gain) + wide_product(value().raw(), -gain);
  }

  std::int64_t wide_ = kHalf;  // 2^-54, and half a unit more, so that reading it rounds
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
    // g = 1 / (T rate + 1) to 62 bits, the last 32 by long division: the denominator has 25 to 51.
    constexpr std::uint64_t kOne = std::uint64_t{1} << Q24::kFrac;
    const auto time = static_cast<std::uint64_t>(time_constant.raw() > 0 ? time_constant.raw() : 0);
    const std::uint64_t denominator = time * SecondsPerUnit * static_cast<std::uint64_t>(dt.rate_hz()) + kOne;
    std::uint64_t gain = (kOne << Q30::kFrac) / denominator;
    std::uint64_t rest = (kOne << Q30::kFrac) % denominator;
    for (int bit = 0; bit < 32; ++bit) {
      rest *= 2;
      gain = 2 * gain + (rest >= denominator ? 1 : 0);
      rest -= rest >= denominator ? denominator : 0;
    }
    low_ = static_cast<std::int32_t>(gain);
    low_ += low_ == std::numeric_limits<std::int32_t>::min() ? 1 : 0;  // it has to have an opposite
    high_ = static_cast<std::int32_t>((gain + (std::uint64_t{1} << 31U)) >> 32U);
  }
  constexpr void start(Q24 value) { state_ = WideState<Q24>(value); }
  constexpr auto update(Q24 input) -> Q24 {
    state_.approach(input, high_, low_);
    return state_.value();
  }
  [[nodiscard]] constexpr auto value() const -> Q24 { return state_.value(); }

 private:
  std::int32_t high_ = 0;
  std::int32_t low_ = 0;
  WideState<Q24> state_{};
};

}  // namespace capstan
