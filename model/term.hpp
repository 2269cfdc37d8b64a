// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <initializer_list>

#include "capstan/model/sample.hpp"

namespace capstan {

/// What is said about a coefficient's sign.
enum class Sign : std::uint8_t { kAny, kNonNegative, kNonPositive };

/// A parameter that multiplies a regressor.
struct CoefficientInfo {
  const char* name;
  const char* unit;
  Sign sign;  ///< the effect is defined with it in every regime: a fit that wants the other is evidence against it
  const char* doc;
  Sign usual = Sign::kAny;           ///< what most machines show. No fit is held to it
  const char* unusual_because = "";  ///< why a sound machine may show the other: one sentence for people
};

constexpr auto has_sign(double value, Sign sign) -> bool {
  return sign == Sign::kAny || (sign == Sign::kNonNegative ? value >= 0.0 : value <= 0.0);
}

/// How the settings of a shape lie that are worth telling apart.
enum class ShapeScale : std::uint8_t {
  kRatio,    ///< in equal ratios: a time, a width
  kPeriods,  ///< in equal steps: periods per angle
};

/// The quantity of a log that a shape is a share of, so that the limits and the start of a search follow from the log
/// and from no unit.
enum class ShapeOf : std::uint8_t {
  kNothing,      ///< a pure number: an order, a choice
  kMotorRange,   ///< range of the motor angle
  kMotorSpeed,   ///< speed of the motor that is exceeded in 1 % of the samples
  kTorqueRange,  ///< range of the motor's torque
  kOtherRange,   ///< range of the other motor's angle
  kTime,         ///< length of the log
  kGiven,        ///< set from the log before a fit, which leaves it alone
};

/// A nonlinear parameter, inside a term: it changes the form of the regressors, so a fit has to search for it.
struct ShapeInfo {
  const char* name;
  const char* unit;
  double minimum;
  double maximum;
  double initial;
  const char* doc;
  ShapeScale scale = ShapeScale::kRatio;
  ShapeOf of = ShapeOf::kNothing;
  /// Place, among the term's shapes, of the one without which (0) this one does nothing, itself perhaps; -1: none.
  std::int8_t idle_without = -1;
  bool whole = false;  ///< a count or the number of a choice: between two whole numbers it means nothing
};

/// A short list of effects by their names in the catalogue.
class Names {
 public:
  static constexpr std::size_t kMost = 8;
  constexpr Names() = default;
  /// More than kMost do not compile in a constant.
  consteval Names(std::initializer_list<const char*> names) {
    for (const char* name : names) {
      names_.at(size_++) = name;
    }
  }
  [[nodiscard]] constexpr auto begin() const -> const char* const* { return names_.data(); }
  [[nodiscard]] constexpr auto end() const -> const char* const* { return names_.data() + size_; }
  [[nodiscard]] constexpr auto empty() const -> bool { return size_ == 0; }

 private:
  std::array<const char*, kMost> names_{};
  std::size_t size_ = 0;
};

/// Motions that show effects, for the next experiment: a set of bits.
enum class Motion : std::uint8_t {
  kNone = 0,
  kSpeeds = 1,   ///< one path at several speeds
  kFast = 2,     ///< small and fast, over a decade of frequencies
  kLoops = 4,    ///< loops within loops: turns under many torques
  kSmall = 8,    ///< about as large as a play
  kHolds = 16,   ///< rest under load
  kOthers = 32,  ///< the other joints one by one, this one at rest
  kTurns = 64,   ///< as far as the joint goes
  kWarmth = 128  ///< one cycle again and again while the machine warms up
};
constexpr auto operator|(Motion a, Motion b) -> Motion {
  return static_cast<Motion>(static_cast<unsigned>(a) | static_cast<unsigned>(b));
}
constexpr auto contains(Motion all, Motion part) -> bool {
  return (static_cast<unsigned>(all) & static_cast<unsigned>(part)) == static_cast<unsigned>(part);
}

/// How a term relates to others, as data: no program reads the texts beside it.
struct TermRelations {
  Names doubles{};  ///< effects a poor log can not tell from it
  /// A difference from one of these, so no effect of its own before one of them is in the law; empty: stands alone.
  Names builds_on{};
  /// Terms that it can stand for by a choice of its shapes or coefficients. Where one of them does as well, the answer
  /// is that one.
  Names special_cases{};
  /// The same in a law of an effort, where other terms stand beside it.
  Names special_cases_of_effort{};
  Motion shown_by = Motion::kNone;  ///< beside its doubles
  bool open_shapes = false;         ///< at the ends of their ranges they say something too, so a fit may end there
  std::uint8_t slots = 0;           ///< of the coupling, from the first, that it reads
  bool form_free = false;           ///< describes what has no name; never the name of an effect
  bool placed = false;              ///< who builds a law puts it there; no candidate of the search term by term
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
  TermRelations relations{};
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

/// Regressors of a term of which two neighbours count at a time, with shares of one whole (1, or a factor of the
/// table's) that add up to it: a straight line between two values of a table. The law multiplies twice, however long
/// the table is.
template <typename Scalar, std::size_t Count>
struct Between {
  std::size_t at = 0;  ///< of the first of the two; below Count - 1
  Scalar rest{};       ///< share of the first
  Scalar share{};      ///< share of the second

