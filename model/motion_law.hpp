// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <span>
#include <utility>

#include "capstan/model/input_stage.hpp"
#include "capstan/model/reciprocal.hpp"
#include "capstan/model/weighted_sum.hpp"

namespace capstan {

/// Every number of a motion law. All zero but beta = 1 is the rigid law q2 = q1; an effect with zero coefficients is
/// off, and the law is then bit-identical to one without it.
template <typename Scalar>
struct LawParameters {
  std::array<Scalar, kCoefficientCount> coefficients{};  ///< theta, in the order of SumTerms
  std::array<Scalar, kShapeCount> shapes{};              ///< in the order of InputTerms, SumTerms, OutputTerms
  ConditionerShape<Scalar> conditioner{};
};

/// A law can be made of these: its coefficients' magnitudes add up to less than 256, of a table's the largest counting,
/// so that no sum of fixed point wraps. One that does not fit estimates nothing but zero, `saturated` in every cycle.
template <typename Scalar>
constexpr auto fits(const LawParameters<Scalar>& parameters) -> bool {
  typename WeightedSum<Scalar>::Reach reach;
  auto next = parameters.coefficients.begin();
  SumTerms::for_each<Scalar>([&]<typename Term>() {
    const std::span<const Scalar> own(next, kCoefficientsOf<Term>);
    next += static_cast<std::ptrdiff_t>(kCoefficientsOf<Term>);
    if constexpr (one_at_a_time<Term>()) {
      reach.add_largest(own);
    } else {
      reach.add(own);
    }
  });
  return reach.holds();
}

/// What is wrong with the shapes and coefficients of a law's parts together, beside their own ranges.
enum class LawFault : std::uint8_t {
  kNone,
  kRatioTurnsBack,  ///< the ratio's curve: somewhere the joint would stand or run against its motor
  kTableEnds,       ///< a table with its ends out of order
};

/// For whoever takes a law, not for the cycle.
constexpr auto check_parts(const LawParameters<Q24>& parameters) -> LawFault {
  LawFault fault = LawFault::kNone;
  const Q24* own = parameters.coefficients.data();
  const Q24* shape = parameters.shapes.data() + InputTerms::kShapes;
  const Q24 beta = parameters.coefficients[0];  // MotorAngle leads the catalogue
  SumTerms::for_each<Q24>([&]<typename Term>() {
    if constexpr (std::is_same_v<Term, CurvedRatio<Q24>>) {
      const bool on = own[0] != Q24{} || own[1] != Q24{};
      fault = on && !follows_everywhere(beta, own[0], own[1], shape[1]) ? LawFault::kRatioTurnsBack : fault;
    }
    if constexpr (std::is_same_v<Term, Table<Q24>>) {
      const bool on = std::any_of(own, own + kCoefficientsOf<Term>, [](Q24 value) { return value != Q24{}; });
      fault = on && shape[2] >= shape[3] ? LawFault::kTableEnds : fault;
    }
    own += kCoefficientsOf<Term>;
    shape += kShapesOf<Term>;
  });
  return fault;
}

template <typename Scalar>
struct Estimate {
  Scalar q2{};             ///< joint angle now, rad: what control acts on
  Scalar q2_reported{};    ///< what a joint sensor with the law's output effects would report now, rad
  bool saturated = false;  ///< a number met the end of its range: the angles are not to be trusted
};

/// Motor angle and torque to joint angle, a chain: the input terms make h of the motor angle, which the sum of all
/// terms of the catalogue sees beside the motor angle itself,
///   y = sum theta_k phi_k(sample, state, shape),  beta h among them,
/// passed through the output terms. One sample in, one estimate out; no allocation; the time depends on which effects
/// are on.
template <typename Scalar>
class MotionLaw {
 public:
  constexpr MotionLaw(SamplePeriod<Scalar> dt, const LawParameters<Scalar>& parameters)
      : unfit_(!fits(parameters)),
        coefficients_(unfit_ ? decltype(coefficients_){} : parameters.coefficients),
        active_(active_terms(coefficients_)),
        per_beta_(beta()),
        curve_(make_curve(parameters)),
        conditioner_(dt, parameters.conditioner),
        input_(dt, parameters.shapes, dt.filter_gain(parameters.conditioner.rate_time_constant_s)),
        input_on_(input_.is_on()),
        terms_(make_terms<SumTerms, InputTerms::kShapes>(dt, parameters.shapes)),
        output_terms_(make_terms<OutputTerms, InputTerms::kShapes + SumTerms::kShapes>(dt, parameters.shapes)) {}

