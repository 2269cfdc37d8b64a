// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/firmware/parameters/config.hpp"
#include "capstan/model/force_estimate.hpp"
#include "capstan/model/sample.hpp"
#include "capstan/model/turn_play.hpp"

namespace capstan {

/// How far the joint may be from its estimate in this cycle. The logs that the law was made of tell it in two numbers,
/// one near a reversal, where hysteresis is being crossed, and one beyond. It is told only where those logs have been:
/// within their motor angles and torques, and from the first turn at the end of a longer way on. Before that the joint
/// hangs on a motion that nobody saw: a measured catheter is off by 0.18 rad on its first stroke, 0.005 rad later.
class ErrorBar {
 public:
  static constexpr Q24 kUnknown = Q24::from_int(-1);  ///< no half width of an interval: nobody takes it for a small one

  /// The law's memory begins anew.
  void rt_forget() { *this = {}; }
  /// @returns half width of the interval that holds 95 of 100 samples, rad, or kUnknown
  auto rt_step(const ErrorBarConfig& config, const Sample<Q24>& now) -> Q24 {
    const bool turning = abs(now.q1 - now.q1_reversal) < config.turn_rad;
    settled_ = settled_ || (gone_ && now.q1_reversal != began_);
    if (!gone_) {
      began_ = now.q1_reversal;
      gone_ = !turning;
    }
    const bool seen = config.from_rad <= now.q1 && now.q1 <= config.to_rad && abs(now.tau) <= config.torque_nm;
    if (!settled_ || !seen || config.steady_rad == Q24{}) {
      return kUnknown;
    }
    return turning ? config.turning_rad : config.steady_rad;
  }

 private:
  bool gone_ = false;  ///< a way of at least `turn` since the law's memory began
  Q24 began_{};        ///< where that way began
  bool settled_ = false;
};

/// The same of the joint's torque: near a reversal of the motor's torque and beyond. Told where the law's past no
/// longer matters, within the torques of its logs.
class ForceErrorBar {
 public:
  /// @param motor_nm  the motor's torque   @returns half width of the interval, N m, or ErrorBar::kUnknown
  auto rt_step(const ForceErrorConfig& config, Q24 motor_nm, const ForceEstimate<Q24>& now) -> Q24 {
    const bool turning = play_.update(motor_nm, config.turn_nm);
    if (!now.known || now.saturated || now.beyond_table || abs(motor_nm) > config.torque_nm ||
        config.steady_nm == Q24{}) {
      return ErrorBar::kUnknown;
    }
    return turning ? config.turning_nm : config.steady_nm;
  }

 private:
  TurnPlay<Q24> play_;
};

}  // namespace capstan
