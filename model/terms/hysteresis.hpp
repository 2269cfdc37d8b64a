// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/model/term.hpp"
#include "capstan/model/weighted_sum.hpp"

namespace capstan {

/// What lies between the motor and the ratio: a sum of play operators (Prandtl-Ishlinskii),
///   h = q1 + sum_i w_i (P_i - q1),   P_i <- clamp(P_i, q1 - r_i, q1 + r_i)
/// One play of weight 1 is a gap of 2 r; several of them round its knee, as presliding friction and a sheath do, and
/// two hystereses in a row are a sum of this kind too (Krejci 1996). Right after a reversal h moves by 1 - sum w_i of
/// the motor's way, so a joint that never runs against its motor has weights that add up to 1 at most.
/// Six plays: on the measured angle logs a seventh lowered the error on unseen rows nowhere by more than
/// 2 % (greedy choice among 40 widths on the first 60 % of each of 13 logs, November 2026); two to four did most.
template <typename Scalar>
class Hysteresis {
 public:
  static constexpr std::size_t kPlays = 6;
  static constexpr double kMostHalfWidthRad = 60.0;  ///< so that a gap fits fixed point
  static constexpr double kMostWeight = 2.0;

  static constexpr auto width(const char* name, std::int8_t weight) -> ShapeInfo {
    return {name,
            "rad",
            1e-6,
            kMostHalfWidthRad,
            0.02,
            "half the gap of a play, at the motor",
            ShapeScale::kRatio,
            ShapeOf::kMotorRange,
            weight};
  }
  static constexpr auto weight(const char* name, std::int8_t own) -> ShapeInfo {
    return {name,
            "1",
            -kMostWeight,
            kMostWeight,
            0.0,
            "share of the motion that passes it; 0: no such play",
            ShapeScale::kPeriods,
            ShapeOf::kNothing,
            own};
  }
  static constexpr TermInfo<0, 2 * kPlays> kInfo = {
      .name = "hysteresis",
      .equation = "h = q1 + sum_i w_i (play(q1, r_i) - q1), which then stands for q1 in front of the ratio",
      .source = "Prandtl-Ishlinskii operator of plays; Krejci 1996, Kuhnen 2003",
      .confusable_with = "play, presliding, tendon_elongation where the torque hardly varies",
      .exciting_motion = "loops within loops: reversals from amplitudes below the smallest gap to beyond the largest",
      .coefficients = {},
      .shapes = {{width("half_width_1", 1), weight("weight_1", 1), width("half_width_2", 3), weight("weight_2", 3),
                  width("half_width_3", 5), weight("weight_3", 5), width("half_width_4", 7), weight("weight_4", 7),
                  width("half_width_5", 9), weight("weight_5", 9), width("half_width_6", 11), weight("weight_6", 11)}},
      .relations = {.doubles = {"play", "presliding", "tendon_elongation", "slip_propagation"},
                    .special_cases = {"play", "presliding"},
                    .shown_by = Motion::kLoops | Motion::kSmall,
                    .placed = true},
  };

  constexpr Hysteresis(SamplePeriod<Scalar> /*dt*/, const std::array<Scalar, 2 * kPlays>& shape) {
    WeightedSum<Scalar> all;
    for (std::size_t i = 0; i < kPlays; ++i) {
      const Scalar half = clamp(shape[2 * i], Scalar{}, kMostHalf);
      const Scalar weight = clamp(shape[2 * i + 1], -kMost, kMost);
      if (half != Scalar{} && weight != Scalar{}) {  // what does nothing costs nothing
        plays_[count_++] = {half, half + half, weight, half};
        all.add(weight, half);
      }
    }
    steady_lag_ = all.value();
  }
  [[nodiscard]] constexpr auto is_on() const -> bool { return count_ > 0; }
  constexpr void restart() {
    started_ = false;
    for (std::size_t i = 0; i < count_; ++i) {
      plays_[i].place = plays_[i].half;
    }
  }

  constexpr auto update(const Sample<Scalar>& s) -> Scalar {
    const Scalar step = started_ ? s.h - before_ : Scalar{};
    started_ = true;
    before_ = s.h;
    WeightedSum<Scalar> lag;
    for (std::size_t i = 0; i < count_; ++i) {
      One& play = plays_[i];
      play.place = clamp(play.place - step, Scalar{}, play.gap);
      lag.add(play.weight, play.place - play.half);
    }
    return s.h + lag.value();
  }
  /// Every play trails by its half width.
  [[nodiscard]] constexpr auto steady_state(const Sample<Scalar>& s) const -> Scalar {
    return s.forward ? s.h - steady_lag_ : s.h + steady_lag_;
  }
  [[nodiscard]] constexpr auto undone(Scalar h, bool forward) const -> Scalar {
    return forward ? h + steady_lag_ : h - steady_lag_;
  }

 private:
  static constexpr Scalar kMostHalf = ScalarTraits<Scalar>::from(kMostHalfWidthRad);
  static constexpr Scalar kMost = ScalarTraits<Scalar>::from(kMostWeight);

  struct One {
    Scalar half{};
    Scalar gap{};
    Scalar weight{};
    Scalar place{};  ///< P - q1 + r, from 0 to the gap
  };
  std::array<One, kPlays> plays_{};
  std::size_t count_ = 0;
  Scalar steady_lag_{};  ///< sum w_i r_i
  Scalar before_{};
  bool started_ = false;
};

}  // namespace capstan