  /// As newly made of the same parameters, without the divisions that making takes.
  constexpr void restart() {
    conditioner_.restart();
    input_.restart();
    for_each_active(terms_, [](auto& term, std::size_t /*first*/) { capstan::restart(term); });
    std::apply([](auto&... term) { (capstan::restart(term), ...); }, output_terms_);
    q2_ = Scalar{};
    as_it_is_ = {};
    started_ = false;
  }

  /// @param q1  motor angle, rad   @param tau  motor-side torque, N m
  constexpr auto update(Scalar q1, Scalar tau) -> Estimate<Scalar> {
    return update(Measured<Scalar>{.q1 = q1, .tau = tau});
  }

  /// With what the machine knows beside motor angle and torque. `now.q2` is not read: the law runs free, on its own
  /// last estimate, and on beta q1 + offset in the first cycle.
  constexpr auto update(const Measured<Scalar>& now) -> Estimate<Scalar> {
    if (!started_) {
      started_ = true;
      q2_ = beta() * now.q1 + coefficients_[kOffset];
    }
    conditioner_.update(now, q2_);
    if (has_tendons()) {
      conditioner_.delay_torque();
    }
    if (input_on_) {
      conditioner_.pass_through(input_);
    }
    const Sample<Scalar>& sample =
        conditioner_.sample();  // as a part of this, so that what is read of it once is known
    const Scalar* const pulled = pulled_by(sample);
    WeightedSum<Scalar> y;
    update_terms<true>(sample, pulled, y);
    as_it_is_ = y;
    update_terms<false>(sample, pulled, y);
    q2_ = y.value();
    Estimate<Scalar> estimate{.q2 = q2_, .q2_reported = q2_};
    std::apply([&](auto&... term) { ((estimate.q2_reported = term.update(estimate.q2_reported)), ...); },
               output_terms_);
    estimate.saturated =
        Traits::is_saturated(q2_) || Traits::is_saturated(estimate.q2_reported) || unfit_ | sample.saturated | y.cut();
    return estimate;
  }

  /// The conditioned form of the last sample.
  [[nodiscard]] constexpr auto sample() const -> const Sample<Scalar>& { return conditioner_.sample(); }
  [[nodiscard]] constexpr auto beta() const -> Scalar { return coefficients_[kBeta]; }

  /// Whether it has a state of the tendons (`tendon`).
  [[nodiscard]] constexpr auto has_tendons() const -> bool { return is_active<Tendons<Scalar>>(); }
  /// What they give to the joint, N m. @pre has_tendons()
  [[nodiscard]] constexpr auto joint_torque() const -> ForceEstimate<Scalar> {
    const auto& tendons = std::get<kPlace<Tendons<Scalar>>>(terms_).tendons();
    ForceEstimate<Scalar> estimate;
    estimate.force = per_beta(tendons.output());
    estimate.known = tendons.is_known();
    estimate.phase = tendons.phase();
    estimate.saturated = Traits::is_saturated(estimate.force);
    return estimate;
  }

