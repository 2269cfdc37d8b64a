// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cmath>
#include <limits>

#include "capstan/model/scalar.hpp"

namespace capstan {
// Seen by the templates below only if it comes before them.
constexpr auto abs(float x) -> float {
  return __builtin_fabsf(x);
}
constexpr auto square(float x) -> float {
  return x * x;
}
}  // namespace capstan

#include "capstan/model/cell_scale.hpp"
#include "capstan/model/exponential.hpp"
#include "capstan/model/reciprocal.hpp"
#include "capstan/model/trigonometry.hpp"

// Single precision for the laws, to compare with and for nothing else: with the same polynomials as fixed point, since
// the library's functions take longer. Nothing inside saturates or is asked whether it has; what float needs is that
// nothing which is not a number comes in and poisons a state for ever: see `admitted` in costs.hpp.
namespace capstan {

template <>
struct ScalarTraits<float> {
  using Gain = float;
  static constexpr auto from(double value) -> float { return static_cast<float>(value); }
  static constexpr auto fraction(double value) -> float { return static_cast<float>(value); }
  static constexpr auto gain(float numerator, float denominator) -> float { return numerator / denominator; }
  static constexpr auto part(float x, float share) -> float { return x * share; }
  static constexpr auto share_of(float x) -> float { return x; }
  template <int Bits>
  static constexpr auto shifted_down(float x) -> float {
    return x * (1.0F / static_cast<float>(1 << Bits));
  }
  static constexpr auto between(float a, float b, float share) -> float { return a + (b - a) * share; }
  static constexpr auto is_saturated(float /*x*/) -> bool { return false; }
  static constexpr auto missing() -> float { return std::numeric_limits<float>::quiet_NaN(); }
  static constexpr auto is_missing(float x) -> bool { return !(x - x == 0.0F); }
};

template <>
class SamplePeriod<float> {
 public:
  constexpr explicit SamplePeriod(float seconds)
      : seconds_(seconds), rate_hz_(1.0F / seconds), per_millisecond_(0.001F / seconds) {}
  [[nodiscard]] constexpr auto rate_of(float difference) const -> float { return difference * rate_hz_; }
  [[nodiscard]] constexpr auto per_millisecond(float change) const -> float { return change * per_millisecond_; }
  [[nodiscard]] constexpr auto filter_gain(float time_constant_s) const -> float {
    return time_constant_s > 0.0F ? seconds_ / (time_constant_s + seconds_) : 1.0F;
  }
  [[nodiscard]] constexpr auto time_of(std::int32_t samples) const -> float {
    return static_cast<float>(samples) * seconds_;
  }
  constexpr void split(float duration_s, std::int32_t& whole, float& fraction) const {
    const float samples = duration_s > 0.0F ? duration_s * rate_hz_ : 0.0F;
    whole = static_cast<std::int32_t>(samples);
    fraction = samples - static_cast<float>(whole);
  }

 private:
  float seconds_;
  float rate_hz_;
  float per_millisecond_;
};

template <>
class Reciprocal<float> {
 public:
  constexpr Reciprocal() = default;
  constexpr explicit Reciprocal(float number) : inverse_(1.0F / number) {}
  friend constexpr auto operator*(float x, const Reciprocal& r) -> float { return x * r.inverse_; }

 private:
  float inverse_ = 0.0F;
};

constexpr auto rough_quotient(float a, float b) -> float {
  return a / b;
}

template <>
class CellScale<float> {
 public:
  constexpr CellScale() = default;
  constexpr CellScale(float low, float high) : inverse_(1.0F / (high - low)) {}
  [[nodiscard]] constexpr auto fraction(float x, float low) const -> float {
    const float fraction = (x - low) * inverse_;
    return fraction < 1.0F ? fraction : 1.0F;
  }

