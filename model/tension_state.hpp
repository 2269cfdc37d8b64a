// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>

#include "capstan/model/force_estimate.hpp"
#include "capstan/model/tension_balance.hpp"

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
  using Traits = ScalarTraits<Scalar>;
  constexpr Scalar kEta = Traits::from(3.0);  // constants: the target converts no double at run time
  constexpr Scalar kPretension = Traits::from(8.0);
  constexpr Scalar kLeastCompliance = Traits::from(1e-4);
  constexpr Scalar kMostCompliance = Traits::from(6.0);
  constexpr Scalar kLeastBeta = Traits::from(0.25);
  constexpr Scalar kMostBeta = Traits::from(2.0);
  constexpr Scalar kOffset = Traits::from(3.2);
  constexpr Scalar kFriction = Traits::from(1.0);
  const auto within = [](Scalar x, Scalar low, Scalar high) { return low <= x && x <= high; };
  if (!within(p.eta_top, Scalar{}, kEta) || !within(p.eta_bottom, Scalar{}, kEta)) {
    return TensionStateFault::kEta;
  }
  if (!within(p.pretension_nm, Scalar{}, kPretension)) {
    return TensionStateFault::kPretension;
  }
  if (!within(p.compliance_top, kLeastCompliance, kMostCompliance) ||
      !within(p.compliance_bottom, kLeastCompliance, kMostCompliance)) {
    return TensionStateFault::kCompliance;
  }
  if (!within(p.beta, kLeastBeta, kMostBeta)) {
    return TensionStateFault::kBeta;
  }
  if (!within(p.joint_offset, -kOffset, kOffset)) {
    return TensionStateFault::kOffset;
  }
  return within(p.friction_nm, Scalar{}, kFriction) ? TensionStateFault::kNone : TensionStateFault::kFriction;
}

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
/// The state is the tension along both tendons, `TensionBalance`. Its output ends give the joint's torque, the
/// elongation its angle (5.18).
template <typename Scalar, std::size_t Nodes = 8>
class TensionState {
 public:
  /// Starts evenly tensioned. Parameters that `check` refuses make every estimate `usable = false`.
  constexpr explicit TensionState(const TensionStateParameters<Scalar>& p)
      : usable_(check(p) == TensionStateFault::kNone), parameters_(p) {
    if (!usable_) {
      return;
    }
    // In place: an assignment would have both on the stack.
    std::construct_at(&tendons_,
                      TensionBalanceParameters<Scalar>{p.eta_top, p.eta_bottom, p.pretension_nm, p.compliance_top,
                                                       p.compliance_bottom},
                      kTolerance);
    ratio_ = ScalarTraits<Scalar>::from(1.0) / p.beta;
  }

  /// @param q1  motor angle, rad   @param tau  motor-side torque, N m   @param forward  J of (5.20)
  constexpr auto update(Scalar q1, Scalar tau, bool forward) -> TensionStateEstimate<Scalar> {
    TensionStateEstimate<Scalar> estimate;
    if (!usable_) {
      estimate.usable = false;
      return estimate;
    }
    const Scalar stretch = tendons_.pull(tau - (forward ? parameters_.friction_nm : -parameters_.friction_nm));
    estimate.known = tendons_.is_known();
    estimate.phase = tendons_.phase();
    estimate.joint_torque = ratio_ * tendons_.output();
    const Scalar at_pulley = q1 - stretch;
    estimate.q2 = parameters_.beta * at_pulley + parameters_.joint_offset;
    using Traits = ScalarTraits<Scalar>;
    estimate.saturated = Traits::is_saturated(tau) || Traits::is_saturated(q1) || Traits::is_saturated(stretch) ||
                         Traits::is_saturated(at_pulley) || Traits::is_saturated(estimate.q2) ||
                         Traits::is_saturated(estimate.joint_torque);
    return estimate;
  }

  /// Tensions times r1, N m.
  [[nodiscard]] constexpr auto top() const -> const FrictionChain<Scalar, Nodes>& { return tendons_.top(); }
  [[nodiscard]] constexpr auto bottom() const -> const FrictionChain<Scalar, Nodes>& { return tendons_.bottom(); }

 private:
  /// The elongation, rad, to which the two tendons must add up to what they have at rest.
  static constexpr Scalar kTolerance = ScalarTraits<Scalar>::from(4e-6);

  bool usable_;
  TensionStateParameters<Scalar> parameters_;
  TensionBalance<Scalar, Nodes> tendons_{};
  Scalar ratio_{};
};

}  // namespace capstan
