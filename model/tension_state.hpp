// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

#include "capstan/model/exponential.hpp"
#include "capstan/model/force_estimate.hpp"
#include "capstan/model/reciprocal.hpp"

namespace capstan {

/// Two tendons with capstan friction between motor and joint, in numbers of the motor side: what
/// `capstan identify --model pull_push` finds, tip locked once, holds for a free tip too.
template <typename Scalar>
struct TensionStateParameters {
  Scalar eta_top{};                               ///< friction-bending numbers, 1, 0 to 3
  Scalar eta_bottom{};                            ///< the same of the bottom tendon
  Scalar pretension_nm{};                         ///< I r1, N m, 0 to 8
  Scalar compliance_top{};                        ///< 1 / (r1^2 Kn), rad/(N m), above 0 to 6
  Scalar compliance_bottom{};                     ///< the same of the bottom tendon
  Scalar beta = ScalarTraits<Scalar>::from(1.0);  ///< r1 / r2, 1, 0.25 to 2
  Scalar joint_offset{};                          ///< q2 at q1 = 0 and no torque, rad, -3.2 to 3.2
  Scalar friction_nm{};  ///< the motor's own Coulomb friction, in the measured torque, N m, 0 to 1
};

enum class TensionStateFault : std::uint8_t { kNone, kEta, kPretension, kCompliance, kBeta, kOffset, kFriction };

/// Cause and cure in one sentence.
constexpr auto describe(TensionStateFault fault) -> const char* {
  switch (fault) {
    case TensionStateFault::kNone:
      return "the parameters are in range";
    case TensionStateFault::kEta:
      return "eta_top and eta_bottom must be from 0 to 3; identify them anew with the tip locked";
    case TensionStateFault::kPretension:
      return "pretension_nm, the tendon integral times the input radius, must be from 0 to 8 N m";
    case TensionStateFault::kCompliance:
      return "compliance_top and compliance_bottom must be above 0 and at most 6 rad/(N m); they are one over "
             "stiffness";
    case TensionStateFault::kBeta:
      return "beta, input radius over output radius, must be from 0.25 to 2";
    case TensionStateFault::kOffset:
      return "joint_offset must be from -3.2 to 3.2 rad";
    case TensionStateFault::kFriction:
      return "friction_nm must be from 0 to 1 N m";
  }
  return "";
}

/// The first parameter that is not a number or out of its range.
template <typename Scalar>
constexpr auto check(const TensionStateParameters<Scalar>& p) -> TensionStateFault {
  const auto within = [](Scalar x, double low, double high) {
    return ScalarTraits<Scalar>::from(low) <= x && x <= ScalarTraits<Scalar>::from(high);
  };
  if (!within(p.eta_top, 0.0, 3.0) || !within(p.eta_bottom, 0.0, 3.0)) {
    return TensionStateFault::kEta;
  }
  if (!within(p.pretension_nm, 0.0, 8.0)) {
    return TensionStateFault::kPretension;
  }
  if (!within(p.compliance_top, 1e-4, 6.0) || !within(p.compliance_bottom, 1e-4, 6.0)) {
    return TensionStateFault::kCompliance;
  }
  if (!within(p.beta, 0.25, 2.0)) {
    return TensionStateFault::kBeta;
  }
  if (!within(p.joint_offset, -3.2, 3.2)) {
    return TensionStateFault::kOffset;
  }
  return within(p.friction_nm, 0.0, 1.0) ? TensionStateFault::kNone : TensionStateFault::kFriction;
}

/// The tension along one tendon at `Nodes` places, ends included, in torque at the motor (tension times r1). A place
/// keeps its tension as long as the input end's stays within the factor that friction holds there: that is the moving
/// slip front, (2.6) and (2.7), exact at the places. Between them tension goes by e^(-eta phi) one way or the other,
/// and the sum below is exact for both.
template <typename Scalar, std::size_t Nodes>
class FrictionChain {
  static_assert(Nodes >= 2);

 public:
  struct Sum {
    Scalar integral{};  ///< of the tension over phi
    Scalar slope{};     ///< d integral / d input tension
  };

  constexpr FrictionChain() = default;
  constexpr FrictionChain(Scalar eta, Scalar tension) {
    constexpr Scalar kOne = ScalarTraits<Scalar>::from(1.0);
    constexpr Scalar kLength = ScalarTraits<Scalar>::from(1.0 / static_cast<double>(Nodes - 1));
    const Scalar step = eta * kLength;
    const auto decay = [&](Scalar x) { return kOne - kOne * share_gone(x, kOne); };
    // h tanh(eta h / 2) / (eta h / 2): the cell's share of the integral, per mean of its ends; halved, as the sums
    // below count every place but the ends twice.
    weight_ = kLength * mean_decay(step) / (kOne + decay(step));
    for (std::size_t i = 0; i < Nodes; ++i) {
      const Scalar low = decay(eta * kPlaces[i]);
      const Scalar high = kOne / low;
      places_[i] = {low, high, tension, tension * low, tension * high};
    }
  }