  static constexpr auto size() -> std::size_t { return Count; }
  constexpr auto operator==(const Between&) const -> bool = default;
  constexpr auto operator[](std::size_t k) const -> Scalar { return k == at ? rest : (k == at + 1 ? share : Scalar{}); }
};

/// So many numbers: an array, a pair ByDirection, or two Between which it lies.
template <typename T, typename Scalar, std::size_t Count>
concept Regressors = T {}
.size() == Count&& requires(const T& regressors, std::size_t k) {
  { regressors[k] } -> std::convertible_to<Scalar>;
};

/// A term that enters the sum: y += theta . update(sample).
/// `steady_state` gives the regressors that the term shows once a motion like `sample` has lasted: no memory, no state.
/// The feedforward uses it to invert the law for a motion that has not happened yet.
template <typename T, typename Scalar>
concept SumTerm = requires(T term, const T& const_term, const Sample<Scalar>& sample) {
  { term.update(sample) } -> Regressors<Scalar, kCoefficientsOf<T>>;
  { const_term.steady_state(sample) } -> Regressors<Scalar, kCoefficientsOf<T>>;
}
&&std::constructible_from<T, SamplePeriod<Scalar>, const std::array<Scalar, kShapesOf<T>>&>;

/// A term that acts on the motor angle before the sum, as what lies between the motor and the ratio does: h <- update.
/// Zero coefficients, shapes only. `steady_state` is h once a motion in the sample's direction has lasted, `undone` the
/// motor angle to an h in steady state.
template <typename T, typename Scalar>
concept InputTerm = requires(T term, const T& const_term, const Sample<Scalar>& sample, Scalar h) {
  { term.update(sample) } -> std::same_as<Scalar>;
  { const_term.steady_state(sample) } -> std::same_as<Scalar>;
  { const_term.undone(h, true) } -> std::same_as<Scalar>;
  { const_term.is_on() } -> std::same_as<bool>;
}
&&kCoefficientsOf<T> == 0 && std::constructible_from<T, SamplePeriod<Scalar>, const std::array<Scalar, kShapesOf<T>>&>;

/// Of the coefficients of such a term only two neighbours count at a time, by shares that add up to one number in the
/// range, as one coefficient's regressor is: it says so
/// with `static constexpr bool kOneAtATime = true`, and its largest one counts where the law asks whether a sum fits.
template <typename Term>
consteval auto one_at_a_time() -> bool {
  return requires {
    requires Term::kOneAtATime;
  };
}

/// A term reads what comes out of the input terms, h or dh: it says so with `static constexpr bool kReadsInput = true`.
template <typename Term>
consteval auto reads_input() -> bool {
  return requires {
    requires Term::kReadsInput;
  };
}

/// What the steady state of a term depends on. A term says so with `static constexpr SteadyState kSteadyState`, so that
/// the inverse, which runs for both directions in every cycle, works out no more of it than it has to.
enum class SteadyState : std::uint8_t {
  kOfMotion,     ///< anything in the sample; of who says nothing
  kEitherWay,    ///< not direction and torque: the inverse asks once for both directions
  kAsItIs,       ///< nor the motion: it is what the last update gave
  kOfDirection,  ///< direction and torque alone, and no memory: it stays as long as the law
};
template <typename Term>
consteval auto steady_state_of() -> SteadyState {
  if constexpr (requires { Term::kSteadyState; }) {
    return Term::kSteadyState;
  } else {
    return SteadyState::kOfMotion;
  }
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
