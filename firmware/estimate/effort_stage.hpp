// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/firmware/estimate/motor_sensing.hpp"

namespace capstan {

/// The effort law of one joint: the torque that its motion takes, for feedforward, and what the measured torque is
/// beside it.
class EffortStage {
 public:
  explicit EffortStage(const EffortConfig& config);
  /// The law anew, and its memory. In place, as a motion law.
  void rt_make_law(const EffortConfig& config);
  void rt_forget() { disturbance_.restart(); }
  /// There is no joint here.
  void rt_absent();
  /// @param temperature_c  the last that was measured, or the mark of a missing value
  /// @returns not known, and nothing, without a law, while a sensor fails, and after either until the window is full
  auto rt_step(const MotorState& motor, Q24 temperature_c) -> const DisturbanceEstimate<Q24>&;

  [[nodiscard]] auto has_law() const -> bool { return disturbance_.law().is_on(); }
  /// For control; nullptr: its feedforward is that of a steady motion.
  [[nodiscard]] auto feedforward(const EffortConfig& config) const -> const TorqueLaw<Q24>* {
    return has_law() && config.feedforward != 0 ? &disturbance_.law() : nullptr;
  }
  [[nodiscard]] auto estimate() const -> const DisturbanceEstimate<Q24>& { return estimate_; }

 private:
  Disturbance<Q24> disturbance_;
  DisturbanceEstimate<Q24> estimate_;
};

}  // namespace capstan
