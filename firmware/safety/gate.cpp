// SPDX-License-Identifier: Apache-2.0
#include "capstan/firmware/safety/gate.hpp"

#include "capstan/firmware/safety/motor_observer.hpp"

namespace capstan {
namespace {

constexpr SamplePeriod<Q24> kPeriod{kCycleRateHz};
constexpr Q24 kOne = Q24::from_int(1);
// Heat at which the peak current is allowed again. At the continuous current it stays at 1, so without a gap between
// the two the limit would come and go with the sensor's noise.
constexpr Q24 kCool = Q24::from_double(0.9);
// In each cycle. November 2026: with 0.5 forceps 689 swings, with 0.25 and 0.125 it does not.
constexpr Q24 kCatchUpShare = Q24::from_double(0.25);

/// True for a current that pulls further out where the tendon travel ends. In motor space, because that is where
/// tendons break.
auto pulls_outward(const LimitConfig& limits, Q24 q1_rad, Q24 current_a) -> bool {
  return (q1_rad >= limits.motor_max_rad && current_a > Q24{}) || (q1_rad <= limits.motor_min_rad && current_a < Q24{});
}

}  // namespace

Gate::Scales::Scales(const AxisConfig& config)
    : torque_constant_nm_per_a(config.motor.torque_per_current_nm_per_a),
      per_torque_constant(config.motor.torque_per_current_nm_per_a),
      per_continuous_current(config.limits.continuous_current_a),
      thermal_gain(kPeriod.filter_gain(config.limits.thermal_time_s)),
      rate_a_per_cycle(std::min(config.limits.current_rate_a_per_cycle, MotorObserver::slew_limit(config))) {}

void Gate::begin_at_heat(Q24 heat) {
  heat_ = heat;
  hot_ = heat_ >= kCool;
}

void Gate::rt_update_i2t(Q24 current_a) {
  const Q24 load = current_a * scales_.per_continuous_current;
  heat_ += (load * load - heat_) * scales_.thermal_gain;
  hot_ = heat_ >= (hot_ ? kCool : kOne);
}

/// Follows the wish where its rate allows. Where it does not, the change of the wish counts first and the distance to
/// it a kCatchUpShare only: a limiter that heads for the wish itself goes on rising while the wish already falls, up to
/// a quarter of a period late, and a servo whose damping comes that late swings ever wider (rate-limited oscillation;
/// drawn forceps 689 of tools/plant_benchmark --health, in `commission`).
auto Gate::rt_limit_rate(Q24 wanted_a) -> Q24 {
  const Q24 step = scales_.rate_a_per_cycle;
  const Q24 change = wanted_a - wanted_a_;
  const Q24 behind = wanted_a - servo_a_;
  wanted_a_ = wanted_a;
  if (abs(behind) <= step) {
    return wanted_a;
  }
  return servo_a_ + clamp(change + behind * kCatchUpShare, -step, step);
}

auto Gate::rt_step(const LimitConfig& limits, const MotorState& motor, Q24 torque_nm, bool energised, Q24 dither_nm,
                   Q24 look_a) -> AxisDrive {
  met_ = 0;
  rt_update_i2t(motor.current_a);
  if (!energised) {
    rt_restart();
    return {};
  }
  Q24 wanted = torque_nm * scales_.per_torque_constant;
  if (pulls_outward(limits, motor.q1_rad, wanted)) {
    rt_flag(Limit::kMotorTravel);
    wanted = Q24{};
  }
  const Q24 peak = hot_ ? limits.continuous_current_a : limits.current_a;
  if (abs(wanted) > peak) {
    rt_flag(hot_ ? Limit::kThermal : Limit::kCurrent);
    wanted = clamp(wanted, -peak, peak);
  }
  if (look_a != Q24{}) {  // on the limited torque: beyond the limit the wish hides a look that takes torque away
    wanted = clamp(wanted + look_a, -peak, peak);
  }
  servo_a_ = rt_limit_rate(wanted);
  wanted = clamp(servo_a_ + dither_nm * scales_.per_torque_constant, -peak, peak);
  const Q24 step = scales_.rate_a_per_cycle;
  Q24 gated = clamp(wanted, drive_a_ - step, drive_a_ + step);
  if (gated != wanted || servo_a_ != wanted_a_) {
    rt_flag(Limit::kRate);
  }
  // The rate limit may delay a torque, never its removal.
  gated = pulls_outward(limits, motor.q1_rad, gated) ? Q24{} : clamp(gated, -peak, peak);
  drive_a_ = gated;
  drive_nm_ = gated * scales_.torque_constant_nm_per_a;
  return {.current_a = gated, .enabled = true};
}

}  // namespace capstan
