// SPDX-License-Identifier: Apache-2.0
#include "capstan/firmware/estimate/effort_stage.hpp"

#include <memory>

namespace capstan {
namespace {

constexpr SamplePeriod<Q24> kPeriod{kCycleRateHz};

}  // namespace

EffortStage::EffortStage(const EffortConfig& config) : disturbance_(kPeriod, config.law, config.view) {}

void EffortStage::rt_make_law(const EffortConfig& config) {
  std::construct_at(&disturbance_, kPeriod, config.law, config.view);
  estimate_ = {};
}

void EffortStage::rt_absent() {
  if (has_law()) {
    rt_forget();
    estimate_ = {};
  }
}

auto EffortStage::rt_step(const MotorState& motor, Q24 temperature_c) -> const DisturbanceEstimate<Q24>& {
  if (!has_law()) {
    return estimate_;
  }
  if (motor.faults != 0) {
    rt_absent();  // samples on both sides of a gap are no motion
    return estimate_;
  }
  return estimate_ = disturbance_.update({.q1 = motor.q1_rad, .tau = motor.tau_nm, .temperature = temperature_c});
}

}  // namespace capstan
