// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <tuple>
#include <utility>

#include "capstan/model/catalogue.hpp"

namespace capstan {

/// Turns into a term where it is wanted, so that a tuple makes its terms in place: by value each of them would be on
/// the stack as well.
template <typename Term, typename Scalar>
struct TermMaker {
  SamplePeriod<Scalar> dt;
  const Scalar* shapes;
  constexpr operator Term() const {  // implicit: the conversion is all that it is for
    std::array<Scalar, kShapesOf<Term>> own{};
    std::copy_n(shapes, own.size(), own.begin());
    return Term(dt, own);
  }
};

/// Builds the terms of a list, each from its slice of the flat shapes.
template <typename List, std::size_t FirstShape, typename Scalar, std::size_t Shapes>
constexpr auto make_terms(SamplePeriod<Scalar> dt, const std::array<Scalar, Shapes>& shapes) {
  std::size_t next = FirstShape;
  const auto own_shapes = [&](std::size_t count) { return shapes.data() + std::exchange(next, next + count); };
  // Braces, not parentheses: they fix the order of evaluation.
  return [&]<typename... Term>(std::type_identity<std::tuple<Term...>>) {
    return std::tuple<Term...>{TermMaker<Term, Scalar>{dt, own_shapes(kShapesOf<Term>)}...};
  }(std::type_identity<typename List::template Tuple<Scalar>>{});
}

/// The input terms of a law, one after the other, and the rate of what comes out of them. Off, it leaves the sample as
/// it is, bit for bit.
template <typename Scalar>
class InputStage {
 public:
  /// @param rate_gain  of the filter of dq1
  constexpr InputStage(SamplePeriod<Scalar> dt, const std::array<Scalar, kShapeCount>& shapes,
                       typename ScalarTraits<Scalar>::Gain rate_gain)
      : dt_(dt), gain_(rate_gain), terms_(make_terms<InputTerms, 0>(dt, shapes)) {}
  constexpr void restart() {
    std::apply([](auto&... term) { (capstan::restart(term), ...); }, terms_);
    lag_ = lag_rate_ = Scalar{};
  }
  [[nodiscard]] constexpr auto is_on() const -> bool {
    return std::apply([](const auto&... term) { return (term.is_on() || ...); }, terms_);
  }

  /// Puts h and dh into the sample. @pre h is q1 there
  [[gnu::always_inline]] constexpr void update(Sample<Scalar>& sample) {
    std::apply([&sample](auto&... term) { ((sample.h = term.is_on() ? term.update(sample) : sample.h), ...); }, terms_);
    const Scalar lag = sample.h - sample.q1;
    const Scalar rate = dt_.rate_of(lag - lag_);
    const Scalar rate_error = rate - lag_rate_;
    lag_ = lag;
    lag_rate_ += Traits::part(rate_error, gain_);
    sample.dh = sample.dq1 + lag_rate_;
    const unsigned saturated = unsigned{Traits::is_saturated(sample.h)} | unsigned{Traits::is_saturated(rate)} |
                               unsigned{Traits::is_saturated(rate_error)} | unsigned{Traits::is_saturated(sample.dh)};
    sample.saturated |= saturated != 0;
  }
  /// Makes h what it is once a motion in the sample's direction has lasted. @pre h is q1 there
  constexpr void settle(Sample<Scalar>& motion) const {
    std::apply([&motion](const auto&... term) { ((motion.h = term.steady_state(motion)), ...); }, terms_);
  }
  /// The motor angle at which h stands, once a motion in this direction has lasted.
  [[nodiscard]] constexpr auto undone(Scalar h, bool forward) const -> Scalar {
    return undone(h, forward, std::make_index_sequence<std::tuple_size_v<decltype(terms_)>>{});
  }

 private:
  using Traits = ScalarTraits<Scalar>;
  template <std::size_t... I>
  [[nodiscard]] constexpr auto undone(Scalar h, bool forward, std::index_sequence<I...>) const -> Scalar {
    ((h = std::get<sizeof...(I) - 1 - I>(terms_).undone(h, forward)), ...);  // the last one first
    return h;
  }

  SamplePeriod<Scalar> dt_;
  typename ScalarTraits<Scalar>::Gain gain_;
  typename InputTerms::Tuple<Scalar> terms_;
  Scalar lag_{};
  Scalar lag_rate_{};
};

}  // namespace capstan
