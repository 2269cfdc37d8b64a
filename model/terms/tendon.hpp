// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/model/tension_balance.hpp"
#include "capstan/model/term.hpp"

namespace capstan {

/// Places of the tendons' shapes; laws of before the last one do without it.
struct TendonShape {
  enum Place : std::size_t {
    kEtaTop,
    kEtaBottom,
    kPretension,
    kTopShare,
    kFriction,
    kViscous,
    kInertia,
    kFreeShare,
    kCount
  };
};

/// Both tendons with the friction along them: the joint lags by how much longer than at rest the tendon is that it
/// hangs on, whatever the tip touches,
///   -C (s Int T_t dphi - s T_t0),  s = c_t / (c_t + c_b),  C = beta (c_t + c_b),
/// the tensions those of TensionBalance under the torque that the motor gives to its pulley,
///   x = tau - b q1' - m q1'' less the motor's friction, -f or f while it moves, and while it stands what keeps x where
///   it was, as far as f goes: the torque changes by 2 f at each reversal before anything moves.
/// That the tension hangs on the torque alone holds for a joint that stands. Once it goes with the motor, its tendons
/// move over their guides and friction acts against that motion everywhere, also while the torque falls: slide().
/// Torque, friction and the motor's way are as late as q1'' is (Sample::tau_late, course_late, advance_late), by both
/// filters' time constants, 5 T: friction along the tendons keeps what a peak did to the tension, and a peak that the
/// motor's mass took must not get there. What comes out has no memory any more and is brought ahead by as much,
/// s + 5 T s', with the rate s' through the filter of 4 T.
/// Weight, inertia and drag of the joint need no terms of their own: they are in that torque, and the tendon that
/// carries them is the one that stretches.
/// @tparam Nodes  places along each tendon
template <typename Scalar, std::size_t Nodes>
class TendonsOf {
 public:
  /// Of pretension and of torque: sums over the places of what either may bring stay in fixed point's range.
  static constexpr double kMostNm = 8.0;

  using Shape = TendonShape;
  static constexpr TermInfo<1, Shape::kCount> kInfo = {
      .name = "tendon",
      .equation = "C (s Int T_t dphi - rest): both tendons' tensions under tau - b q1' - m q1'' less friction +-f",
      .source = "(2.4)-(2.16), (5.18); thesis 8.2.1 and 8.2.2 name it as open",
      .confusable_with = "tendon_elongation with play where all strokes are long and alike",
      .exciting_motion = "loops within loops: reversals at many angles and torques",
      .coefficients = {{{"compliance", "rad/Nm", Sign::kAny, "-beta (c_t + c_b): joint angle per torque, both tendons",
                         Sign::kNonPositive, "the torque is counted against the motor's direction"}}},
      .shapes =
          {{{"eta_top", "1", 0.0, 3.0, 0.5, "friction-bending number mu L / R of the top tendon", ShapeScale::kPeriods},
            {"eta_bottom", "1", 0.0, 3.0, 0.5, "the same of the bottom tendon", ShapeScale::kPeriods},
            {"pretension", "Nm", 1e-4, kMostNm, 0.05,
             "I r1: both tendons' mean tensions together, times the motor pulley's radius", ShapeScale::kRatio},
            {"top_share", "1", 0.1, 0.9, 0.5, "c_t / (c_t + c_b): how the compliance divides", ShapeScale::kPeriods},
            {"friction", "Nm", 0.0, kMostNm, 0.0, "Coulomb friction ahead of the tendons, within tau",
             ShapeScale::kPeriods},
            {"viscous", "Nms/rad", 0.0, 8.0, 0.0, "viscous friction ahead of the tendons, within tau",
             ShapeScale::kPeriods},
            {"inertia", "gm2", 0.0, 100.0, 0.0, "the motor's inertia, its torque within tau", ShapeScale::kPeriods},
            {"free_share", "1", 0.0, 0.5, 0.0, "share of the length at each tendon's ends that touches nothing",
             ShapeScale::kPeriods, ShapeOf::kNothing, static_cast<std::int8_t>(Shape::kFreeShare)}}},
      .relations = {.doubles = {"tendon_elongation", "play", "presliding"},
                    .special_cases = {"tendon_elongation", "pretension_offset", "slip_propagation"},
                    .shown_by = Motion::kLoops,
                    .open_shapes = true,
                    .placed = true},
  };

  constexpr TendonsOf(SamplePeriod<Scalar> /*dt*/, const std::array<Scalar, Shape::kCount>& shape)
      : friction_(shape[Shape::kFriction]),
        viscous_(shape[Shape::kViscous]),
        inertia_(shape[Shape::kInertia]),
        tendons_(parameters_of(shape), clamp(shape[Shape::kPretension], Scalar{}, kMost) * kTolerance) {}
  constexpr void restart() {
    tendons_.restart();
    torque_ = smooth_ = most_torque_ = way_ = {};
    goes_forward_ = true;
  }

