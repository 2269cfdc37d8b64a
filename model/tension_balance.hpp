// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "capstan/model/force_estimate.hpp"
#include "capstan/model/friction_chain.hpp"
#include "capstan/model/reciprocal.hpp"

namespace capstan {

/// Two tendons with capstan friction that hang between the same two pulleys. Torques at the motor; compliances in any
/// unit, as only their ratio decides how the tensions divide, and the stretch comes out in that unit times N m.
template <typename Scalar>
struct TensionBalanceParameters {
  Scalar eta_top{};            ///< friction-bending numbers, 1, 0 to 3
  Scalar eta_bottom{};         ///< the same of the bottom tendon
  Scalar pretension_nm{};      ///< I r1, N m
  Scalar compliance_top{};     ///< above 0
  Scalar compliance_bottom{};  ///< above 0
  Scalar free_share{};         ///< of the length at each tendon's two ends together that touches nothing, 1, 0 to 0.5
};

/// The tension along both tendons under a torque of the motor (thesis 8.2.1). The torque gives the difference of their
/// input tensions (2.11), and as both hang between the same two pulleys their elongations add up to a constant (2.16);
/// the two together say how far each slip front goes. Nothing is assumed about what the joint touches but that it does
/// not drive the motor back through the tendons' friction.
/// Bounded: at most kMaxRounds passes over the places of both tendons.
template <typename Scalar, std::size_t Nodes>
class TensionBalance {
 public:
  using Chain = FrictionChain<Scalar, Nodes>;

  constexpr TensionBalance() = default;
  /// Starts evenly tensioned. @param tolerance  of the sum of both elongations, in the compliances' unit times N m
  constexpr TensionBalance(const TensionBalanceParameters<Scalar>& p, Scalar tolerance)
      : tolerance_(tolerance), pretension_(p.pretension_nm) {
    // Equally long at rest: c_t T_t = c_b T_b, and the two add up to I.
    const Scalar both = p.compliance_top + p.compliance_bottom;
    start_top_ = p.pretension_nm * (p.compliance_bottom / both);
    start_bottom_ = p.pretension_nm * (p.compliance_top / both);
    top_ = Chain(p.eta_top, start_top_, p.compliance_top, p.free_share);
    bottom_ = Chain(p.eta_bottom, start_bottom_, p.compliance_bottom, p.free_share);
    at_rest_ = p.compliance_top * start_top_;
    forward_ = sliding(top_.pulled(), bottom_.pushed());
    backward_ = sliding(top_.pushed(), bottom_.pulled());
  }
  /// As newly made, without the divisions that making takes.
  constexpr void restart() {
    top_.even_out(start_top_);
    bottom_.even_out(start_bottom_);
    top_known_ = bottom_known_ = was_slack_ = false;
  }

  /// Lets the motor give a torque at its pulley, N m. Returns how much longer than at rest the tendon is that the joint
  /// hangs on; the joint lags the motor by that.
  constexpr auto pull(Scalar torque) -> Scalar {
    const Balance now = solve(torque);
    was_slack_ = now.one_slack;
    top_known_ = top_.pull_to(now.top_in) || top_known_;
    bottom_known_ = bottom_.pull_to(now.top_in - torque) || bottom_known_;
    const bool on_top = !now.one_slack || Scalar{} < torque;
    return on_top ? now.top - at_rest_ : at_rest_ - now.bottom;
  }

  /// Both tendons move over their guides, by a share of what it takes them to slide everywhere.
  /// @return false if a tension met the end of its range
  constexpr auto slide(bool forward, typename ScalarTraits<Scalar>::Gain share) -> bool {
    const bool top_fits = top_.slide(forward, share);
    return bottom_.slide(!forward, share) && top_fits;
  }

  /// The stretch that `pull` comes to when both tendons slide in their whole length: (5.35) with its Lambda, and a
  /// tendon that goes slack.
  [[nodiscard]] constexpr auto steady_state(Scalar torque, bool forward) const -> Scalar {
    const Sliding& s = forward ? forward_ : backward_;
    const Scalar slack = torque > Scalar{} ? torque : Scalar{};
    const Scalar taut = s.top_at_none + s.top_per_torque * torque;
    if (!(taut < slack)) {
      return s.stretch_of_top * taut - at_rest_;
    }
    return torque > Scalar{} ? s.stretch_of_top * torque - at_rest_ : at_rest_ + s.stretch_of_bottom * torque;
  }