  /// What the integral would be with another tension at the input end; changes nothing.
  [[nodiscard]] constexpr auto trial(Scalar input) const -> Sum {
    // Held tensions, and how many input tensions the places have that move.
    Scalar held{};
    Scalar slope{};
    const auto add = [&](const Place& place) __attribute__((always_inline)) {
      if (place.up < input) {
        slope += place.low;
      } else if (input < place.down) {
        slope += place.high;
      } else {
        held += place.tension;
      }
    };
    for (std::size_t i = 1; i + 1 < Nodes; ++i) {
      add(places_[i]);
    }
    held += held;
    slope += slope + ScalarTraits<Scalar>::from(1.0);
    add(places_[Nodes - 1]);
    return {(held + input * slope) * weight_, slope * weight_};
  }

  /// Takes the input end to a tension. Returns whether every place has moved.
  constexpr auto pull_to(Scalar input) -> bool {
    bool all = true;
    for (std::size_t i = 1; i < Nodes; ++i) {
      Place& place = places_[i];
      if (place.up < input) {
        place.tension = input * place.low;
        place.up = input;
        place.down = place.tension * place.low;
      } else if (input < place.down) {
        place.tension = input * place.high;
        place.down = input;
        place.up = place.tension * place.high;
      } else {
        all = false;
      }
    }
    places_[0].tension = input;
    return all;
  }

  /// The tendon slides, or is about to, in its whole length: the output end's tension hangs on the input end's.
  [[nodiscard]] constexpr auto is_active() const -> bool {
    return places_[Nodes - 1].up <= input() || input() <= places_[Nodes - 1].down;
  }

  [[nodiscard]] constexpr auto input() const -> Scalar { return places_[0].tension; }
  [[nodiscard]] constexpr auto output() const -> Scalar { return places_[Nodes - 1].tension; }

 private:
  struct Place {
    Scalar low{};  ///< tension per input tension while friction holds all it can against a pull
    Scalar high{};
    Scalar tension{};
    Scalar down{};  ///< it keeps its tension as long as the input's is within these
    Scalar up{};
  };
  /// phi of each place.
  static constexpr std::array<Scalar, Nodes> kPlaces = [] {
    std::array<Scalar, Nodes> places{};
    for (std::size_t i = 0; i < Nodes; ++i) {
      places[i] = ScalarTraits<Scalar>::from(static_cast<double>(i) / static_cast<double>(Nodes - 1));
    }
    return places;
  }();

  std::array<Place, Nodes> places_{};
  Scalar weight_{};
};

template <typename Scalar>
struct TensionStateEstimate {
  Scalar q2{};            ///< joint angle, rad
  Scalar joint_torque{};  ///< what the tendons give to the joint, N m
  ForcePhase phase = ForcePhase::kUnknown;
  bool known = false;      ///< both tendons have moved in their whole length, so the start no longer matters
  bool usable = true;      ///< false: `check` refuses the parameters, and nothing is estimated
  bool saturated = false;  ///< a number met the end of its range
};

/// Joint angle and joint torque together, from motor angle and torque alone, whatever the tip touches (thesis 8.2.1).
/// The state is the tension along both tendons. Motor torque gives the difference of their input tensions (2.11), and
/// as both hang between the same two pulleys their elongations add up to a constant (2.16); the two together say how
/// far each slip front goes. Then the output ends give the joint's torque, and the elongation its angle (5.18). Nothing
/// is assumed about the environment but that it does not drive the motor back through the tendons' friction.
/// Bounded: at most kMaxRounds passes over the places of both tendons.
template <typename Scalar, std::size_t Nodes = 8>
class TensionState {
 public:
  /// Starts evenly tensioned. Parameters that `check` refuses make every estimate `usable = false`.
  constexpr explicit TensionState(const TensionStateParameters<Scalar>& parameters)
      : usable_(check(parameters) == TensionStateFault::kNone), parameters_(parameters) {
    if (!usable_) {
      return;
    }
    // Equally long at rest: c_t T_t = c_b T_b, and the two add up to I.
    const Scalar both = parameters.compliance_top + parameters.compliance_bottom;
    top_ = Chain(parameters.eta_top, parameters.pretension_nm * (parameters.compliance_bottom / both));
    bottom_ = Chain(parameters.eta_bottom, parameters.pretension_nm * (parameters.compliance_top / both));
    at_rest_ = parameters.compliance_top * top_.input();
    ratio_ = ScalarTraits<Scalar>::from(1.0) / parameters.beta;
  }

