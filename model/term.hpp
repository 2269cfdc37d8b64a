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

/// A term that enters the sum: y += theta . update(sample).
/// `settled` gives the regressors that the term shows once a motion like `sample` has lasted: no memory, no state. The
/// feedforward uses it to invert the law for a motion that has not happened yet.
template <typename T, typename Scalar>
concept SumTerm = requires(T term, const T& const_term, const Sample<Scalar>& sample) {
  { term.update(sample) } -> std::same_as<std::array<Scalar, kCoefficientsOf<T>>>;
  { const_term.settled(sample) } -> std::same_as<std::array<Scalar, kCoefficientsOf<T>>>;
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