  /// The law turned round, for feedforward: the motor angle, rad, at which the joint stands at q2 while a motion like
  /// `motion` (its direction, speed and torque) has settled. From (5.28): h = (q2 - rest) / beta, the curve of the
  /// ratio turned round with it, then the input terms. `motion.q1` is where the motor is about to be, for what is
  /// periodic in it, for a table of it, and for the curve to be turned round from; its q2 is not read.
  /// @pre beta is not zero; if it is, the result saturates.
  [[nodiscard]] constexpr auto invert(Scalar q2, Sample<Scalar> motion) const -> Scalar {
    const WeightedSum<Scalar> lasting = settled(motion.tau, motion.forward);
    const Scalar left = q2 - (rest_either_way(q2, motion) + rest_one_way(motion, lasting));
    return undone(through_ratio(left, motion.q1), motion.forward);
  }
  /// What is left of the joint angle after the rest, taken back through ratio and curve: h, rad.
  /// @param near  where the motor is about to be, rad
  [[nodiscard]] constexpr auto through_ratio(Scalar joint_side, Scalar near) const -> Scalar {
    return is_active<CurvedRatio<Scalar>>() ? curve_(joint_side, near) : per_beta(joint_side);
  }
  /// The motor angle to an h in steady state in one direction, rad.
  [[nodiscard, gnu::always_inline]] constexpr auto undone(Scalar h, bool forward) const -> Scalar {
    return input_on_ ? input_.undone(h, forward) : h;
  }
  /// The two parts of the rest, for who turns the law round for both directions at once: what is the same whichever
  /// way the motion goes and whatever torque it takes, and what is not. Of `motion` q2 and h are changed: a copy costs
  /// as much as a term.
  [[nodiscard, gnu::always_inline]] constexpr auto rest_either_way(Scalar q2, Sample<Scalar>& motion) const -> Scalar {
    motion.q2 = q2;
    WeightedSum<Scalar> rest = as_it_is_;
    add_steady<SteadyState::kEitherWay>(motion, rest);
    return rest.value();
  }
  /// @param settled  of the motion's torque and direction
  [[nodiscard, gnu::always_inline]] constexpr auto rest_one_way(Sample<Scalar>& motion,
                                                                const WeightedSum<Scalar>& settled) const -> Scalar {
    motion.h = motion.q1;
    if (input_on_) {
      input_.settle(motion);
    }
    WeightedSum<Scalar> rest = settled;
    add_steady<SteadyState::kOfMotion>(motion, rest);
    return rest.value();
  }
  /// The part of the rest one way that every motion with this torque and direction has, as long as the law stays.
  [[nodiscard]] constexpr auto settled(Scalar tau, bool forward) const -> WeightedSum<Scalar> {
    WeightedSum<Scalar> rest;
    add_steady<SteadyState::kOfDirection>({.tau = tau, .forward = forward}, rest);
    return rest;
  }
  /// How far the motor goes, rad, while the joint stands and its motion turns round: across gaps, hystereses and what
  /// the tendons stretch from one torque to the other. Not below 0. For whoever takes a law, not for every cycle.
  [[nodiscard]] constexpr auto lost_motion(Scalar tau_backward, Scalar tau_forward) const -> Scalar {
    const auto stands_at = [this](Scalar tau, Scalar tau_before, bool forward) {
      Sample<Scalar> motion{.tau = tau, .forward = forward, .tau_reversal = tau_before};
      return undone(per_beta(-rest_one_way(motion, settled(tau, forward))), forward);
    };
    return std::max(stands_at(tau_forward, tau_backward, true) - stands_at(tau_backward, tau_forward, false), Scalar{});
  }
  /// What the joint does, as the rigid part of the law asks it of the motor: an angle, a rate, an acceleration.
  [[nodiscard]] constexpr auto per_beta(Scalar joint_side) const -> Scalar { return joint_side * per_beta_; }

 private:
  using Traits = ScalarTraits<Scalar>;
  static constexpr std::size_t kBeta = 0;    // MotorAngle leads the catalogue
  static constexpr std::size_t kOffset = 1;  // JointOffset follows
  static_assert(std::is_same_v<std::tuple_element_t<0, SumTerms::Tuple<Scalar>>, MotorAngle<Scalar>>);
  static_assert(std::is_same_v<std::tuple_element_t<1, SumTerms::Tuple<Scalar>>, JointOffset<Scalar>>);

