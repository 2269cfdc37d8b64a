// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "capstan/firmware/parameters/config.hpp"

namespace capstan {

/// How far force control may let a joint go: torque and angle at once, each where it is the smaller demand (hybrid
/// control, thesis 8.2.1). Inside, the joint's torque is what was asked for. At an edge its angle is held, which takes
/// less torque outward than was asked for; as soon as it takes more, for something presses it back, its torque is
/// controlled again. A joint that runs, for nothing withstands it, is brought to the edge ahead as moves go. Angle and
/// torque are the estimates: what the motor does not feel, for the tendons' friction keeps it back, does not press.
class Corridor {
 public:
  /// @param half_rad  of its width, about the joint's angle; 0: there is none
  void rt_lay(Q24 q2_rad, Q24 half_rad) {
    centre_rad_ = q2_rad;
    half_rad_ = bound_rad_ = half_rad;
    edge_ = Edge::kNone;
  }
  /// About the same angle as before; an edge that it no longer has lets go.
  void rt_resize(Q24 half_rad) {
    edge_ = half_rad > half_rad_ ? Edge::kNone : edge_;
    half_rad_ = bound_rad_ = half_rad;
  }
  void rt_lift() { rt_lay(Q24{}, Q24{}); }
  [[nodiscard]] auto is_there() const -> bool { return half_rad_ != Q24{}; }

  /// Of a joint in force control. @returns whether the edge ahead has to take it over: braking at this acceleration, it
  /// just stops inside, or no more. v^2 / (2 a) >= way left, both sides over 32 so that they stay in range.
  auto rt_met(Q24 q2_rad, Q24 speed_rad_s, Q24 acceleration_rad_s2) -> bool {
    constexpr Q24 kEighth = Q24::from_double(0.125);
    constexpr Q24 kOf32 = Q24::from_double(1.0 / 32.0);
    if (!is_there()) {
      return false;
    }
    const Q24 away = q2_rad - centre_rad_;
    if (abs(away) < half_rad_ - half_rad_ * kSlack) {
      bound_rad_ = half_rad_;
    }
    const bool high = away > Q24{};
    const Q24 outward = std::max(high ? speed_rad_s : -speed_rad_s, Q24{}) * kEighth;
    const Q24 left = bound_rad_ - abs(away);
    if (left > Q24{} && outward * outward < acceleration_rad_s2 * kOf32 * left) {
      return false;
    }
    rt_take(high);
    return true;
  }
  /// The edge ahead takes the joint over wherever it is.
  void rt_take(bool high) { edge_ = high ? Edge::kHigh : Edge::kLow; }
  /// Whether an edge holds the joint, or brings it there.
  [[nodiscard]] auto holds() const -> bool { return edge_ != Edge::kNone; }
  [[nodiscard]] auto at_high() const -> bool { return edge_ == Edge::kHigh; }
  /// Where that edge is.
  [[nodiscard]] auto edge_rad() const -> Q24 {
    return edge_ == Edge::kHigh ? centre_rad_ + half_rad_ : centre_rad_ - half_rad_;
  }
  /// Of a joint that an edge holds: it presses outward by more than `margin_nm` beyond what is wanted.
  [[nodiscard]] auto pressed_back(Q24 pressing_nm, Q24 wanted_nm, Q24 margin_nm) const -> bool {
    const Q24 more = pressing_nm - wanted_nm;
    return (edge_ == Edge::kHigh ? more : -more) > margin_nm;
  }
  /// The edge lets go of a joint that is pressed back. It does not hold it again at the same place: the two would take
  /// turns while the torque goes to what is wanted.
  void rt_let_go(Q24 q2_rad) {
    bound_rad_ = std::max(half_rad_, abs(q2_rad - centre_rad_)) + half_rad_ * kSlack;
    edge_ = Edge::kNone;
  }

 private:
  enum class Edge : std::uint8_t { kNone, kLow, kHigh };
  static constexpr Q24 kSlack = Q24::from_double(1.0 / 32.0);  ///< of half the width

  Q24 centre_rad_;
  Q24 half_rad_;
  Q24 bound_rad_;  ///< where the edge holds: at half the width, further out just after it let go
  Edge edge_ = Edge::kNone;
};

}  // namespace capstan
