// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/model/reciprocal.hpp"
#include "capstan/model/term.hpp"

namespace capstan {

/// A ratio that changes along the way, as pulleys that are not round, sheaths that bend and linkages have it: beside
/// beta h
///   c2 phi2(u) + c3 phi3(u),   u = (h - centre) / span,   phi_n(u) = u^n for |u| <= 1
/// and beyond them the tangents there, so that the curve goes on as it was last seen. With centre and span those of the
/// motion seen, both coefficients are angles no larger than the joint's way, however many turns the motor makes.
template <typename Scalar>
class CurvedRatio {
 public:
  static constexpr double kMostSpanRad = 125.0;

  static constexpr TermInfo<2, 2> kInfo = {
      .name = "curved_ratio",
      .equation = "c2 u^2 + c3 u^3, u = (h - centre) / span, straight on beyond |u| = 1",
      .source = "next orders of (1.22) in the motor angle",
      .confusable_with =
          "gravity, angle_periodic of a low order, stiffness_hardening where the torque follows the angle",
      .exciting_motion = "slowly over all the joint's range, with and without load",
      .coefficients = {{{"square", "rad", Sign::kAny, "joint angle at one end of the span by the square, c2"},
                        {"cube", "rad", Sign::kAny, "the same by the cube, c3"}}},
      .shapes = {{{"centre", "rad", -kMostSpanRad, kMostSpanRad, 0.0, "motor angle at the middle of the curve",
                   ShapeScale::kPeriods, ShapeOf::kGiven},
                  {"span", "rad", 1e-4, kMostSpanRad, 1.0, "motor angle from the middle to either end",
                   ShapeScale::kRatio, ShapeOf::kGiven}}},
      .relations = {.doubles = {"gravity", "angle_periodic", "stiffness_hardening"},
                    .shown_by = Motion::kTurns | Motion::kSpeeds,
                    .placed = true},
  };

  static constexpr SteadyState kSteadyState = SteadyState::kEitherWay;
  static constexpr bool kReadsInput = true;

  constexpr CurvedRatio(SamplePeriod<Scalar> /*dt*/, const std::array<Scalar, 2>& shape)
      : centre_(shape[0]), per_span_(kLeast < shape[1] ? shape[1] : kLeast) {}
  constexpr auto update(const Sample<Scalar>& s) -> std::array<Scalar, 2> { return steady_state(s); }
  [[nodiscard]] constexpr auto steady_state(const Sample<Scalar>& s) const -> std::array<Scalar, 2> { return at(s.h); }

  /// phi2 and phi3 at h.
  [[nodiscard]] constexpr auto at(Scalar h) const -> std::array<Scalar, 2> {
    const Scalar distance = h - centre_;
    if (Traits::is_saturated(distance)) [[unlikely]] {
      return {distance, distance};  // so that the law says it
    }
    const Scalar u = distance * per_span_;
    if (abs(u) <= kOne) [[likely]] {
      const Scalar square = Traits::part(u, Traits::share_of(u));
      return {square, Traits::part(square, Traits::share_of(u))};
    }
    const Scalar end = u < Scalar{} ? -kOne : kOne;
    const Scalar beyond = clamp(u, -kFarthest, kFarthest) - end;
    const Scalar twice = u < Scalar{} ? -(beyond + beyond) : beyond + beyond;
    return {kOne + twice, end + beyond + beyond + beyond};
  }

 private:
  using Traits = ScalarTraits<Scalar>;
  static constexpr Scalar kOne = Traits::from(1.0);
  static constexpr Scalar kLeast = Traits::from(1e-4);
  static constexpr Scalar kFarthest = Traits::from(40.0);  ///< phi3 is 118 there; the range ends at 128

  Scalar centre_;
  Reciprocal<Scalar> per_span_;
};

/// beta h + c2 phi2 + c3 phi3 = y, turned round. Everything is counted in spans, so that the three coefficients are of
/// the size of beta: outside the span the curve is straight, inside it is a cubic that rises, where a few of Newton's
/// steps from where the motor was end within the last place; a step that leaves what is known halves it instead. @pre
/// `follows_everywhere`; if not, the result is bounded.
template <typename Scalar>
class CurveInverse {
 public:
  static constexpr int kSteps = 4;