  static constexpr auto active_terms(const std::array<Scalar, kCoefficientCount>& coefficients) -> std::uint32_t {
    std::uint32_t active = 0;
    std::uint32_t bit = 1;
    auto next = coefficients.begin();
    SumTerms::for_each<Scalar>([&]<typename Term>() {
      const auto end = next + static_cast<std::ptrdiff_t>(kCoefficientsOf<Term>);
      active |= std::all_of(next, end, [](Scalar coefficient) { return coefficient == Scalar{}; }) ? 0 : bit;
      next = end;
      bit <<= 1U;
    });
    return active;
  }
  static_assert(std::tuple_size_v<typename SumTerms::Tuple<Scalar>> <= 32);

  /// Where a term's coefficients begin.
  template <std::size_t Index>
  static constexpr std::size_t kFirst = []<std::size_t... I>(std::index_sequence<I...>) {
    return (std::size_t{0} + ... + kCoefficientsOf<std::tuple_element_t<I, typename SumTerms::Tuple<Scalar>>>);
  }
  (std::make_index_sequence<Index>{});

  /// Where a term stands in the sum.
  template <typename Term>
  static constexpr std::size_t kPlace = []<typename... All>(std::type_identity<std::tuple<All...>>) {
    std::size_t place = 0;
    static_cast<void>(((std::is_same_v<Term, All> ? false : (++place, true)) && ...));
    return place;
  }(std::type_identity<typename SumTerms::Tuple<Scalar>>{});
  template <typename Term>
  [[nodiscard]] constexpr auto is_active() const -> bool {
    return (active_ >> kPlace<Term> & 1U) != 0;
  }
  constexpr auto make_curve(const LawParameters<Scalar>& parameters) const -> CurveInverse<Scalar> {
    std::size_t shape = InputTerms::kShapes;
    CurveInverse<Scalar> curve;
    SumTerms::for_each<Scalar>([&]<typename Term>() {
      if constexpr (std::is_same_v<Term, CurvedRatio<Scalar>>) {
        if (is_active<Term>()) {
          const Scalar* const own = &coefficients_[kFirst<kPlace<Term>>];
          curve = {beta(), own[0], own[1], {parameters.shapes[shape], parameters.shapes[shape + 1]}};
        }
      }
      shape += kShapesOf<Term>;
    });
    return curve;
  }

  /// Calls visit(term, place of its first coefficient) for every effect that is on. One that is off adds nothing,
  /// whatever its state: its coefficients change only with a new law.
  template <typename Terms, typename Visit>
  [[gnu::always_inline]] constexpr void for_each_active(Terms& terms, Visit&& visit) const {
    visit_active(terms, visit, std::make_index_sequence<std::tuple_size_v<typename SumTerms::Tuple<Scalar>>>{});
  }
  template <typename Terms, typename Visit, std::size_t... I>
  [[gnu::always_inline]] constexpr void visit_active(Terms& terms, Visit& visit, std::index_sequence<I...>) const {
    (visit_if<I>(terms, visit), ...);
  }
  template <std::size_t I, typename Terms, typename Visit>
  [[gnu::always_inline]] constexpr void visit_if(Terms& terms, Visit& visit) const {
    if (active_ >> I & 1U) [[likely]] {
      visit(std::get<I>(terms), kFirst<I>);
    }
  }