  /// @param q1  motor angle, rad   @param tau  motor-side torque, N m   @param forward  J of (5.20)
  constexpr auto update(Scalar q1, Scalar tau, bool forward) -> TensionStateEstimate<Scalar> {
    TensionStateEstimate<Scalar> estimate;
    if (!usable_) {
      estimate.usable = false;
      return estimate;
    }
    const Scalar x = tau - (forward ? parameters_.friction_nm : -parameters_.friction_nm);
    const Balance now = solve(x);
    was_slack_ = now.one_slack;
    top_known_ = top_.pull_to(now.top_in) || top_known_;
    bottom_known_ = bottom_.pull_to(now.top_in - x) || bottom_known_;
    estimate.known = top_known_ && bottom_known_;
    estimate.phase = phase_of(now.one_slack, top_.is_active(), bottom_.is_active());
    estimate.joint_torque = ratio_ * (top_.output() - bottom_.output());
    // The joint hangs on whichever tendon is taut.
    const bool on_top = !now.one_slack || Scalar{} < x;
    const Scalar stretch = on_top ? parameters_.compliance_top * now.top_integral - at_rest_
                                  : at_rest_ - parameters_.compliance_bottom * now.bottom_integral;
    const Scalar at_pulley = q1 - stretch;
    estimate.q2 = parameters_.beta * at_pulley + parameters_.joint_offset;
    using Traits = ScalarTraits<Scalar>;
    estimate.saturated = Traits::is_saturated(tau) || Traits::is_saturated(q1) || Traits::is_saturated(stretch) ||
                         Traits::is_saturated(at_pulley) || Traits::is_saturated(estimate.q2) ||
                         Traits::is_saturated(estimate.joint_torque);
    return estimate;
  }

  /// Tensions times r1, N m.
  [[nodiscard]] constexpr auto top() const -> const FrictionChain<Scalar, Nodes>& { return top_; }
  [[nodiscard]] constexpr auto bottom() const -> const FrictionChain<Scalar, Nodes>& { return bottom_; }

 private:
  using Chain = FrictionChain<Scalar, Nodes>;
  /// Two are usual at 1 kHz; after a jump of torque Newton and the halvings behind it get to a thousandth.
  static constexpr int kMaxRounds = 12;
  /// The elongation, rad, to which the two tendons must add up to what they have at rest.
  static constexpr Scalar kTolerance = ScalarTraits<Scalar>::from(4e-6);

  struct Balance {
    Scalar top_in{};
    Scalar top_integral{};
    Scalar bottom_integral{};
    Scalar error{};  ///< how much the elongations of both exceed those at rest, rad
    Scalar slope{};  ///< of the error by the top tendon's input tension
    bool one_slack = false;
  };

  /// The top tendon's input tension: where the elongations add up, or where one tendon is just slack. The error rises
  /// with it everywhere, so Newton is kept inside a bracket and halves where it would leave it.
  [[nodiscard]] constexpr auto solve(Scalar x) const -> Balance {
    constexpr Scalar kHalf = ScalarTraits<Scalar>::from(0.5);
    const Scalar slack = x > Scalar{} ? x : Scalar{};  // here one tendon has nothing left
    Scalar low = slack;
    Scalar high = slack + parameters_.pretension_nm * kLargestShare;
    Balance now = balance(was_slack_ ? slack : clamp(top_.input(), low, high), x);
    for (int round = 1; round < kMaxRounds; ++round) {
      now.one_slack = now.top_in == slack && !(now.error < Scalar{});
      if (now.one_slack || abs(now.error) <= kTolerance) {
        return now;
      }
      (now.error < Scalar{} ? low : high) = now.top_in;
      const Scalar newton = now.top_in - rough_quotient(now.error, now.slope);  // the next round sees what is left
      const bool try_slack = !(low < newton) && low == slack && now.top_in != slack;
      const Scalar halfway = low + (high - low) * kHalf;
      now = balance(try_slack ? slack : (low < newton && newton < high ? newton : halfway), x);
    }
    return now;
  }

  [[nodiscard]] constexpr auto balance(Scalar top_in, Scalar x) const -> Balance {
    const auto top = top_.trial(top_in);
    const auto bottom = bottom_.trial(top_in - x);
    return {top_in,
            top.integral,
            bottom.integral,
            parameters_.compliance_top * top.integral - at_rest_ +
                (parameters_.compliance_bottom * bottom.integral - at_rest_),
            parameters_.compliance_top * top.slope + parameters_.compliance_bottom * bottom.slope,
            false};
  }

  static constexpr auto phase_of(bool one_slack, bool top_active, bool bottom_active) -> ForcePhase {
    if (one_slack) {
      return ForcePhase::kOneSlack;
    }
    if (top_active && bottom_active) {
      return ForcePhase::kBothActive;
    }
    return top_active || bottom_active ? ForcePhase::kPulledActive : ForcePhase::kHeld;
  }

  /// No tendon's input tension exceeds I over the least mean of its decay, eta / (1 - e^-eta) = 3.16 at eta = 3, but
  /// for what the torque adds.
  static constexpr Scalar kLargestShare = ScalarTraits<Scalar>::from(7.0);

  bool usable_;
  TensionStateParameters<Scalar> parameters_;
  Chain top_{};
  Chain bottom_{};
  Scalar at_rest_{};  ///< elongation of either tendon at rest, as an angle of the motor, rad
  Scalar ratio_{};
  bool was_slack_ = false;
  bool top_known_ = false;
  bool bottom_known_ = false;
};

}  // namespace capstan
