// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

#include "capstan/model/exponential.hpp"

namespace capstan {

/// The tension along one tendon at `Nodes` places, ends included, in torque at the motor (tension times r1). A place
/// keeps its tension as long as the input end's stays within the factor that friction holds there: that is the moving
/// slip front, (2.6) and (2.7), exact at the places. Between them tension goes by e^(-eta phi) one way or the other,
/// and the sum below is exact for both.
/// Elongations are in the compliance's unit times N m.
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
    weight_ = compliance * (half_cell + half_cell);
    end_weight_ = compliance * (half_cell + free * ScalarTraits<Scalar>::from(0.5));
    for (std::size_t i = 0; i < Nodes; ++i) {
      places_[i].low = decay(eta * kPlaces[i]);
      places_[i].high = kOne / places_[i].low;
    }
    even_out(tension);
  }
  /// The same tension everywhere, as if newly made.
  constexpr void even_out(Scalar tension) {
    for (Place& place : places_) {
      place.tension = tension;
      place.down = tension * place.low;
      place.up = tension * place.high;
    }
  }

  /// What the elongation would be with another tension at the input end; changes nothing.
  [[nodiscard]] constexpr auto trial(Scalar input) const -> Stretch {
    Parts inside;
    Parts ends{Scalar{}, ScalarTraits<Scalar>::from(1.0)};  // the input end moves
    const auto add = [&](Parts & parts, const Place& place) __attribute__((always_inline)) {
      if (place.up < input) {
        parts.slope += place.low;
      } else if (input < place.down) {
        parts.slope += place.high;
      } else {
        parts.held += place.tension;
      }
    };
    for (std::size_t i = 1; i + 1 < Nodes; ++i) {
      add(inside, places_[i]);
    }
    add(ends, places_[Nodes - 1]);
    const Scalar slope = inside.slope * weight_ + ends.slope * end_weight_;
    return {inside.held * weight_ + ends.held * end_weight_ + input * slope, slope};
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

  /// The tendon moves over its guides: each place goes a share of the way to the tension that it has while all of it
  /// slides after a pull or a push at the input end.
  /// @return false if a tension met the end of its range
  constexpr auto slide(bool pulled, typename ScalarTraits<Scalar>::Gain share) -> bool {
    Scalar sliding{};
    for (std::size_t i = 1; i < Nodes; ++i) {
      Place& place = places_[i];
      sliding = input() * (pulled ? place.low : place.high);
      place.tension = ScalarTraits<Scalar>::between(place.tension, sliding, share);
      place.down = place.tension * place.low;
      place.up = place.tension * place.high;
    }
    return !ScalarTraits<Scalar>::is_saturated(sliding);  // the last place's is the largest of a push
  }

  /// Elongation per tension of the input end, while all of the tendon slides after a pull or a push there.
  [[nodiscard]] constexpr auto pulled() const -> Scalar { return sum(&Place::low); }
  [[nodiscard]] constexpr auto pushed() const -> Scalar { return sum(&Place::high); }

  /// The tendon slides, or is about to, in its whole length: the output end's tension hangs on the input end's.
  [[nodiscard]] constexpr auto is_active() const -> bool {
    return places_[Nodes - 1].up <= input() || input() <= places_[Nodes - 1].down;
  }

  [[nodiscard]] constexpr auto input() const -> Scalar { return places_[0].tension; }
  [[nodiscard]] constexpr auto output() const -> Scalar { return places_[Nodes - 1].tension; }

 private:
  /// Held tensions, and how many input tensions the places have that move.
  struct Parts {
    Scalar held{};
    Scalar slope{};
  };
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

  [[nodiscard]] constexpr auto sum(Scalar Place::*share) const -> Scalar {
    Scalar inner{};
    for (std::size_t i = 1; i + 1 < Nodes; ++i) {
      inner += places_[i].*share;
    }
    return inner * weight_ + (places_[0].*share + places_[Nodes - 1].*share) * end_weight_;
  }

  std::array<Place, Nodes> places_{};
  Scalar weight_{};      ///< in the elongation, of a place between the ends
  Scalar end_weight_{};  ///< of either end
};

}  // namespace capstan
