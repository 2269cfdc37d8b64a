// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

#include "capstan/model/exponential.hpp"

namespace capstan {

/// The tension along one tendon at `Nodes` places, ends included, in torque at the motor (tension times r1). A place
/// keeps its tension as long as the input end's stays within the factor that friction holds there: that is the moving
/// slip front, (2.6) and (2.7), exact at the places. Between them tension goes by e^(-eta phi) one way or the other,
/// and the elongation below is exact for both; it is in the compliance's unit times N m.
/// Neighbours' tensions never differ by more than friction holds between them. So `up` never falls from place to place
/// and `down` never rises, and what moves is all between the input end and a front: nothing behind it is looked at.
template <typename Scalar, std::size_t Nodes>
class FrictionChain {
  static_assert(Nodes >= 2);

 public:
  struct Stretch {
    Scalar elongation{};  ///< compliance times the integral of the tension over phi
    Scalar slope{};       ///< d elongation / d input tension
  };

  constexpr FrictionChain() = default;
  /// @param compliance  of the whole tendon   @param free  share of the length at the two ends that touches nothing,
  /// half of it at each
  constexpr FrictionChain(Scalar eta, Scalar tension, Scalar compliance, Scalar free) {
    constexpr Scalar kOne = ScalarTraits<Scalar>::from(1.0);
    constexpr Scalar kLength = ScalarTraits<Scalar>::from(1.0 / static_cast<double>(Nodes - 1));
    const Scalar step = eta * kLength;
    const auto decay = [&](Scalar x) { return kOne - kOne * share_gone(x, kOne); };
    // h tanh(eta h / 2) / (eta h / 2): the cell's share of the integral, per mean of its ends. Each end belongs to one
    // cell, the places between to two.
    const Scalar half_cell = (kOne - free) * (kLength * mean_decay(step) / (kOne + decay(step)));
    inner_weight_ = compliance * (half_cell + half_cell);
    end_weight_ = compliance * (half_cell + free * ScalarTraits<Scalar>::from(0.5));
    Scalar pulled{};
    Scalar pushed{};
    for (std::size_t i = 0; i < Nodes; ++i) {
      low_[i] = decay(eta * kPlaces[i]);
      high_[i] = kOne / low_[i];
      pulled_[i] = pulled += weight(i) * low_[i];
      pushed_[i] = pushed += weight(i) * high_[i];
    }
    even_out(tension);
  }
  /// The same tension everywhere, as if newly made.
  constexpr void even_out(Scalar tension) {
    tension_.fill(tension);
    find_limits();
  }

  /// What the elongation would be with another tension at the input end; changes nothing.
  [[nodiscard]] constexpr auto trial(Scalar input) const -> Stretch {
    const std::size_t last = first_held(input) - 1;  // that moves
    const Scalar slope = pulls(input) ? pulled_[last] : pushed_[last];
    return {behind_[last] + input * slope, slope};
  }

  /// Takes the input end to a tension. Returns whether every place has moved.
  constexpr auto pull_to(Scalar input) -> bool {
    const bool pulled = pulls(input);
    const std::size_t held = first_held(input);
    const Places& share = pulled ? low_ : high_;
    const Places& along = pulled ? pulled_ : pushed_;
    Places& near = pulled ? up_ : down_;
    Places& far = pulled ? down_ : up_;
    const Scalar elongation = behind_[held - 1] + input * along[held - 1];
    for (std::size_t i = 1; i < held; ++i) {
      const Scalar tension = input * share[i];
      tension_[i] = tension;
      near[i] = input;
      far[i] = tension * share[i];
      behind_[i - 1] = elongation - input * along[i - 1];
    }
    tension_[0] = input;
    return held == Nodes;
  }

  /// The tendon moves over its guides: each place goes a share of the way to the tension that it has while all of it
  /// slides after a pull or a push at the input end.
  /// @return false if a tension met the end of its range
  constexpr auto slide(bool pulled, typename ScalarTraits<Scalar>::Gain share) -> bool {
    const Places& of_input = pulled ? low_ : high_;
    for (std::size_t i = 1; i < Nodes; ++i) {
      tension_[i] = ScalarTraits<Scalar>::between(tension_[i], input() * of_input[i], share);
    }
    find_limits();
    // The last place's is the largest of a push.
    return pulled || !ScalarTraits<Scalar>::is_saturated(input() * high_[Nodes - 1]);
  }

  /// Elongation per tension of the input end, while all of the tendon slides after a pull or a push there.
  [[nodiscard]] constexpr auto pulled() const -> Scalar { return pulled_[Nodes - 1]; }
  [[nodiscard]] constexpr auto pushed() const -> Scalar { return pushed_[Nodes - 1]; }

  /// The tendon slides, or is about to, in its whole length: the output end's tension hangs on the input end's.
  [[nodiscard]] constexpr auto is_active() const -> bool {
    return up_[Nodes - 1] <= input() || input() <= down_[Nodes - 1];
  }

  [[nodiscard]] constexpr auto input() const -> Scalar { return tension_[0]; }
  [[nodiscard]] constexpr auto output() const -> Scalar { return tension_[Nodes - 1]; }

 private:
  using Places = std::array<Scalar, Nodes>;
  /// phi of each place.
  static constexpr Places kPlaces = [] {
    Places places{};
    for (std::size_t i = 0; i < Nodes; ++i) {
      places[i] = ScalarTraits<Scalar>::from(static_cast<double>(i) / static_cast<double>(Nodes - 1));
    }
    return places;
  }();

  [[nodiscard]] constexpr auto pulls(Scalar input) const -> bool { return tension_[0] < input; }
  /// The first place, 1 to Nodes, that keeps its tension while the input end comes to another.
  [[nodiscard]] constexpr auto first_held(Scalar input) const -> std::size_t {
    std::size_t i = 1;
    if (pulls(input)) {
      while (i < Nodes && up_[i] < input) {
        ++i;
      }
    } else {
      while (i < Nodes && input < down_[i]) {
        ++i;
      }
    }
    return i;
  }
  [[nodiscard]] constexpr auto weight(std::size_t i) const -> Scalar {
    return 0 < i && i + 1 < Nodes ? inner_weight_ : end_weight_;
  }
  /// What else follows from the tensions.
  constexpr void find_limits() {
    Scalar behind{};
    for (std::size_t i = Nodes; i-- > 0;) {
      behind_[i] = behind;
      behind += weight(i) * tension_[i];
      down_[i] = tension_[i] * low_[i];
      up_[i] = tension_[i] * high_[i];
    }
  }

  Places low_{};  ///< tension per input tension while friction holds all it can against a pull
  Places high_{};
  Places pulled_{};  ///< elongation from the input end to here per input tension while it all slides after a pull
  Places pushed_{};
  Places tension_{};
  Places down_{};  ///< a place keeps its tension as long as the input's is within these
  Places up_{};
  Places behind_{};        ///< elongation of all that is behind a place
  Scalar inner_weight_{};  ///< in the elongation, of a place between the ends
  Scalar end_weight_{};
};

}  // namespace capstan
