// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>
#include <utility>

#include "capstan/model/cell_scale.hpp"
#include "capstan/model/term.hpp"

namespace capstan {

/// What a table may be drawn over.
enum class TableSignal : std::uint8_t {
  kMotorAngle,        ///< h, the motor angle behind the input terms, rad
  kTorque,            ///< of the motor, N m
  kRate,              ///< of the motor, rad/s
  kSinceReversal,     ///< time, s
  kTravelledSince,    ///< the motor's way since its last reversal, rad
  kOtherAngle,        ///< of the first joint of the coupling, rad
  kSecondOtherAngle,  ///< of the second
  kThirdOtherAngle,   ///< of the third
  kWarmth,            ///< temperature above 25 degrees Celsius, K
};
inline constexpr int kTableSignals = 9;

/// In words, with the unit.
constexpr auto describe(TableSignal signal) -> const char* {
  constexpr std::array<const char*, kTableSignals> kWords = {"motor angle, rad",
                                                             "motor torque, Nm",
                                                             "motor rate, rad/s",
                                                             "time since the last reversal, s",
                                                             "motor's way since the last reversal, rad",
                                                             "the coupled joint's motor angle, rad",
                                                             "the second coupled joint's motor angle, rad",
                                                             "the third coupled joint's motor angle, rad",
                                                             "temperature above 25 C, K"};
  return kWords[static_cast<std::size_t>(signal)];
}

/// What the values of a table are multiplied by: each is then a gain, rad per unit of the factor. A factor enters as it
/// is measured, by no range: the law holds every one of them within +-128, and a product with a share of a cell, 0 to
/// 1, is no larger, so fixed point loses nothing but its last place.
enum class TableFactor : std::uint8_t {
  kOne,         ///< the values stand alone, rad
  kTorque,      ///< of the motor, N m
  kRate,        ///< of the motor, rad/s
  kMotorAngle,  ///< q1, in front of the input terms, rad
};
inline constexpr int kTableFactors = 4;

/// In words, with the unit; empty for one.
constexpr auto describe(TableFactor factor) -> const char* {
  constexpr std::array<const char*, kTableFactors> kWords = {"", "motor torque, Nm", "motor rate, rad/s",
                                                             "motor angle, rad"};
  return kWords[static_cast<std::size_t>(factor)];
}

/// Where a fraction of the way through so many equal cells lies: the cell, and the share of it that is behind.
template <std::floating_point Real>
constexpr void split_cells(Real fraction, std::int32_t cells, std::size_t& at, Real& share) {
  const Real place = fraction * static_cast<Real>(cells);
  const auto whole = static_cast<std::int32_t>(place);
  const std::int32_t cell = whole < cells ? whole : cells - 1;
  at = static_cast<std::size_t>(cell);
  share = place - static_cast<Real>(cell);
}
constexpr void split_cells(Q30 fraction, std::int32_t cells, std::size_t& at, Q24& share) {
  const std::int64_t place = wide_product(fraction.raw(), cells);
  const auto whole = static_cast<std::int32_t>(place >> Q30::kFrac);
  const std::int32_t cell = whole < cells ? whole : cells - 1;
  at = static_cast<std::size_t>(cell);
  constexpr int kShift = Q30::kFrac - Q24::kFrac;
  share = Q24::from_raw(low_word_rounded<kShift>(place - std::int64_t{cell} * (std::int64_t{1} << Q30::kFrac)));
}

namespace table_names {

inline constexpr std::size_t kKnots = 17;

/// "forward_7", "backward_32".
struct Name {
  std::array<char, 12> text{};
};
consteval auto make() -> std::array<Name, 2 * kKnots> {
  std::array<Name, 2 * kKnots> names;
  for (std::size_t k = 0; k < names.size(); ++k) {
    std::size_t size = 0;
    for (const char* c = k < kKnots ? "forward_" : "backward_"; *c != '\0'; ++c) {
      names[k].text[size++] = *c;
    }
    const std::size_t knot = k % kKnots;
    if (knot > 9) {
      names[k].text[size++] = static_cast<char>('0' + knot / 10);
    }
    names[k].text[size++] = static_cast<char>('0' + knot % 10);
  }
  return names;
}
inline constexpr std::array<Name, 2 * kKnots> kNames = make();

template <std::size_t... K>
consteval auto coefficients(std::index_sequence<K...> /*all*/) -> std::array<CoefficientInfo, sizeof...(K)> {
  return {CoefficientInfo{kNames[K].text.data(), "rad", Sign::kAny,
                          K < kKnots
                              ? "value at this knot while the motor goes forward; per unit of the factor, if any"
                              : "value at this knot while the motor goes backward; per unit of the factor, if any"}...};
}
inline constexpr std::array<CoefficientInfo, 2 * kKnots> kCoefficients =
    coefficients(std::make_index_sequence<2 * kKnots>{});

}  // namespace table_names

/// What has no name, as it looks: the correction over one signal, a straight line from knot to knot, a table for each
/// direction, times a factor where one is chosen:
///   factor . (value_k (1 - s) + value_k+1 s),  s the share of the cell that is behind.
/// Knots lie evenly from `low` to `high`; outside, the end knot's value holds. The coefficients are the values at the
/// knots, so the law is linear in them like in any others, and in each cycle two of them count.
template <typename Scalar>
class Table {
 public:
  /// Of each direction. A finer table would be a copy of the residual.
  static constexpr std::size_t kKnots = table_names::kKnots;

