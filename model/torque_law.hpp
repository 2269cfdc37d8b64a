// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <span>
#include <string_view>
#include <tuple>
#include <utility>

#include "capstan/model/effort_catalogue.hpp"
#include "capstan/model/input_stage.hpp"
#include "capstan/model/weighted_sum.hpp"

namespace capstan {

/// A term once more in one law, with coefficients and shapes of its own.
template <typename Term, int Place>
class PlacedTerm : public Term {
 public:
  static constexpr int kPlace = Place;
  using Term::Term;
};
template <typename Scalar>
using AnglePeriodic2 = PlacedTerm<AnglePeriodic<Scalar>, 2>;
template <typename Scalar>
using AnglePeriodic3 = PlacedTerm<AnglePeriodic<Scalar>, 3>;
template <typename Scalar>
using PlayFriction2 = PlacedTerm<effort::PlayFriction<Scalar>, 2>;
template <typename Scalar>
using LoadFriction2 = PlacedTerm<effort::LoadFriction<Scalar>, 2>;

/// Which of several of its kind a term is, from 1.
template <typename Term>
consteval auto place_of() -> int {
  if constexpr (requires { Term::kPlace; }) {
    return Term::kPlace;
  } else {
    return 1;
  }
}

/// What a torque law that runs on a board may consist of: effects of an effort that need no other joint's motion.
using TorqueTerms = TermList<effort::Inertia, effort::ViscousFriction, effort::CoulombFriction,
                             effort::FrictionAsymmetry, effort::StribeckFriction, effort::PlayFriction, effort::Offset,
                             Gravity, AnglePeriodic, ThermalDrift, effort::PowerLawFriction, effort::Spring,
                             effort::LoadFriction, AnglePeriodic2, AnglePeriodic3, PlayFriction2, LoadFriction2>;

/// A term's name in a law: "play_friction", "play_friction_2"; behind a prefix.
template <typename Term>
consteval auto placed_name(const char* prefix) -> std::array<char, 40> {
  std::array<char, 40> text{};
  std::size_t size = 0;
  for (const char* part : {prefix, Term::kInfo.name}) {
    for (; *part != 0; ++part) {
      text.at(size++) = *part;
    }
  }
  if (place_of<Term>() > 1) {
    text.at(size++) = '_';
    text.at(size++) = static_cast<char>('0' + place_of<Term>());
  }
  return text;
}
template <typename Term>
inline constexpr std::array<char, 40> kTorqueTermName = placed_name<Term>("");

/// A coefficient as a torque law has it: terms of the joint angle have torques in place of angles.
constexpr auto of_torque(CoefficientInfo info) -> CoefficientInfo {
  const std::string_view unit(info.unit);
  if (unit == "rad" || unit == "rad/K") {
    info.unit = unit == "rad" ? "Nm" : "Nm/K";
    info.doc = "torque per its regressor";
  }
  return info;
}

/// Every number of a torque law. Zero coefficients are effects that are off.
template <typename Scalar>
struct TorqueLawParameters {
  std::array<Scalar, TorqueTerms::kCoefficients> coefficients{};  ///< in the order of TorqueTerms
  std::array<Scalar, TorqueTerms::kShapes> shapes{};
};

/// There is a law: some coefficient is not zero.
template <typename Scalar>
constexpr auto is_on(const TorqueLawParameters<Scalar>& parameters) -> bool {
  return std::any_of(parameters.coefficients.begin(), parameters.coefficients.end(),
                     [](Scalar coefficient) { return coefficient != Scalar{}; });
}

/// A law can be made of these, as `fits` of a motion law.
template <typename Scalar>
constexpr auto fits(const TorqueLawParameters<Scalar>& parameters) -> bool {
  return WeightedSum<Scalar>::holds(parameters.coefficients);
}

template <typename Scalar>
struct Torque {
  Scalar torque_nm{};
  bool saturated = false;  ///< a number met the end of its range: the torque is not to be trusted
};

/// The motor torque that a motion takes, tau = sum theta_k phi_k(motion, state, shape): what `diagnose` finds for an
/// effort. The joint's angle is the motor's here (q2 = q1): the law knows no other. The time depends on which effects
/// are on.
template <typename Scalar>
class TorqueLaw {
 public:
  constexpr TorqueLaw(SamplePeriod<Scalar> dt, const TorqueLawParameters<Scalar>& parameters)
      : coefficients_(fits(parameters) ? parameters.coefficients : decltype(coefficients_){}),
        active_(active_terms(coefficients_)),
        terms_(make_terms<TorqueTerms, 0>(dt, parameters.shapes)) {
    add_steady<SteadyState::kOfDirection>({.forward = false}, settled_backward_);
    add_steady<SteadyState::kOfDirection>({.forward = true}, settled_forward_);
  }

  /// False: every coefficient is zero, there is no law.
  [[nodiscard]] constexpr auto is_on() const -> bool { return active_ != 0; }
  /// As newly made of the same parameters.
  constexpr void restart() {
    visit(terms_, [](auto& term, std::size_t /*first*/) { capstan::restart(term); });
  }

  /// One sample further. @param motion  its q1, q2 = q1, dq1, ddq1, forward and warmth are read
  [[gnu::flatten]] constexpr auto update(const Sample<Scalar>& motion) -> Torque<Scalar> {
    WeightedSum<Scalar> sum;
    visit(terms_, [&]<typename Term>(Term& term, std::size_t first) {
      add<!stays_in_range<Term>()>(term.update(motion), first, sum);
    });
    const Scalar torque = sum.value();
    return {torque, ScalarTraits<Scalar>::is_saturated(torque) || motion.saturated || sum.cut()};
  }

