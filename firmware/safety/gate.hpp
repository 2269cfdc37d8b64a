// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/firmware/control/modes.hpp"

namespace capstan {

/// The one gate that every output of a joint passes: permission, thermal and peak current, tendon travel, rate.
class Gate {
 public:
  explicit Gate(const AxisConfig& config) : scales_(config) {}
  void rt_configure(const AxisConfig& config) { scales_ = Scales(config); }
  /// @param energised  the supervisor's permission; without it the drive is off and the rate begins at zero again
  /// @param dither_nm  an experiment's own torque, on top
  /// @param look_a  the motor observer's look
  auto rt_step(const LimitConfig& limits, const MotorState& motor, Q24 torque_nm, bool energised, Q24 dither_nm = Q24{},
               Q24 look_a = Q24{}) -> AxisDrive;
  /// The next torque rises from zero.
  void rt_restart() { drive_a_ = drive_nm_ = wanted_a_ = servo_a_ = Q24{}; }
  /// Of the winding, which the gate can not rule because it is not the gate's current that heats it.
  [[nodiscard]] auto faults() const -> FaultSet { return heat_ > kTooHot ? bit(Fault::kWindingHot) : 0; }
  /// Of the winding, 1 = what the continuous current leads to.
  [[nodiscard]] auto heat() const -> Q24 { return heat_; }
  /// As after a run that ended with this heat.
  void begin_at_heat(Q24 heat);
  /// What was met in the last step.
  [[nodiscard]] auto limits() const -> LimitSet { return met_; }
  /// Current that was wanted in the last step, A.
  [[nodiscard]] auto drive_a() const -> Q24 { return drive_a_; }
  /// The motor's torque of that, N m.
  [[nodiscard]] auto drive_nm() const -> Q24 { return drive_nm_; }

 private:
  // The gate brings the current down to the continuous one at a heat of 1, so more than noise above that is a current
  // that the gate does not rule.
  static constexpr Q24 kTooHot = Q24::from_double(1.25);

  /// What follows from the parameters, so that the cycle divides nothing.
  struct Scales {
    explicit Scales(const AxisConfig& config);
    Q24 torque_constant_nm_per_a;
    Reciprocal<Q24> per_torque_constant;
    Reciprocal<Q24> per_continuous_current;
    Q30 thermal_gain;
    Q24 rate_a_per_cycle;  // limits.current_rate, or less where the observer asks for it
  };
  // Each is called once, in every cycle.
  [[gnu::always_inline]] inline void rt_update_i2t(Q24 current_a);
  [[gnu::always_inline]] inline auto rt_limit_rate(Q24 wanted_a) -> Q24;
  void rt_flag(Limit limit) { met_ = static_cast<LimitSet>(met_ | bit(limit)); }

  Scales scales_;
  Q24 heat_;
  bool hot_ = false;
  LimitSet met_ = 0;
  Q24 drive_a_;
  Q24 drive_nm_;
  Q24 wanted_a_;  // without the dither: before the rate limit,
  Q24 servo_a_;   // and after it
};

}  // namespace capstan