  /// Tensions times r1, N m.
  [[nodiscard]] constexpr auto top() const -> const Chain& { return top_; }
  [[nodiscard]] constexpr auto bottom() const -> const Chain& { return bottom_; }
  /// Both tendons have moved in their whole length since the start, which no longer matters then.
  [[nodiscard]] constexpr auto is_known() const -> bool { return top_known_ && bottom_known_; }
  [[nodiscard]] constexpr auto phase() const -> ForcePhase {
    if (was_slack_) {
      return ForcePhase::kOneSlack;
    }
    if (top_.is_active() && bottom_.is_active()) {
      return ForcePhase::kBothActive;
    }
    return top_.is_active() || bottom_.is_active() ? ForcePhase::kPulledActive : ForcePhase::kHeld;
  }
  /// Torque of both output ends about the motor's pulley, N m.
  [[nodiscard]] constexpr auto output() const -> Scalar { return top_.output() - bottom_.output(); }

 private:
  /// Two are usual at 1 kHz; after a jump of torque Newton and the halvings behind it get to a thousandth.
  static constexpr int kMaxRounds = 12;

  struct Balance {
    Scalar top_in{};
    Scalar top{};  ///< elongations
    Scalar bottom{};
    Scalar error{};  ///< how much the elongations of both exceed those at rest
    Scalar slope{};  ///< of the error by the top tendon's input tension
    bool one_slack = false;
  };
  /// Both tendons sliding one way, as straight lines in the torque.
  struct Sliding {
    Scalar top_at_none{};     ///< the top tendon's input tension at no torque
    Scalar top_per_torque{};  ///< and its change by the torque
    Scalar stretch_of_top{};  ///< elongation per input tension
    Scalar stretch_of_bottom{};
  };

  /// @param top  elongation of the top tendon per tension of its input end; `bottom` the bottom one's
  [[nodiscard]] constexpr auto sliding(Scalar top, Scalar bottom) const -> Sliding {
    const Scalar both = top + bottom;
    return {(at_rest_ + at_rest_) / both, bottom / both, top, bottom};
  }

  /// The top tendon's input tension: where the elongations add up, or where one tendon is just slack. The error rises
  /// with it everywhere, so Newton is kept inside a bracket and halves where it would leave it.
  [[nodiscard]] constexpr auto solve(Scalar x) const -> Balance {
    constexpr Scalar kHalf = ScalarTraits<Scalar>::from(0.5);
    const Scalar slack = x > Scalar{} ? x : Scalar{};  // here one tendon has nothing left
    Scalar low = slack;
    Scalar high = slack + pretension_ * kLargestShare;
    Balance now = balance(was_slack_ ? slack : clamp(top_.input(), low, high), x);
    for (int round = 1; round < kMaxRounds; ++round) {
      now.one_slack = now.top_in == slack && !(now.error < Scalar{});
      if (now.one_slack || abs(now.error) <= tolerance_) {
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
            top.elongation,
            bottom.elongation,
            top.elongation - at_rest_ + (bottom.elongation - at_rest_),
            top.slope + bottom.slope,
            false};
  }

  /// No tendon's input tension exceeds I over the least mean of its decay, eta / (1 - e^-eta) = 3.16 at eta = 3, but
  /// for what the torque adds.
  static constexpr Scalar kLargestShare = ScalarTraits<Scalar>::from(7.0);

  Scalar tolerance_{};
  Scalar pretension_{};
  Scalar start_top_{};
  Scalar start_bottom_{};
  Scalar at_rest_{};  ///< elongation of either tendon at rest
  Chain top_{};
  Chain bottom_{};
  Sliding forward_{};
  Sliding backward_{};
  bool was_slack_ = false;
  bool top_known_ = false;
  bool bottom_known_ = false;
};

}  // namespace capstan
