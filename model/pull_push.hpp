// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>

#include "capstan/model/exponential.hpp"
#include "capstan/model/force_estimate.hpp"
#include "capstan/model/weighted_sum.hpp"

namespace capstan {

/// Two tendons with capstan friction, tip locked (thesis 2.3). One model serves both laws: without pretension it is the
/// pull model, with it the pull-push model; the answer is their weighted sum, (2.27).
template <typename Scalar>
struct PullPushParameters {
  Scalar eta_top{};                                           ///< friction-bending numbers, 1, 0 to 3
  Scalar eta_bottom{};                                        ///< the same of the bottom tendon
  Scalar pretension_nm{};                                     ///< I r1 with I of (2.16), N m, 0 to 8
  Scalar ratio = ScalarTraits<Scalar>::from(1.0);             ///< r2 / r1, 1, above 0 to 4
  Scalar pull_weight{};                                       ///< w1, 0 to 2
  Scalar pull_push_weight = ScalarTraits<Scalar>::from(1.0);  ///< w2, 0 to 2
};

enum class PullPushFault : std::uint8_t { kNone, kEtaTop, kEtaBottom, kPretension, kRatio, kWeights };

/// Cause and cure in one sentence.
constexpr auto describe(PullPushFault fault) -> const char* {
  switch (fault) {
    case PullPushFault::kNone:
      return "the parameters are in range";
    case PullPushFault::kEtaTop:
      return "eta_top must be from 0 to 3; identify it anew with the tip locked";
    case PullPushFault::kEtaBottom:
      return "eta_bottom must be from 0 to 3; identify it anew with the tip locked";
    case PullPushFault::kPretension:
      return "pretension_nm, the tendon integral times the input radius, must be from 0 to 8 N m";
    case PullPushFault::kRatio:
      return "ratio, output radius over input radius, must be above 0 and at most 4";
    case PullPushFault::kWeights:
      return "pull_weight and pull_push_weight must be from 0 to 2, and one of them above 0";
  }
  return "";
}

/// The first parameter that is not a number or out of its range.
template <typename Scalar>
constexpr auto check(const PullPushParameters<Scalar>& p) -> PullPushFault {
  using Traits = ScalarTraits<Scalar>;
  constexpr Scalar kEta = Traits::from(3.0);  // constants: the target converts no double at run time
  constexpr Scalar kPretension = Traits::from(8.0);
  constexpr Scalar kRatio = Traits::from(4.0);
  constexpr Scalar kWeight = Traits::from(2.0);
  const auto within = [](Scalar x, Scalar high) { return Scalar{} <= x && x <= high; };
  if (!within(p.eta_top, kEta)) {
    return PullPushFault::kEtaTop;
  }
  if (!within(p.eta_bottom, kEta)) {
    return PullPushFault::kEtaBottom;
  }
  if (!within(p.pretension_nm, kPretension)) {
    return PullPushFault::kPretension;
  }
  if (!within(p.ratio, kRatio) || p.ratio == Scalar{}) {
    return PullPushFault::kRatio;
  }
  const bool weights = within(p.pull_weight, kWeight) && within(p.pull_push_weight, kWeight);
  return weights && Scalar{} < p.pull_weight + p.pull_push_weight ? PullPushFault::kNone : PullPushFault::kWeights;
}

/// Output torque of one direction while both tendons move in their whole length, over the motor torque x, counted
/// positive where the motor pulls. With e = exp(-eta), p = (1 - e) / eta, u the pulled and d the pushed tendon, B the
/// pushed tendon's torque at the output, t the pulled one's at the input, I' = I r1:
///   t - B e_d = x (2.11),   p_u t + p_d B = I' (2.16, 2.20),   output = (r2 / r1) (e_u t - B) (2.19).
/// The pushed tendon is slack from x = I' / p_u on: output = (r2 / r1) e_u x, the pull model (2.17). Beyond
/// x = -I' e_d / p_d the pulled one is slack and the pushed one still pays out: output = (r2 / r1) x / e_d. The three
/// pieces meet, and the output never falls as x rises.
template <typename Scalar>
class TransmissionLine {
 public:
  struct Point {
    Scalar torque{};
    bool one_slack = false;
  };

