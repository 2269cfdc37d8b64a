// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>

#include "capstan/model/fixed.hpp"

namespace capstan {

/// What a law needs to know about the numbers it is written in, so that one template serves double and fixed point.
/// Gain: the type of factors below 2 (filter gains, fractions of a sample).
template <typename Scalar>
struct ScalarTraits;

template <>
struct ScalarTraits<double> {
  using Gain = double;
  static constexpr auto from(double value) -> double { return value; }
  static constexpr auto fraction(double value) -> Gain { return value; }
  static constexpr auto gain(double numerator, double denominator) -> double { return numerator / denominator; }
  /// A part of x, a share of it. @pre -1 <= share <= 1
  static constexpr auto part(double x, double share) -> double { return x * share; }
  /// A number from -1 to 1 as a share.
  static constexpr auto share_of(double x) -> Gain { return x; }
  /// x / 2^Bits, rounded. @pre x is not within half of that of the upper end of the range
  template <int Bits>
  static constexpr auto shifted_down(double x) -> double {
    return x / static_cast<double>(1U << static_cast<unsigned>(Bits));
  }
  /// From a to b by a share of the way, rounded once. @pre 0 <= share <= 1
  static constexpr auto between(double a, double b, double share) -> double { return a + (b - a) * share; }
  static constexpr auto is_saturated(double /*x*/) -> bool { return false; }
  static constexpr auto missing() -> double { return std::numeric_limits<double>::quiet_NaN(); }
  /// True for NaN and the infinities.
  static constexpr auto is_missing(double x) -> bool {
    return !(std::numeric_limits<double>::lowest() <= x && x <= std::numeric_limits<double>::max());
  }
};

template <>
struct ScalarTraits<Q24> {
  using Gain = Q30;
  /// Host, or constant evaluation on target: the target has no double.
  static constexpr auto from(double value) -> Q24 { return Q24::from_double(value); }
  /// A constant below 2; constant evaluation only, like `from`.
  static consteval auto fraction(double value) -> Q30 { return Q30::from_double(value); }
  static constexpr auto gain(Q24 numerator, Q24 denominator) -> Q30 { return Q30::ratio(numerator, denominator); }
  static constexpr auto part(Q24 x, Q30 share) -> Q24 { return x.fitting_product(share); }
  static constexpr auto share_of(Q24 x) -> Q30 { return Q30::from_raw(x.raw() * (1 << (Q30::kFrac - Q24::kFrac))); }
  template <int Bits>
  static constexpr auto shifted_down(Q24 x) -> Q24 {
    return Q24::from_raw((x.raw() >> Bits) + ((x.raw() >> (Bits - 1)) & 1));  // rounds; the sum with a half would wrap
  }
  static constexpr auto between(Q24 a, Q24 b, Q30 share) -> Q24 {
    const std::int32_t rest = Q30::from_int(1).raw() - share.raw();
    return Q24::from_raw(low_word_rounded<Q30::kFrac>(wide_product(just_32_bits(a.raw()), rest) +
                                                      wide_product(just_32_bits(b.raw()), share.raw())));
  }
  static constexpr auto is_saturated(Q24 x) -> bool { return x.is_saturated(); }
  /// The mark of a value nobody has given: an end of the range, where no trusted value can be.
  static constexpr auto missing() -> Q24 { return Q24::lowest(); }
  static constexpr auto is_missing(Q24 x) -> bool { return x.is_saturated(); }
};

/// Of a number from -1 to 1.
constexpr auto square(double x) -> double {
  return x * x;
}
/// Rounded down. Twice the number wraps at 1 to -2, whose square is the same.
constexpr auto square(Q30 x) -> Q30 {
  const auto twice = static_cast<std::int32_t>(static_cast<std::uint32_t>(x.raw()) << 1U);
  return Q30::from_raw(high_product(twice, twice));
}

constexpr auto abs(double x) -> double {
  return x < 0.0 ? -x : x;
}

template <typename Scalar>
constexpr auto clamp(Scalar x, Scalar low, Scalar high) -> Scalar {
  const Scalar not_above = high < x ? high : x;
  return not_above < low ? low : not_above;
}

/// Time from one sample to the next. The firmware's is the constant 1 ms; a log brings its own (double only).
template <typename Scalar>
class SamplePeriod;

template <>
class SamplePeriod<double> {
 public:
  constexpr explicit SamplePeriod(double seconds) : seconds_(seconds) {}
  [[nodiscard]] constexpr auto rate_of(double difference) const -> double { return difference / seconds_; }
  /// What changes by so much a sample changes by so much a millisecond.
  [[nodiscard]] constexpr auto per_millisecond(double change) const -> double { return change * (0.001 / seconds_); }
  /// Gain g of the first-order filter x += g (u - x) with the given time constant, s: g = dt / (T + dt). A time
  /// constant below zero counts as zero: the gain is then one, and the filter lets everything through.
  [[nodiscard]] constexpr auto filter_gain(double time_constant_s) const -> double {
    return time_constant_s > 0.0 ? seconds_ / (time_constant_s + seconds_) : 1.0;
  }
  [[nodiscard]] constexpr auto time_of(std::int32_t samples) const -> double { return samples * seconds_; }
  /// A duration in samples: whole part, and fraction in [0, 1). Durations below zero count as zero, above kMaxSplit as
  /// that.
  constexpr void split(double duration_s, std::int32_t& whole, double& fraction) const {
    constexpr double kMaxSplit = 1.0e9;
    const double wanted = duration_s / seconds_;
    const double samples = wanted > 0.0 ? (wanted < kMaxSplit ? wanted : kMaxSplit) : 0.0;  // NaN counts as zero
    whole = static_cast<std::int32_t>(samples);
    fraction = samples - static_cast<double>(whole);
  }