  /// The coefficients, one further back while the bottom tendon is pulled: those that count of a pair.
  [[nodiscard, gnu::always_inline]] constexpr auto pulled_by(const Sample<Scalar>& sample) const -> const Scalar* {
    return &coefficients_[sample.forward ? 0 : 1];
  }
  template <bool Checked, std::size_t Count>
  [[gnu::always_inline]] constexpr void add(const std::array<Scalar, Count>& regressors, std::size_t first,
                                            const Scalar* /*pulled*/, WeightedSum<Scalar>& sum) const {
#pragma GCC unroll 4
    for (std::size_t k = 0; k < Count; ++k) {
      add_one<Checked>(coefficients_[first + k], regressors[k], sum);
    }
  }
  template <bool Checked, std::size_t Common, bool Own>
  [[gnu::always_inline]] constexpr void add(const ByDirection<Scalar, Common, Own>& regressors, std::size_t first,
                                            const Scalar* pulled, WeightedSum<Scalar>& sum) const {
    if constexpr (Common > 0) {
      add<Checked>(regressors.common, first, pulled, sum);
    }
    if constexpr (Own) {
      add_one<Checked>(pulled[first + Common], regressors.value, sum);
    } else {
      add_one<Checked>(coefficients_[first + Common + (regressors.forward ? 0 : 1)], regressors.value, sum);
    }
  }
  template <bool Checked, std::size_t Count>
  [[gnu::always_inline]] constexpr void add(const Between<Scalar, Count>& regressors, std::size_t first,
                                            const Scalar* /*pulled*/, WeightedSum<Scalar>& sum) const {
    add_one<Checked>(coefficients_[first + regressors.at], regressors.rest, sum);
    add_one<Checked>(coefficients_[first + regressors.at + 1], regressors.share, sum);
  }
  template <bool Checked>
  [[gnu::always_inline]] static constexpr void add_one(Scalar coefficient, Scalar regressor, WeightedSum<Scalar>& sum) {
    if constexpr (Checked) {
      sum.add_checked(coefficient, regressor);
    } else {
      sum.add(coefficient, regressor);
    }
  }

  /// What is turned round by solving, not by taking its steady state away.
  template <typename Term>
  static consteval auto is_of_ratio() -> bool {
    return std::is_same_v<Term, MotorAngle<Scalar>> || std::is_same_v<Term, CurvedRatio<Scalar>>;
  }

  // Both inlined, or the sum is kept in memory.
  /// Those that are as they are to the inverse too, or all others.
  template <bool AsTheyAre>
  [[gnu::always_inline]] constexpr void update_terms(const Sample<Scalar>& sample, const Scalar* pulled,
                                                     WeightedSum<Scalar>& sum) {
    for_each_active(
        terms_, [&]<typename Term>(Term & term, std::size_t first) __attribute__((always_inline)) {
          if constexpr ((steady_state_of<Term>() == SteadyState::kAsItIs) == AsTheyAre) {
            add<!stays_in_range<Term>()>(term.update(sample), first, pulled, sum);
          }
        });
  }
  /// What the terms of a kind show once a motion has lasted; never beta h and its curve.
  template <SteadyState Kind>
  [[gnu::always_inline]] constexpr void add_steady(const Sample<Scalar>& motion, WeightedSum<Scalar>& rest) const {
    const Scalar* const pulled = pulled_by(motion);
    for_each_active(
        terms_, [&]<typename Term>(const Term& term, std::size_t first) __attribute__((always_inline)) {
          if constexpr (!is_of_ratio<Term>() && steady_state_of<Term>() == Kind) {
            add<false>(term.steady_state(motion), first, pulled, rest);
          }
        });
  }

  bool unfit_;
  std::array<Scalar, kCoefficientCount> coefficients_;
  std::uint32_t active_;  ///< a bit for each term, in the order of SumTerms
  Reciprocal<Scalar> per_beta_;
  CurveInverse<Scalar> curve_;
  SampleConditioner<Scalar> conditioner_;
  InputStage<Scalar> input_;
  bool input_on_;
  typename SumTerms::Tuple<Scalar> terms_;
  typename OutputTerms::Tuple<Scalar> output_terms_;
  WeightedSum<Scalar> as_it_is_;  ///< what the inverse takes of the last update
  Scalar q2_{};                   ///< last estimate
  bool started_ = false;
};

}  // namespace capstan
