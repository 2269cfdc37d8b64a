// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/model/reciprocal.hpp"
#include "capstan/model/term.hpp"
#include "capstan/model/trigonometry.hpp"

namespace capstan::effort {

/// Friction in proportion to the load that the gear carries: the weight, sin(q1 - rest), or a spring,
/// (q1 - rest) / span. One part is as large in both directions; the other comes only while the motor drives the load
/// (a gear that a load turns back loses another share than one that lifts it).
template <typename Scalar>
class LoadFriction {
 public:
  static constexpr TermInfo<4, 2> kInfo = {
      .name = "load_friction",
      .equation =
          "s (W |w| + W1 max(s w, 0) + S |u| + S1 max(s u, 0)), s = 2J - 1, w = sin(q1 - rest), u = (q1 - rest) / span",
      .source = "Coulomb with the normal force of the load; M3 to M6 of Rhoban's BAM",
      .confusable_with = "gravity, coulomb_friction where the load hardly changes",
      .exciting_motion = "slow motion both ways through places of much and of little load",
      .coefficients = {{{"weight", "Nm", Sign::kAny, "friction where the weight is largest"},
                        {"weight_driven", "Nm", Sign::kAny, "what is added while the motor lifts it"},
                        {"spring", "Nm", Sign::kAny, "friction at one span from the rest"},
                        {"spring_driven", "Nm", Sign::kAny, "what is added while the motor pulls away from the rest"}}},
      .shapes = {{{"rest", "rad", -120.0, 120.0, 0.0, "angle at which the load is nothing"},
                  {"span", "rad", 0.0001, 120.0, 1.0, "half of the motion's range"}}},
  };
  static constexpr bool kStaysInRange = true;

  constexpr LoadFriction(SamplePeriod<Scalar> /*dt*/, const std::array<Scalar, 2>& shape)
      : rest_(shape[0]), span_(shape[1]), per_span_(shape[1]), phase_(Traits::from(1.0)) {}
  constexpr auto update(const Sample<Scalar>& s) -> std::array<Scalar, 4> { return steady_state(s); }
  [[nodiscard]] constexpr auto steady_state(const Sample<Scalar>& s) const -> std::array<Scalar, 4> {
    return directed(s, undirected(s));
  }
  /// Weight and spring at this angle.
  [[nodiscard, gnu::always_inline]] constexpr auto undirected(const Sample<Scalar>& s) const -> std::array<Scalar, 2> {
    constexpr Scalar kMost = Traits::from(4.0);  // constant: the target converts no double at run time
    const Scalar away = s.q1 - rest_;
    const Scalar weight = phase_(away).sine_and_cosine()[0];
    const Scalar spring = span_ > Scalar{} ? clamp(away * per_span_, -kMost, kMost) : Scalar{};
    return {weight, spring};
  }
  /// Of these what a motion in the sample's direction shows.
  [[nodiscard, gnu::always_inline]] constexpr auto directed(const Sample<Scalar>& s,
                                                            const std::array<Scalar, 2>& load) const
      -> std::array<Scalar, 4> {
    const Scalar slide = s.slide();
    const auto [weight, spring] = load;
    const Scalar of_weight = Traits::part(abs(weight), Traits::share_of(slide));
    const Scalar of_spring = Traits::part(abs(spring), Traits::share_of(slide));
    return {of_weight, driven(weight, of_weight), of_spring, driven(spring, of_spring)};
  }

 private:
  using Traits = ScalarTraits<Scalar>;
  /// The load where the motor goes its way, nothing where it goes against it.
  static constexpr auto driven(Scalar load, Scalar against) -> Scalar {
    return Traits::template shifted_down<1>(load + against);
  }

  Scalar rest_;
  Scalar span_;
  Reciprocal<Scalar> per_span_;
  PhaseScale<Scalar> phase_;
};

}  // namespace capstan::effort