 private:
  double seconds_;
};

template <>
class SamplePeriod<Q24> {
 public:
  /// @param rate_hz  samples per second, 1 to 10000
  constexpr explicit SamplePeriod(std::int32_t rate_hz) : rate_hz_(rate_hz) {}
  [[nodiscard]] constexpr auto rate_of(Q24 difference) const -> Q24 {
    return Q24::from_wide(wide_product(difference.raw(), rate_hz_));
  }
  [[nodiscard]] constexpr auto per_millisecond(Q24 change) const -> Q24 {
    if (rate_hz_ == 1000) [[likely]] {  // the boards' rate
      return change;
    }
    return change * Q24::from_wide((rate_hz_ * kOne + 500) / 1000);
  }
  [[nodiscard]] constexpr auto rate_hz() const -> std::int32_t { return rate_hz_; }
  [[nodiscard]] constexpr auto filter_gain(Q24 time_constant_s) const -> Q30 {
    // dt / (T + dt) = 1 / (T rate + 1), exact in integers up to the final rounding.
    const std::int64_t denominator = not_negative(time_constant_s) * rate_hz_ + kOne;
    return Q30::from_wide(((kOne << Q30::kFrac) + denominator / 2) / denominator);
  }
  /// Within half a millionth of itself; ends at 128 s.
  [[nodiscard]] constexpr auto time_of(std::int32_t samples) const -> Q24 {
    const std::int32_t period = ((std::int32_t{1} << Q30::kFrac) + rate_hz_ / 2) / rate_hz_;
    return Q24::from_wide(shift_right_rounded<Q30::kFrac - Q24::kFrac>(wide_product(samples, period)));
  }
  constexpr void split(Q24 duration_s, std::int32_t& whole, Q30& fraction) const {
    const std::int64_t samples = not_negative(duration_s) * rate_hz_;
    whole = static_cast<std::int32_t>(samples >> Q24::kFrac);
    fraction = Q30::from_wide((samples & (kOne - 1)) << (Q30::kFrac - Q24::kFrac));
  }

 private:
  static constexpr std::int64_t kOne = std::int64_t{1} << Q24::kFrac;
  static constexpr auto not_negative(Q24 x) -> std::int64_t { return x.raw() > 0 ? x.raw() : 0; }

  std::int32_t rate_hz_;
};

}  // namespace capstan
