// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/tools/response/loop.hpp"

namespace capstan::tools {

/// The motor servo of a travelling joint, run cycle by cycle: the encoder's steps, the control and the board's own
/// gate, whose limit of the current's rate no describing function of a pure sine has. Each step of the encoder is a
/// step of the torque that grows with the gains; where that is as large as the gate lets through in a cycle, the gate
/// cuts what the damping asks for, and the loop swings sooner than without it, and slower.
class LoopInTime {
 public:
  /// @param gains  those that are scaled   @param joint  joint angle per motor angle, positive
  /// @param friction_nm  of a steady motion: a motor that swings faster than its way turns it
  LoopInTime(const MotorModel& model, const LoopGains& gains, double joint, double friction_nm);
  /// Bends lag and inertia so that the motor's response is `value` there.
  void bend(double hz, Complex value);

  /// The model that runs: its delay in whole steps, and no less than the half cycle that a torque is held.
  [[nodiscard]] auto model() const -> const MotorModel& { return model_; }

  /// How the motor swings about its way.
  struct Swing {
    double speed_rad_s = 0.0, hz = 0.0;
  };
  /// With that multiple of the gains, once what the start leaves has died away; most of the time, for bursts come
  /// sooner. A frequency of 0: it runs away.
  [[nodiscard]] auto at(double factor, double way_rad_s) const -> Swing;
  /// It swings by more than half of its way's speed: below that, nothing holds a swing at a size of its own.
  [[nodiscard]] auto swings(double factor, double way_rad_s) const -> bool {
    return at(factor, way_rad_s).speed_rad_s > 0.5 * way_rad_s;
  }

 private:
  enum Number : Eigen::Index { kTorque, kAngle, kSpeed, kJointAngle, kJointSpeed, kInput, kNumbers };
  using State = Eigen::Matrix<double, kNumbers, 1>;
  using Step = Eigen::Matrix<double, kNumbers, kNumbers>;

  [[nodiscard]] auto step() const -> Step;

  MotorModel model_;
  LoopGains gains_;
  double joint_, friction_nm_;
  int late_ = 0;  ///< steps beyond the hold
  Step step_;
};

}  // namespace capstan::tools