 private:
  float inverse_ = 0.0F;
};

/// The polynomial of Phase<Q24>, the phase in quarters of a turn.
template <>
class Phase<float> {
 public:
  explicit Phase(float quarters) : quarters_(quarters) {}
  [[nodiscard]] auto sine_and_cosine() const -> std::array<float, 2> {
    return {sine_of(quarters_), sine_of(quarters_ + 1.0F)};
  }

 private:
  static auto sine_of(float quarters) -> float {
    const auto whole = static_cast<std::int32_t>(quarters * 0.25F + (quarters < 0.0F ? -0.5F : 0.5F));
    float x = quarters - 4.0F * static_cast<float>(whole);  // [-2, 2]
    x = x > 1.0F ? 2.0F - x : (x < -1.0F ? -2.0F - x : x);
    const float u = x * x;
    float p = 0.000150820565F;
    p = -0.004672227923F + p * u;
    p = 0.079688480540F + p * u;
    p = -0.645963359866F + p * u;
    p = 1.570796290022F + p * u;
    return p * x;
  }
  float quarters_;
};
template <>
class PhaseScale<float> {
 public:
  constexpr explicit PhaseScale(float factor) : quarters_per_unit_(factor * 0.636619772368F) {}
  [[nodiscard]] auto operator()(float x) const -> Phase<float> { return Phase<float>(quarters_per_unit_ * x); }

 private:
  float quarters_per_unit_;
};

namespace detail {
/// The polynomial of share_gone_of.
inline auto share_gone_of(float x) -> float {
  const float y = x * 1.44269504F;
  const auto n = static_cast<std::int32_t>(y);
  const float f = y - static_cast<float>(n);
  float q = 0.000109936021F;
  q = -0.001277473013F + q * f;
  q = 0.009582214112F + q * f;
  q = -0.055492297321F + q * f;
  q = 0.240224711051F + q * f;
  q = -0.693147089400F + q * f;
  return 1.0F - (1.0F + q * f) * std::bit_cast<float>((127 - n) << 23);
}
}  // namespace detail

/// The series of power.hpp, for 0 <= x <= 2 and p <= 4.
inline auto power(float x, float p) -> float {
  if (x <= 0.0F) {
    return 0.0F;
  }
  const auto bits = std::bit_cast<std::uint32_t>(x);
  const float m = std::bit_cast<float>((bits & 0x007F'FFFFU) | 0x3F80'0000U);
  const float s = (m - 1.41421356F) / (m + 1.41421356F);
  const float square = s * s;
  const float series = s * (1.0F + square * (1.0F / 3.0F + square * (0.2F + square * (1.0F / 7.0F))));
  const float log =
      (static_cast<float>(static_cast<std::int32_t>(bits >> 23U) - 127) + 0.5F) * 0.693147181F + 2.0F * series;
  const float rest = 2.772588722F - p * log;  // e^-rest is a sixteenth
  return rest < 22.0F ? 16.0F * (1.0F - detail::share_gone_of(rest > 0.0F ? rest : 0.0F)) : 0.0F;
}

inline auto share_gone(float a, float b) -> float {
  const float x = abs(a) / b;
  return x < 22.0F ? detail::share_gone_of(x) : 1.0F;
}
inline auto mean_decay(float x) -> float {
  return x < 0.125F ? 1.0F - (0.5F - (1.0F / 6.0F - x * (1.0F / 24.0F)) * x) * x : share_gone(x, 1.0F) / x;
}
inline auto bell(float r) -> float {
  return r * r < 22.0F ? 1.0F - detail::share_gone_of(r * r) : 0.0F;
}
template <>
class FadingScale<float> {
 public:
  constexpr explicit FadingScale(float scale) : per_scale_(1.0F / scale) {}
  [[nodiscard]] auto share_gone(float a) const -> float {
    const float x = abs(a) * per_scale_;
    return x < 22.0F ? detail::share_gone_of(x) : 1.0F;
  }

 private:
  float per_scale_;
};

}  // namespace capstan
