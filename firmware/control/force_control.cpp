// SPDX-License-Identifier: Apache-2.0
#include "capstan/firmware/control/force_control.hpp"
#include "capstan/firmware/loop/expect.hpp"

namespace capstan {
namespace {

constexpr SamplePeriod<Q24> kPeriod{kCycleRateHz};

}  // namespace

void ForceControl::rt_configure(const ForceConfig& config) {
  law_.become({.kind = static_cast<ForceLawKind>(config.law),
               .pull_push = {.eta_top = config.eta_top,
                             .eta_bottom = config.eta_bottom,
                             .pretension_nm = config.pretension_nm,
                             .ratio = config.ratio,
                             .pull_weight = config.pull_weight,
                             .pull_push_weight = config.pull_push_weight},
               .friction_nm = config.friction_nm,
               .offset_nm = config.offset_nm},
              config.grid);
  estimate_ = {};
}

void ForceControl::rt_observe(Q24 motor_nm) {
  estimate_ = law_.update(motor_nm);
}

void ForceControl::rt_start(Q24 motor_nm) {
  wanted_ = extreme_ = estimate_.force;
  aim_ = motor_nm;
  rest_ = Q24{};
  jumps_ = true;
  out_of_reach_ = false;
}

void ForceControl::rt_aim(Q24 goal_nm, Q24 rate_nm_per_s) {
  goal_ = goal_nm;
  rate_nm_per_s_ = rate_nm_per_s;
}

/// The direction of what is wanted, with a play so that a noisy stream does not turn it.
void ForceControl::rt_turn(Q24 threshold_nm) {
  const Q24 beyond = rising_ ? wanted_ - extreme_ : extreme_ - wanted_;
  if (beyond >= Q24{}) {
    extreme_ = wanted_;
  } else if (-beyond > threshold_nm) {
    rising_ = !rising_;
    extreme_ = wanted_;
    jumps_ = true;
  }
}

auto ForceControl::rt_update(const ForceConfig& config) -> Q24 {
  CAPSTAN_EXPECT(has_law());
  const Q24 step = per_cycle(rate_nm_per_s_);
  wanted_ = clamp(goal_, wanted_ - step, wanted_ + step);
  rt_turn(config.threshold_nm);
  const bool ahead = rising_ ? wanted_ > estimate_.force : wanted_ < estimate_.force;
  if (ahead) {
    const Q24 before = aim_ + rest_;
    const InputCommand<Q24> solved = law_.torque_for(wanted_, rising_);
    aim_ = solved.input;
    out_of_reach_ = !solved.reachable;
    rest_ = jumps_ ? before - aim_ : rest_;
    jumps_ = false;
  }
  rest_ -= rest_ * kPeriod.filter_gain(config.reversal_time_s);
  return aim_ + rest_;
}

}  // namespace capstan