  // The unit of low and high is the signal's.
  static constexpr TermInfo<2 * kKnots, 5> kInfo = {
      .name = "table",
      .equation =
          "straight lines between the values at evenly spaced knots of one signal, by direction, times a factor",
      .source = "form-free: what is seen and has no name",
      .confusable_with = "whatever depends on the same signal",
      .exciting_motion = "all of the signal's range, both ways, more than once",
      .coefficients = table_names::kCoefficients,
      .shapes =
          {{{"signal", "1", 0.0, kTableSignals - 1.0, 0.0,
             "0 motor angle, 1 torque, 2 rate, 3 time since a reversal, 4 way since it, 5 to 7 the coupled "
             "joints' motor angles, 8 temperature above 25 C",
             ShapeScale::kPeriods, ShapeOf::kGiven, -1, true},
            {"knots", "1", 0.0, kKnots, kKnots, "knots in use of each direction, 2 and more; less: no table",
             ShapeScale::kPeriods, ShapeOf::kGiven, -1, true},
            {"low", "1", -127.0, 127.0, -1.0, "the signal at the first knot", ShapeScale::kPeriods, ShapeOf::kGiven},
            {"high", "1", -127.0, 127.0, 1.0, "the signal at the last knot", ShapeScale::kPeriods, ShapeOf::kGiven},
            {"factor", "1", 0.0, kTableFactors - 1.0, 0.0,
             "what the values are multiplied by: 0 one, 1 torque, 2 rate, 3 motor angle", ShapeScale::kPeriods,
             ShapeOf::kGiven, -1, true}}},
      .relations = {.form_free = true, .placed = true},
  };

  static constexpr bool kStaysInRange = true;
  static constexpr bool kOneAtATime = true;
  static constexpr bool kReadsInput = true;

  constexpr Table(SamplePeriod<Scalar> dt, const std::array<Scalar, 5>& shape)
      : dt_(dt),
        signal_(static_cast<TableSignal>(whole(shape[0], kTableSignals - 1))),
        cells_(whole(shape[1], static_cast<std::int32_t>(kKnots)) - 1),
        factor_(static_cast<TableFactor>(whole(shape[4], kTableFactors - 1))),
        low_(shape[2]),
        high_(shape[3]) {
    if (low_ < high_ && cells_ > 0) {
      scale_ = CellScale<Scalar>(low_, high_);
    } else {
      cells_ = 0;
    }
  }
  constexpr void restart() {
    since_ = 0;
    forward_ = true;
  }

  constexpr auto update(const Sample<Scalar>& s) -> Between<Scalar, 2 * kKnots> {
    since_ = s.forward == forward_ ? (since_ < kLongest ? since_ + 1 : since_) : 0;
    forward_ = s.forward;
    return at(read<false>(s), s);
  }
  /// What a reversal began is over.
  [[nodiscard]] constexpr auto steady_state(const Sample<Scalar>& s) const -> Between<Scalar, 2 * kKnots> {
    return at(read<true>(s), s);
  }

 private:
  using Traits = ScalarTraits<Scalar>;
  static constexpr Scalar kOne = Traits::from(1.0);
  static constexpr Scalar kHalf = Traits::from(0.5);
  static constexpr std::int32_t kLongest = 1'000'000'000;

  static constexpr auto whole(Scalar x, std::int32_t most) -> std::int32_t {
    std::int32_t count = 0;
    for (Scalar next = kHalf; count < most && next <= x; next += kOne) {
      ++count;
    }
    return count;
  }

  template <bool Settled>
  [[nodiscard]] constexpr auto read(const Sample<Scalar>& s) const -> Scalar {
    switch (signal_) {
      case TableSignal::kMotorAngle:
        return s.h;
      case TableSignal::kTorque:
        return s.tau;
      case TableSignal::kRate:
        return s.dq1;
      case TableSignal::kSinceReversal:
        return Settled ? high_ : dt_.time_of(since_);
      case TableSignal::kTravelledSince:
        return Settled ? high_ : abs(s.q1 - s.q1_reversal);
      case TableSignal::kOtherAngle:
        return s.others[0].q1;
      case TableSignal::kSecondOtherAngle:
        return s.others[1].q1;
      case TableSignal::kThirdOtherAngle:
        return s.others[2].q1;
      case TableSignal::kWarmth:
        return s.warmth;
    }
    return Scalar{};
  }
  [[nodiscard]] constexpr auto factor(const Sample<Scalar>& s) const -> Scalar {
    switch (factor_) {
      case TableFactor::kTorque:
        return s.tau;
      case TableFactor::kRate:
        return s.dq1;
      case TableFactor::kMotorAngle:
        return s.q1;
      case TableFactor::kOne:
        break;
    }
    return kOne;
  }
  [[nodiscard]] constexpr auto at(Scalar x, const Sample<Scalar>& s) const -> Between<Scalar, 2 * kKnots> {
    Between<Scalar, 2 * kKnots> place;
    if (cells_ > 0) {
      Scalar share{};
      split_cells(scale_.fraction(clamp(x, low_, high_), low_), cells_, place.at, share);
      const Scalar whole_value = factor(s);
      place.share = Traits::part(whole_value, Traits::share_of(share));
      place.rest = whole_value - place.share;  // together the factor to the last place: the law's reach is held to that
      place.at += s.forward ? 0 : kKnots;
    }
    return place;
  }

  SamplePeriod<Scalar> dt_;
  TableSignal signal_;
  std::int32_t cells_;
  TableFactor factor_;
  Scalar low_;
  Scalar high_;
  CellScale<Scalar> scale_{};
  std::int32_t since_ = 0;  ///< samples since the direction changed
  bool forward_ = true;
};

}  // namespace capstan