  constexpr TransmissionLine() = default;
  constexpr TransmissionLine(Scalar eta_pulled, Scalar eta_pushed, Scalar pretension_nm, Scalar ratio) {
    constexpr Scalar kOne = ScalarTraits<Scalar>::from(1.0);
    const auto decay = [&](Scalar eta) { return kOne - kOne * share_gone(eta, kOne); };
    const Scalar pulled_mean = kOne * mean_decay(eta_pulled);
    const Scalar pushed_mean = kOne * mean_decay(eta_pushed);
    const Scalar pushed_decay = decay(eta_pushed);
    const Scalar both_mean = pushed_mean + pulled_mean * pushed_decay;
    const Scalar lost = kOne * share_gone(eta_pulled + eta_pushed, kOne);
    slack_from_ = pretension_nm / pulled_mean;
    slack_until_ = -(pretension_nm * pushed_decay / pushed_mean);
    pulled_slope_ = ratio * decay(eta_pulled);
    both_slope_ = ratio * (decay(eta_pulled) + lost * pulled_mean / both_mean);
    both_base_ = -(ratio * (lost * pretension_nm / both_mean));
    pushed_slope_ = ratio / pushed_decay;
  }

  [[nodiscard, gnu::always_inline]] constexpr auto at(Scalar x) const -> Point {
    if (slack_from_ <= x) {
      return {pulled_slope_ * x, true};
    }
    return x < slack_until_ ? Point{pushed_slope_ * x, true} : Point{both_slope_ * x + both_base_, false};
  }
  /// The line turned round: the motor torque at which the output is this.
  [[nodiscard]] constexpr auto input_for(Scalar torque) const -> Scalar {
    if (pulled_slope_ * slack_from_ <= torque) {
      return torque / pulled_slope_;
    }
    return torque < pushed_slope_ * slack_until_ ? torque / pushed_slope_ : (torque - both_base_) / both_slope_;
  }
  /// Motor torques where a piece of the line ends, rising.
  [[nodiscard]] constexpr auto ends() const -> std::array<Scalar, 2> { return {slack_until_, slack_from_}; }
  /// Both tendons are taut (or the pushed one just slack) and the pulled one carries more: what (2.18) and (2.21) ask.
  [[nodiscard]] constexpr auto is_admissible(Scalar x) const -> bool { return Scalar{} < x && Scalar{} < at(x).torque; }

 private:
  Scalar slack_from_{};
  Scalar slack_until_{};
  Scalar pulled_slope_{};
  Scalar both_slope_{};
  Scalar both_base_{};
  Scalar pushed_slope_{};
};

/// What the output does between two lines, in phase I.
enum class HoldRule : std::uint8_t {
  kUntilPassed,   ///< it holds until the line of the present direction has come to it: no jump
  kUntilPulling,  ///< as printed, (2.18) and (2.21): it holds until the pulled tendon carries more, then jumps there
};

/// The pull and pull-push laws and their blend: motor torque to joint torque, tip locked or against something stiff.
/// Rate-independent; one multiplication and a few comparisons a law and step.
template <typename Scalar>
class PullPush {
 public:
  /// Parameters that `check` refuses make every step report `beyond_table` and force zero; ask `check` why.
  constexpr explicit PullPush(const PullPushParameters<Scalar>& parameters, HoldRule rule = HoldRule::kUntilPassed)
      : usable_(check(parameters) == PullPushFault::kNone), rule_(rule), parameters_(parameters) {
    if (usable_) {
      pull_ = Law(parameters, Scalar{});
      pull_push_ = Law(parameters, parameters.pretension_nm);
    }
  }

  /// @param tau  motor-side torque, N m   @param forward  the direction switch of the motor, J of (5.20)
  constexpr auto update(Scalar tau, bool forward) -> ForceEstimate<Scalar> {
    ForceEstimate<Scalar> estimate;
    if (!usable_) {
      estimate.beyond_table = true;
      return estimate;
    }
    pull_.update(tau, forward, rule_);
    pull_push_.update(tau, forward, rule_);
    const WeightedSum<Scalar> force = blended(pull_.held, pull_push_.held);
    estimate.force = force.value();
    estimate.saturated =
        ScalarTraits<Scalar>::is_saturated(tau) || ScalarTraits<Scalar>::is_saturated(estimate.force) || force.cut();
    const bool one = parameters_.pull_weight == Scalar{} || parameters_.pull_push_weight == Scalar{};
    const Law& lead = parameters_.pull_push_weight == Scalar{} ? pull_ : pull_push_;
    estimate.known = one ? lead.known : pull_.known && pull_push_.known;
    estimate.phase = lead.phase;
    if (!one && estimate.known && lead.phase == ForcePhase::kHeld && pull_.phase != ForcePhase::kHeld) {
      estimate.phase = ForcePhase::kPulledActive;
    }
    return estimate;
  }

  /// The law turned round, for kUntilPassed: the motor torque nearest to `now` that brings the output there. Changes
  /// nothing. @pre the parameters are usable, `now` is what the last update was given
  [[nodiscard]] constexpr auto input_for(Scalar torque, Scalar now) const -> Scalar {
    const Scalar held = blended(pull_.held, pull_push_.held).value();
    if (held < torque) {
      return rising_input_for({{pull_.forward_line, pull_.held}, {pull_push_.forward_line, pull_push_.held}}, torque,
                              now);
    }
    if (torque < held) {
      return -rising_input_for({{pull_.backward_line, -pull_.held}, {pull_push_.backward_line, -pull_push_.held}},
                               -torque, -now);
    }
    return now;
  }

