// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>

#include "model/sample.hpp"

namespace capstan {

/// What physics says about a coefficient's sign. A fit that wants the other sign is evidence against the effect.
enum class Sign : std::uint8_t { kAny, kNonNegative, kNonPositive };

/// A parameter that multiplies a regressor.
struct CoefficientInfo {
  const char* name;
  const char* unit;
  Sign sign;
  const char* doc;
};

/// How the settings of a shape lie that are worth telling apart.
enum class ShapeScale : std::uint8_t {
  kRatio,    ///< in equal ratios: a time, a width
  kPeriods,  ///< in equal steps: periods per angle
};

/// A parameter inside a term: it bends the regressors, so a fit has to search for it.
struct ShapeInfo {
  const char* name;
  const char* unit;
  double minimum;
  double maximum;
  double initial;
  const char* doc;
  ShapeScale scale = ShapeScale::kRatio;
};

/// Everything a person, a fit and a parameter table need to know about a term.
template <std::size_t Coefficients, std::size_t Shapes>
struct TermInfo {
  const char* name;             ///< the catalogue name, snake_case
  const char* equation;         ///< what is added to the joint angle
  const char* source;           ///< where the equation is from
  const char* confusable_with;  ///< effects a poor log can not tell from it
  const char* exciting_motion;  ///< the motion that tells them apart
  std::array<CoefficientInfo, Coefficients> coefficients;
  std::array<ShapeInfo, Shapes> shapes;
};

template <typename Term>
inline constexpr std::size_t kCoefficientsOf = std::tuple_size_v<decltype(Term::kInfo.coefficients)>;
template <typename Term>
inline constexpr std::size_t kShapesOf = std::tuple_size_v<decltype(Term::kInfo.shapes)>;

/// Regressors of a term whose last two coefficients are one for each direction: of the last two, that of the present
/// direction has the value and the other is zero. Said so, and not as an array, because then the law multiplies once.
/// @tparam Own  the direction is that of the sample's own motor
template <typename Scalar, std::size_t Common = 0, bool Own = true>
struct ByDirection {
  std::array<Scalar, Common> common{};  ///< of the coefficients before those two
  Scalar value{};
  bool forward = true;

  static constexpr auto size() -> std::size_t { return Common + 2; }
  constexpr auto operator==(const ByDirection&) const -> bool = default;
  constexpr auto operator[](std::size_t k) const -> Scalar {
    if constexpr (Common > 0) {
      if (k < Common) {
        return common[k];
      }
    }
    return (k == Common) == forward ? value : Scalar{};
  }
};

/// So many numbers: an array, or a pair ByDirection.
template <typename T, typename Scalar, std::size_t Count>
concept Regressors = T {}
.size() == Count&& requires(const T& regressors, std::size_t k) {
  { regressors[k] } -> std::convertible_to<Scalar>;
};

/// A term that enters the sum: y += theta . update(sample).
/// `settled` gives the regressors that the term shows once a motion like `sample` has lasted: no memory, no state. The
/// feedforward uses it to invert the law for a motion that has not happened yet.
template <typename T, typename Scalar>
concept SumTerm = requires(T term, const T& const_term, const Sample<Scalar>& sample) {
  { term.update(sample) } -> Regressors<Scalar, kCoefficientsOf<T>>;
  { const_term.settled(sample) } -> Regressors<Scalar, kCoefficientsOf<T>>;
}
&&std::constructible_from<T, SamplePeriod<Scalar>, const std::array<Scalar, kShapesOf<T>>&>;

/// What a term has settled to does not hang on the direction or the torque of the motion: it says so with
/// `static constexpr bool kSettlesAlike = true`, and the inverse for both directions then asks it once.
template <typename Term>
consteval auto settles_alike() -> bool {
  return requires {
    requires Term::kSettlesAlike;
  };
}

/// As long as the sample is not `saturated`, no regressor of the term meets an end of the range, whatever came before:
/// it says so with `static constexpr bool kStaysInRange = true`, and the law does not ask in every cycle.
template <typename Term>
consteval auto stays_in_range() -> bool {
  return requires {
    requires Term::kStaysInRange;
  };
}

/// A term that remembers something forgets it with `restart`, and is then as newly made, but keeps what it derived from
/// its shape: that takes divisions. A term without memory has none.
template <typename Term>
constexpr void restart(Term& term) {
  if constexpr (requires { term.restart(); }) {
    term.restart();
  }
}

/// A term that acts on the finished sum, as a sensor does on what it measures: y <- update(y). It is linear in y, so a
/// fit may pass every column through it instead.
template <typename T, typename Scalar>
concept OutputTerm = requires(T term, Scalar y) {
  { term.update(y) } -> std::same_as<Scalar>;
}
&&kCoefficientsOf<T> == 0 && std::constructible_from<T, SamplePeriod<Scalar>, const std::array<Scalar, kShapesOf<T>>&>;

}  // namespace capstan