  constexpr auto update(const Sample<Scalar>& s) -> std::array<Scalar, 1> {
    const Scalar given = given_torque(s, s.tau_late);
    const Scalar friction = friction_ * s.course_late;
    torque_ = clamp(torque_, s.advance < Scalar{} ? given - friction : given - friction_,
                    Scalar{} < s.advance ? given - friction : given + friction_);
    if (kMost < abs(torque_) || !slide(s)) [[unlikely]] {
      return {kOutOfRange};
    }
    return {brought_ahead(tendons_.pull(torque_), s.late_gain)};
  }
  [[nodiscard]] constexpr auto steady_state(const Sample<Scalar>& s) const -> std::array<Scalar, 1> {
    const Scalar given = given_torque(s, s.tau);
    return {tendons_.steady_state(clamp(s.forward ? given - friction_ : given + friction_, -kMost, kMost), s.forward)};
  }

  [[nodiscard]] constexpr auto tendons() const -> const TensionBalance<Scalar, Nodes>& { return tendons_; }

 private:
  static constexpr Scalar kMost = ScalarTraits<Scalar>::from(kMostNm);
  /// In fixed point the law sees that it is no number of its range; in double no joint has such a torque.
  static constexpr Scalar kOutOfRange = ScalarTraits<Scalar>::from(1e3);
  /// Of the sum of both elongations, per pretension: the loop at rest is about as wide as that.
  static constexpr Scalar kTolerance = ScalarTraits<Scalar>::from(5e-5);

  /// Direction thresholds that the motor goes on before the tendons slide, and that they slide by then: short enough
  /// for a drag that changes with the speed, long enough for the torque's noise. Half or twice either changes nothing
  /// by more than a tenth of a camera's noise (thresholds of 0.12 to 1 mrad).
  static constexpr double kBefore = 8.0;
  static constexpr double kSlidesBy = 32.0;
  /// They slide in steps of an eighth: a step at every cycle would cost more than all the rest.
  static constexpr double kStep = 4.0;

  /// Shapes that are out of their range count as the nearest that is in it.
  static constexpr auto parameters_of(const std::array<Scalar, Shape::kCount>& shape)
      -> TensionBalanceParameters<Scalar> {
    const auto within = [](Scalar x, double low, double high) {
      return clamp(x, ScalarTraits<Scalar>::from(low), ScalarTraits<Scalar>::from(high));
    };
    const Scalar top = within(shape[Shape::kTopShare], 0.1, 0.9);
    return {within(shape[Shape::kEtaTop], 0.0, 3.0),
            within(shape[Shape::kEtaBottom], 0.0, 3.0),
            clamp(shape[Shape::kPretension], Scalar{}, kMost),
            top,
            ScalarTraits<Scalar>::from(1.0) - top,
            within(shape[Shape::kFreeShare], 0.0, 0.5)};
  }
  /// While the joint stands, a motor that goes on needs ever more torque: until then the tendons only stretch. A motor
  /// that goes on without takes the joint with it, and with the joint all of the tendons over their guides.
  /// @return false if a tension met the end of its range
  constexpr auto slide(const Sample<Scalar>& s) -> bool {
    if (s.advance_late == Scalar{}) {
      return true;
    }
    const bool forward = Scalar{} < s.advance_late;
    if (forward != goes_forward_ || (forward ? most_torque_ < torque_ : torque_ < most_torque_)) {
      goes_forward_ = forward;
      most_torque_ = torque_;
      way_ = {};
      return true;
    }
    way_ += abs(s.advance_late);
    if (way_ < s.direction_threshold * ScalarTraits<Scalar>::from(kBefore + kStep)) {
      return true;
    }
    const Scalar before = s.direction_threshold * ScalarTraits<Scalar>::from(kBefore);
    const Scalar step = way_ - before;
    const Scalar whole = s.direction_threshold * ScalarTraits<Scalar>::from(kSlidesBy);
    way_ = before;
    return tendons_.slide(
        forward, ScalarTraits<Scalar>::share_of(step < whole ? rough_quotient(step, whole) : Sample<Scalar>::kWhole));
  }
  /// s + 5 T s' of a stretch that is late by 5 T: s less itself through a filter of 4 T is 4 T s'.
  constexpr auto brought_ahead(Scalar stretch, typename ScalarTraits<Scalar>::Gain gain) -> Scalar {
    if (gain == typename ScalarTraits<Scalar>::Gain{}) {
      return stretch;
    }
    smooth_ = ScalarTraits<Scalar>::between(smooth_, stretch, gain);
    const Scalar way = stretch - smooth_;
    return stretch + way + ScalarTraits<Scalar>::template shifted_down<2>(way);
  }
  /// What the motor gives but for its Coulomb friction.
  [[nodiscard]] constexpr auto given_torque(const Sample<Scalar>& s, Scalar tau) const -> Scalar {
    return tau - viscous_ * s.dq1 - inertia_ * s.ddq1;
  }

  Scalar friction_;
  Scalar viscous_;
  Scalar inertia_;
  TensionBalance<Scalar, Nodes> tendons_;
  Scalar torque_{};           ///< x
  Scalar most_torque_{};      ///< since the motor turned
  Scalar way_{};              ///< of the motor since then, rad
  bool goes_forward_ = true;  ///< as late as the torque
  Scalar smooth_{};           ///< the stretch through a filter
};

/// On the board. A front between two places is not seen, so friction and pretension have to be looked for with more of
/// them; with those of 32 places these 8 err by a tenth more of the joint camera's noise than 32 do (simulated
/// forceps).
template <typename Scalar>
using Tendons = TendonsOf<Scalar, 8>;

}  // namespace capstan
