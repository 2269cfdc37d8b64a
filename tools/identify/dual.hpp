// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "model/scalar.hpp"

namespace capstan {

/// A number with its derivatives by up to Lanes parameters (forward differentiation). Written into the laws as their scalar, it
/// gives the exact sensitivity of an estimate to every parameter, through every memory that a term has.
template <std::size_t Lanes>
struct Dual {
  double value = 0.0;
  std::array<double, Lanes> slope{};

  constexpr Dual() = default;
  constexpr explicit Dual(double v) : value(v) {}
  /// The parameter number `lane` itself.
  static constexpr auto parameter(double v, std::size_t lane) -> Dual {
    Dual x(v);
    x.slope[lane] = 1.0;
    return x;
  }

  constexpr auto operator<=>(const Dual& other) const { return value <=> other.value; }
  constexpr auto operator==(const Dual& other) const -> bool { return value == other.value; }
  constexpr auto operator-() const -> Dual { return Dual{} - *this; }
  friend constexpr auto operator+(const Dual& a, const Dual& b) -> Dual { return combine(a.value + b.value, a, 1.0, b, 1.0); }
  friend constexpr auto operator-(const Dual& a, const Dual& b) -> Dual { return combine(a.value - b.value, a, 1.0, b, -1.0); }
  friend constexpr auto operator*(const Dual& a, const Dual& b) -> Dual {
    return combine(a.value * b.value, a, b.value, b, a.value);
  }
  friend constexpr auto operator/(const Dual& a, const Dual& b) -> Dual {
    return combine(a.value / b.value, a, 1.0 / b.value, b, -a.value / (b.value * b.value));
  }
  constexpr auto operator+=(const Dual& other) -> Dual& { return *this = *this + other; }
  constexpr auto operator-=(const Dual& other) -> Dual& { return *this = *this - other; }

 private:
  static constexpr auto combine(double v, const Dual& a, double by_a, const Dual& b, double by_b) -> Dual {
    Dual result(v);
    for (std::size_t i = 0; i < Lanes; ++i) {
      result.slope[i] = by_a * a.slope[i] + by_b * b.slope[i];
    }
    return result;
  }
};

template <std::size_t Lanes>
struct ScalarTraits<Dual<Lanes>> {
  using Gain = Dual<Lanes>;
  static constexpr auto from(double value) -> Dual<Lanes> { return Dual<Lanes>(value); }
  static constexpr auto fraction(double value) -> Gain { return Gain(value); }
  static constexpr auto gain(const Dual<Lanes>& numerator, const Dual<Lanes>& denominator) -> Gain {
    return numerator / denominator;
  }
  static constexpr auto is_saturated(const Dual<Lanes>& /*x*/) -> bool { return false; }
};

template <std::size_t Lanes>
class SamplePeriod<Dual<Lanes>> {
 public:
  constexpr explicit SamplePeriod(double seconds) : seconds_(seconds) {}
  [[nodiscard]] constexpr auto rate_of(const Dual<Lanes>& difference) const -> Dual<Lanes> {
    return difference / Dual<Lanes>(seconds_);
  }
  [[nodiscard]] constexpr auto filter_gain(const Dual<Lanes>& time_constant_s) const -> Dual<Lanes> {
    return Dual<Lanes>(seconds_) / (time_constant_s + Dual<Lanes>(seconds_));
  }
  constexpr void split(const Dual<Lanes>& duration_s, std::int32_t& whole, Dual<Lanes>& fraction) const {
    const Dual<Lanes> samples = duration_s / Dual<Lanes>(seconds_);
    whole = static_cast<std::int32_t>(samples.value);
    fraction = samples - Dual<Lanes>(static_cast<double>(whole));
  }

 private:
  double seconds_;
};

}  // namespace capstan