  /// The torque that a motion takes once it has lasted, N m, in two parts, for feedforward that passes from one
  /// direction to the other: what does not depend on motion.forward, and what does.
  [[nodiscard, gnu::flatten]] constexpr auto either_way(const Sample<Scalar>& motion) const -> Scalar {
    WeightedSum<Scalar> sum;
    add_steady<SteadyState::kEitherWay>(motion, sum);
    add_steady<SteadyState::kAsItIs>(motion, sum);
    return sum.value();
  }
  struct EachWay {
    Scalar backward{};
    Scalar forward{};
  };
  /// Both directions at once: what a term works out of speed and angle (`undirected`) is the same in both, and what
  /// depends on the direction alone is known. Of `motion` forward is not read, and changed.
  [[nodiscard, gnu::flatten]] constexpr auto each_way(Sample<Scalar>& motion) const -> EachWay {
    WeightedSum<Scalar> backward = settled_backward_;
    WeightedSum<Scalar> forward = settled_forward_;
    visit(terms_, [&]<typename Term>(const Term& term, std::size_t first) {
      if constexpr (steady_state_of<Term>() == SteadyState::kOfMotion) {
        const auto common = undirected(term, motion);
        motion.forward = false;
        add<false>(directed(term, motion, common), first, backward);
        motion.forward = true;
        add<false>(directed(term, motion, common), first, forward);
      }
    });
    return {backward.value(), forward.value()};
  }

 private:
  using Terms = typename TorqueTerms::Tuple<Scalar>;
  static constexpr std::size_t kTerms = std::tuple_size_v<Terms>;
  static_assert(kTerms <= 32);

  template <std::size_t Index>
  static constexpr std::size_t kFirst = []<std::size_t... I>(std::index_sequence<I...>) {
    return (std::size_t{0} + ... + kCoefficientsOf<std::tuple_element_t<I, Terms>>);
  }
  (std::make_index_sequence<Index>{});

  template <typename Term>
  static consteval auto has_undirected() -> bool {
    return requires(const Term& term, const Sample<Scalar>& motion) {
      term.undirected(motion);
    };
  }
  template <typename Term>
  [[gnu::always_inline]] static constexpr auto undirected(const Term& term,
                                                          [[maybe_unused]] const Sample<Scalar>& motion) {
    if constexpr (has_undirected<Term>()) {
      return term.undirected(motion);
    } else {
      return &term;
    }
  }
  template <typename Term, typename Common>
  [[gnu::always_inline]] static constexpr auto directed(const Term& term, const Sample<Scalar>& motion,
                                                        [[maybe_unused]] const Common& common) {
    if constexpr (has_undirected<Term>()) {
      return term.directed(motion, common);
    } else {
      return term.steady_state(motion);
    }
  }

  static constexpr auto active_terms(const std::array<Scalar, TorqueTerms::kCoefficients>& coefficients)
      -> std::uint32_t {
    std::uint32_t active = 0;
    std::uint32_t bit = 1;
    std::span<const Scalar> rest(coefficients);
    TorqueTerms::for_each<Scalar>([&]<typename Term>() {
      const auto own = rest.first(kCoefficientsOf<Term>);
      rest = rest.subspan(kCoefficientsOf<Term>);
      active |= std::all_of(own.begin(), own.end(), [](Scalar c) { return c == Scalar{}; }) ? 0 : bit;
      bit <<= 1U;
    });
    return active;
  }
  /// Calls visit(term, place of its first coefficient) for every effect that is on.
  template <typename All, typename Visit>
  [[gnu::always_inline]] constexpr void visit(All& terms, Visit&& visit) const {
    [&]<std::size_t... I>(std::index_sequence<I...>) {
      ((active_ >> I & 1U ? visit(std::get<I>(terms), kFirst<I>) : void()), ...);
    }
    (std::make_index_sequence<kTerms>{});
  }
  /// What the terms of a kind show once a motion has lasted.
  template <SteadyState Kind>
  [[gnu::always_inline]] constexpr void add_steady(const Sample<Scalar>& motion, WeightedSum<Scalar>& sum) const {
    visit(terms_, [&]<typename Term>(const Term& term, std::size_t first) {
      if constexpr (steady_state_of<Term>() == Kind) {
        add<false>(term.steady_state(motion), first, sum);
      }
    });
  }
  template <bool Checked, std::size_t Count>
  [[gnu::always_inline]] constexpr void add(const std::array<Scalar, Count>& regressors, std::size_t first,
                                            WeightedSum<Scalar>& sum) const {
#pragma GCC unroll 4
    for (std::size_t k = 0; k < Count; ++k) {
      if constexpr (Checked) {
        sum.add_checked(coefficients_[first + k], regressors[k]);
      } else {
        sum.add(coefficients_[first + k], regressors[k]);
      }
    }
  }

  std::array<Scalar, TorqueTerms::kCoefficients> coefficients_;
  std::uint32_t active_;  ///< a bit for each term, in the order of TorqueTerms
  Terms terms_;
  WeightedSum<Scalar> settled_backward_;  ///< what depends on the direction alone
  WeightedSum<Scalar> settled_forward_;
};

}  // namespace capstan