  constexpr CurveInverse() = default;
  /// @param shape  centre and span
  constexpr CurveInverse(Scalar beta, Scalar c2, Scalar c3, const std::array<Scalar, 2>& shape)
      : crossed_(beta < Scalar{}),
        centre_(shape[0]),
        span_(kLeast < shape[1] ? shape[1] : kLeast),
        per_span_(span_),
        base_(beta * centre_),
        first_(abs(beta)),
        second_(signed_as(c2) * per_span_),
        third_(signed_as(c3) * per_span_),
        least_(Traits::template shifted_down<5>(first_)),
        high_(first_ + second_ + third_),
        low_(second_ - first_ - third_),
        per_high_(steep(slope(kOne))),
        per_low_(steep(slope(-kOne))) {}

  /// @param near  about where h will be
  [[nodiscard]] constexpr auto operator()(Scalar y, Scalar near) const -> Scalar {
    const Scalar wanted = signed_as(y - base_) * per_span_;
    if (high_ < wanted) {
      return centre_ + span_ + span_ * ((wanted - high_) * per_high_);
    }
    if (wanted < low_) {
      return centre_ - span_ - span_ * ((low_ - wanted) * per_low_);
    }
    Scalar u = clamp((near - centre_) * per_span_, -kOne, kOne);
    Scalar least = -kOne - kOne;  // where the curve was seen below and above what is wanted
    Scalar most = kOne + kOne;
    for (int step = 0; step < kSteps; ++step) {
      const auto share = Traits::share_of(u);
      const Scalar left =
          wanted - Traits::part(first_ + Traits::part(second_ + Traits::part(third_, share), share), share);
      if (abs(left) <= kNothing) {
        break;
      }
      (left < Scalar{} ? most : least) = u;
      const Scalar next = clamp(u + rough_quotient(left, steep(slope(u))), -kOne, kOne);
      // Where the curve is flat at both ends, Newton's steps would go to and fro between them for ever.
      const bool known = next != u && (next <= least || most <= next);
      u = known ? Traits::template shifted_down<1>(least + most) : next;
    }
    return centre_ + span_ * u;
  }

 private:
  using Traits = ScalarTraits<Scalar>;
  static constexpr Scalar kOne = Traits::from(1.0);
  static constexpr Scalar kLeast = Traits::from(1e-4);
  static constexpr Scalar kNothing = Traits::from(0x1p-23);

  [[nodiscard]] constexpr auto signed_as(Scalar x) const -> Scalar { return crossed_ ? -x : x; }
  [[nodiscard]] constexpr auto slope(Scalar u) const -> Scalar {
    const auto share = Traits::share_of(u);
    const Scalar half = second_ + Traits::part(third_ + Traits::template shifted_down<1>(third_), share);
    return first_ + Traits::part(half + half, share);
  }
  /// Of what is no ratio the inverse is bounded all the same.
  [[nodiscard]] constexpr auto steep(Scalar slope) const -> Scalar { return slope < least_ ? least_ : slope; }

  bool crossed_ = false;
  Scalar centre_{};
  Scalar span_{};
  Reciprocal<Scalar> per_span_{};
  Scalar base_{};   ///< beta centre
  Scalar first_{};  ///< beta, and the curve's coefficients over the span, with the sign that makes beta positive
  Scalar second_{};
  Scalar third_{};
  Scalar least_{};
  Scalar high_{};  ///< the curve at the ends of the span, in spans, from the centre's beta h
  Scalar low_{};
  Reciprocal<Scalar> per_high_{};
  Reciprocal<Scalar> per_low_{};
};

/// Of a ratio that can be turned round the least slope anywhere is more than a twentieth of beta.
inline constexpr std::int64_t kStraightPerLeastSlope = 20;

/// Whether the least slope of beta h + c2 phi2 + c3 phi3 is that of such a ratio: then the joint follows its motor
/// everywhere. In closed form: the slope is a parabola in u between the ends, and stays outside. In units of 2^-16, so
/// that the square of a coefficient fits.
constexpr auto follows_everywhere(Q24 beta, Q24 c2, Q24 c3, Q24 span) -> bool {
  const bool crossed = beta < Q24{};
  const auto coarse = [crossed](Q24 x) { return (crossed ? -std::int64_t{x.raw()} : std::int64_t{x.raw()}) >> 8; };
  const std::int64_t straight = (coarse(beta) * (span.raw() >> 8)) >> 16;
  const std::int64_t linear = 2 * coarse(c2);
  const std::int64_t square = 3 * coarse(c3);
  std::int64_t least = straight + square - (linear < 0 ? -linear : linear);
  if (2 * square >
      (linear < 0 ? -linear : linear)) {  // the parabola opens upwards, its lowest point is between the ends
    least = straight - linear * linear / (4 * square);
  }
  return kStraightPerLeastSlope * least > straight;
}

}  // namespace capstan
