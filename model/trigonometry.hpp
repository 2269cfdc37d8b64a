// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>

#include "capstan/model/scalar.hpp"

namespace capstan {

/// An angle without its whole turns. Sine and cosine of the fixed-point form are within kSineError of the true ones of
/// the same phase (tests/model/trigonometry_test.cpp).
template <typename Scalar>
class Phase {
 public:
  explicit Phase(Scalar angle) : angle_(angle) {}
  [[nodiscard]] auto sine_and_cosine() const -> std::array<Scalar, 2> { return {std::sin(angle_), std::cos(angle_)}; }

 private:
  Scalar angle_;
};

template <>
class Phase<Q24> {
 public:
  /// Half a unit of rounding, the polynomial's 3.4e-9 and what its steps round.
  static constexpr double kSineError = 4.0e-8;

  /// @param turns  in units of 2^-32 turn, so that it wraps as angles do
  constexpr explicit Phase(std::uint32_t turns) : turns_(turns) {}
  [[nodiscard]] constexpr auto sine() const -> Q24 {
    const std::int32_t x = folded(turns_);
    const std::int32_t u = square(Q30::from_raw(x)).raw();
    std::int32_t p = high_product_plus(kP3, kP4, u);
    p = high_product_plus(kP2, p, u);
    p = high_product_plus(kP1, p, u);
    p = high_product_plus(kP0, p, u);
    return Q24::from_raw(high_product_plus(2, p, x) >> 2);
  }
  /// Both polynomials step by step, so that each coefficient is fetched once.
  [[nodiscard, gnu::always_inline]] constexpr auto sine_and_cosine() const -> std::array<Q24, 2> {
    const std::int32_t x = folded(turns_);
    const std::int32_t y = folded(turns_ + kQuarter);
    const std::int32_t u = square(Q30::from_raw(x)).raw();
    const std::int32_t v = square(Q30::from_raw(y)).raw();
    std::int32_t p = kP4;
    std::int32_t q = kP4;
    const auto step = [&](std::int32_t coefficient) {
      p = high_product_plus(coefficient, p, u);
      q = high_product_plus(coefficient, q, v);
    };
    step(kP3);
    step(kP2);
    step(kP1);
    step(kP0);
    return {Q24::from_raw(high_product_plus(2, p, x) >> 2), Q24::from_raw(high_product_plus(2, q, y) >> 2)};
  }

 private:
  static constexpr std::uint32_t kQuarter = 0x4000'0000U;

  /// Of the angle in quarters of a turn, -1 to 1, the one with the same sine; sin(pi/2 x) = x p(x^2) with the minimax p
  /// of degree 4, which is off by 3.4e-9. Each step of it takes two bits more of the sum before, so the smaller
  /// coefficients are kept finer.
  static constexpr auto folded(std::uint32_t turns) -> std::int32_t {
    return just_32_bits(static_cast<std::int32_t>(turns + kQuarter > 2 * kQuarter ? 2 * kQuarter - turns : turns));
  }

  static constexpr std::int32_t kP0 = Q30::from_double(1.570796290022 / 4).raw();
  static constexpr std::int32_t kP1 = Q30::from_double(-0.645963359866).raw();
  static constexpr std::int32_t kP2 = Q30::from_double(0.079688480540 * 4).raw();
  static constexpr std::int32_t kP3 = Q30::from_double(-0.004672227923 * 16).raw();
  static constexpr std::int32_t kP4 = Q30::from_double(0.000150820565 * 64).raw();

  std::uint32_t turns_;
};

/// Turns a quantity into the phase `factor` x, whole turns dropped. In fixed point nothing overflows over the whole
/// range of both numbers (16384 rad), and the phase is within kPhaseError.
template <typename Scalar>
class PhaseScale {
 public:
  constexpr explicit PhaseScale(Scalar factor) : factor_(factor) {}
  [[nodiscard]] auto operator()(Scalar x) const -> Phase<Scalar> { return Phase<Scalar>(factor_ * x); }

 private:
  Scalar factor_;
};

template <>
class PhaseScale<Q24> {
 public:
  static constexpr double kPhaseError = 3.0e-9;  ///< rad

  constexpr explicit PhaseScale(Q24 factor) {
    // 2^60 / (2 pi) in two halves, so that both products fit; then to 2^-40 turns per unit.
    constexpr std::int64_t kHigh = 0x28BE60D;
    constexpr std::int64_t kLow = 0xB9391055;
    const std::int64_t turns_per_unit = (factor.raw() * kHigh + ((factor.raw() * kLow) >> 32)) >> 12;
    low_ = static_cast<std::int32_t>(turns_per_unit);
    high_ = static_cast<std::uint32_t>((turns_per_unit - low_) >> 32);
  }
  [[nodiscard]] constexpr auto operator()(Q24 x) const -> Phase<Q24> {
    // 2^-24 times 2^-40: the product modulo 2^64 is the fraction of a turn, and its upper half is the phase.
    const std::int32_t raw = just_32_bits(x.raw());
    const auto whole = static_cast<std::int32_t>(static_cast<std::uint32_t>(raw) * high_);
    return Phase<Q24>(static_cast<std::uint32_t>(high_product_plus(whole, raw, low_)));
  }

 private:
  std::uint32_t high_ = 0;  ///< turns per unit, 2^-40: high 2^32 + low
  std::int32_t low_ = 0;
};

}  // namespace capstan
