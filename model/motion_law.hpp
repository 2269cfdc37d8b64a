// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <utility>

#include "model/catalogue.hpp"

namespace capstan {

/// Every number of a motion law. All zero but beta = 1 is the rigid law q2 = q1; an effect with zero coefficients is
/// off, and the law is then bit-identical to one without it.
template <typename Scalar>
struct LawParameters {
  std::array<Scalar, kCoefficientCount> coefficients{};  ///< theta, in the order of SumTerms
  std::array<Scalar, kShapeCount> shapes{};              ///< in the order of SumTerms, then OutputTerms
  ConditionerShape<Scalar> conditioner{};
};

template <typename Scalar>
struct Estimate {
  Scalar q2{};             ///< joint angle now, rad: what control acts on
  Scalar q2_reported{};    ///< what a joint sensor with the law's output effects would report now, rad
  bool saturated = false;  ///< a number met the end of its range: the angles are not to be trusted
};

/// Motor angle and torque to joint angle: the sum of all terms of the catalogue,
///   y = sum theta_k phi_k(sample, state, shape),
/// passed through the output terms. One sample in, one estimate out; no allocation; the time depends on which effects
/// are on.
template <typename Scalar>
class MotionLaw {
 public:
  constexpr MotionLaw(SamplePeriod<Scalar> dt, const LawParameters<Scalar>& parameters)
      : coefficients_(parameters.coefficients),
        conditioner_(dt, parameters.conditioner),
        terms_(make<SumTerms, 0>(dt, parameters)),
        output_terms_(make<OutputTerms, SumTerms::kShapes>(dt, parameters)) {}

  /// @param q1  motor angle, rad   @param tau  motor-side torque, N m
  constexpr auto update(Scalar q1, Scalar tau) -> Estimate<Scalar> {
    return update(Measured<Scalar>{.q1 = q1, .tau = tau});
  }

  /// With what the machine knows beside motor angle and torque. `now.q2` is not read: the law runs free, on its own
  /// last estimate, and on beta q1 + offset in the first cycle.
  constexpr auto update(const Measured<Scalar>& now) -> Estimate<Scalar> {
    const Sample<Scalar>& sample = conditioner_.update(now, started_ ? q2_ : beta() * now.q1 + coefficients_[kOffset]);
    started_ = true;
    Estimate<Scalar> estimate{.saturated = sample.saturated};
    // Each partial sum counts: a later term could lead the total back from the end of the range and hide the cut. Only
    // a regressor whose coefficient is zero does not: nothing of it gets through.
    const auto watch = [&estimate](Scalar coefficient, Scalar regressor, Scalar product, Scalar total) {
      estimate.saturated |= (Traits::is_saturated(regressor) && coefficient != Scalar{}) ||
                            Traits::is_saturated(product) || Traits::is_saturated(total);
    };
    estimate.q2 = sum(
        terms_, [&sample](auto& term) { return term.update(sample); }, watch);
    q2_ = estimate.q2;
    estimate.q2_reported = estimate.q2;
    std::apply([&](auto&... term) { ((estimate.q2_reported = term.update(estimate.q2_reported)), ...); },
               output_terms_);
    estimate.saturated |= Traits::is_saturated(estimate.q2_reported);
    return estimate;
  }

  /// The conditioned form of the last sample.
  [[nodiscard]] constexpr auto sample() const -> const Sample<Scalar>& { return conditioner_.sample(); }
  [[nodiscard]] constexpr auto beta() const -> Scalar { return coefficients_[kBeta]; }

  /// The law turned round, for feedforward: the motor angle, rad, at which the joint stands at q2 while a motion like
  /// `motion` (its direction, speed and torque) has settled. From (5.28): q1 = (q2 - rest) / beta. `motion.q1` is where
  /// the motor is about to be, for what is periodic in it; its q2 is not read.
  /// @pre beta is not zero; if it is, the result saturates.
  [[nodiscard]] constexpr auto invert(Scalar q2, Sample<Scalar> motion) const -> Scalar {
    motion.q2 = q2;
    const Scalar all = sum(
        terms_, [&motion](const auto& term) { return term.settled(motion); }, [](auto...) {});
    return (q2 - (all - beta() * motion.q1)) / beta();
  }

 private:
  using Traits = ScalarTraits<Scalar>;
  static constexpr std::size_t kBeta = 0;    // MotorAngle leads the catalogue
  static constexpr std::size_t kOffset = 1;  // JointOffset follows
  static_assert(std::is_same_v<std::tuple_element_t<0, SumTerms::Tuple<Scalar>>, MotorAngle<Scalar>>);
  static_assert(std::is_same_v<std::tuple_element_t<1, SumTerms::Tuple<Scalar>>, JointOffset<Scalar>>);

  /// Builds the terms of a list, each from its slice of the flat shapes.
  template <typename List, std::size_t FirstShape>
  static constexpr auto make(SamplePeriod<Scalar> dt, const LawParameters<Scalar>& parameters) {
    std::size_t next = FirstShape;
    auto make_one = [&]<typename Term>(std::in_place_type_t<Term>) {
      std::array<Scalar, kShapesOf<Term>> shape{};
      for (Scalar& value : shape) {
        value = parameters.shapes[next++];
      }
      return Term(dt, shape);
    };
    // Braces, not parentheses: they fix the order of evaluation.
    return [&]<typename... Term>(std::type_identity<std::tuple<Term...>>) {
      return std::tuple<Term...>{make_one(std::in_place_type<Term>)...};
    }(std::type_identity<typename List::template Tuple<Scalar>>{});
  }

  /// @param watch  told of each coefficient, regressor, product and partial sum
  template <typename Terms, typename Regressors, typename Watch>
  constexpr auto sum(Terms& terms, Regressors&& regressors_of, Watch&& watch) const -> Scalar {
    Scalar total{};
    std::size_t next = 0;
    auto add = [&](auto& term) {
      // An effect that is off adds nothing, whatever its state: its coefficients change only with a new law.
      constexpr std::size_t kCount = std::tuple_size_v<decltype(regressors_of(term))>;
      const auto first = coefficients_.begin() + static_cast<std::ptrdiff_t>(next);
      if (std::all_of(first, first + kCount, [](Scalar coefficient) { return coefficient == Scalar{}; })) {
        next += kCount;
        return;
      }
      for (const Scalar regressor : regressors_of(term)) {
        const Scalar coefficient = coefficients_[next++];
        const Scalar product = coefficient * regressor;
        total += product;
        watch(coefficient, regressor, product, total);
      }
    };
    std::apply([&](auto&... term) { (add(term), ...); }, terms);
    return total;
  }

  std::array<Scalar, kCoefficientCount> coefficients_;
  SampleConditioner<Scalar> conditioner_;
  typename SumTerms::Tuple<Scalar> terms_;
  typename OutputTerms::Tuple<Scalar> output_terms_;
  Scalar q2_{};  ///< last estimate
  bool started_ = false;
};

}  // namespace capstan