 private:
  [[nodiscard]] constexpr auto blended(Scalar pull, Scalar pull_push) const -> WeightedSum<Scalar> {
    WeightedSum<Scalar> force;
    force.add_checked(parameters_.pull_weight, pull);
    force.add_checked(parameters_.pull_push_weight, pull_push);
    return force;
  }

  /// A line and what its output is held at until the line has come to it.
  struct HeldLine {
    const TransmissionLine<Scalar>& line;
    Scalar held;
    [[nodiscard]] constexpr auto at(Scalar x) const -> Scalar { return std::max(held, line.at(x).torque); }
  };
  struct HeldLines {
    HeldLine pull, pull_push;
  };

  /// As the motor's torque rises from `now`. The output is straight between the torques at which a line comes to what
  /// is held or a piece of it ends. @pre the output at `now` is below `torque`
  [[nodiscard]] constexpr auto rising_input_for(const HeldLines& lines, Scalar torque, Scalar now) const -> Scalar {
    constexpr Scalar kOne = ScalarTraits<Scalar>::from(1.0);
    const HeldLine& pull = lines.pull;
    const HeldLine& pull_push = lines.pull_push;
    if (parameters_.pull_weight == Scalar{} && parameters_.pull_push_weight == kOne) {
      return std::max(now, pull_push.line.input_for(torque));
    }
    if (parameters_.pull_weight == kOne && parameters_.pull_push_weight == Scalar{}) {
      return std::max(now, pull.line.input_for(torque));
    }
    const auto output_at = [&](Scalar x) { return blended(pull.at(x), pull_push.at(x)).value(); };
    const auto pull_push_ends = pull_push.line.ends();
    const std::array<Scalar, 5> knots = {pull.line.input_for(pull.held), pull.line.ends()[1],
                                         pull_push.line.input_for(pull_push.held), pull_push_ends[0],
                                         pull_push_ends[1]};
    Scalar x = now;
    Scalar output = output_at(now);
    for (std::size_t visited = 0; visited < knots.size(); ++visited) {
      const Scalar* next = nullptr;
      for (const Scalar& knot : knots) {
        next = x < knot && (next == nullptr || knot < *next) ? &knot : next;
      }
      if (next == nullptr) {
        break;
      }
      const Scalar there = output_at(*next);
      if (torque <= there) {
        return x + (torque - output) / (there - output) * (*next - x);
      }
      x = *next;
      output = there;
    }
    // Beyond the last of them the pulled tendon alone carries in both laws.
    return x + (torque - output) / (output_at(x + kOne) - output);
  }

  /// One law with what it holds.
  struct Law {
    constexpr Law() = default;
    constexpr Law(const PullPushParameters<Scalar>& p, Scalar pretension)
        : forward_line(p.eta_top, p.eta_bottom, pretension, p.ratio),
          backward_line(p.eta_bottom, p.eta_top, pretension, p.ratio) {}

    constexpr void update(Scalar tau, bool forward, HoldRule rule) {
      rule == HoldRule::kUntilPassed ? follow(tau) : follow_printed(tau, forward);
    }
    /// The output lies between the two lines and moves only where one of them takes it along.
    constexpr void follow(Scalar tau) {
      if (const auto low = forward_line.at(tau); held < low.torque) {
        move_to(low.torque, low.one_slack);
      } else if (const auto high = backward_line.at(-tau); - high.torque < held) {
        move_to(-high.torque, high.one_slack);
      } else {
        hold();
      }
    }
    constexpr void follow_printed(Scalar tau, bool forward) {
      const auto& line = forward ? forward_line : backward_line;
      const Scalar x = forward ? tau : -tau;
      if (line.is_admissible(x)) {
        const auto point = line.at(x);
        move_to(forward ? point.torque : -point.torque, point.one_slack);
      } else {
        hold();
      }
    }
    constexpr void move_to(Scalar torque, bool one_slack) {
      held = torque;
      known = true;
      phase = one_slack ? ForcePhase::kOneSlack : ForcePhase::kBothActive;
    }
    constexpr void hold() { phase = known ? ForcePhase::kHeld : ForcePhase::kUnknown; }

    TransmissionLine<Scalar> forward_line{};
    TransmissionLine<Scalar> backward_line{};
    Scalar held{};
    bool known = false;
    ForcePhase phase = ForcePhase::kUnknown;
  };

  bool usable_;
  HoldRule rule_;
  PullPushParameters<Scalar> parameters_;
  Law pull_{};
  Law pull_push_{};
};

}  // namespace capstan
