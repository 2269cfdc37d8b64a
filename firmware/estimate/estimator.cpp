// SPDX-License-Identifier: Apache-2.0
#include "capstan/firmware/estimate/estimator.hpp"

#include <memory>

namespace capstan {
namespace {

constexpr SamplePeriod<Q24> kPeriod{kCycleRateHz};

}  // namespace

Estimator::Estimator(const AxisConfig& config) : law_(kPeriod, config.law), monitor_(config.monitor) {}

void Estimator::rt_make_law(const LawParameters<Q24>& parameters) {
  std::construct_at(&law_, kPeriod, parameters);
  estimate_.joint_torque = {};
  error_bar_.rt_forget();
}

auto Estimator::rt_step(const AxisConfig& config, const MotorState& motor, const LawInput& input)
    -> const JointEstimate& {
  estimate_.valid = false;
  estimate_.faults = 0;
  estimate_.error_bar_rad = ErrorBar::kUnknown;
  if (input.faults != 0) {
    estimate_.faults = input.faults & bit(Fault::kModelInvalid);  // any other is the sensor's own
    return estimate_;
  }
  const Estimate<Q24> estimate = law_.update(input.measured);
  estimate_.q2_rad = estimate.q2;
  estimate_.q2_reported_rad = estimate.q2_reported;
  if (law_.has_tendons()) {
    estimate_.joint_torque = law_.joint_torque();
  }
  estimate_.valid = !estimate.saturated;
  if (estimate.saturated) {
    estimate_.faults = bit(Fault::kEstimatorRange);
    return estimate_;
  }
  estimate_.error_bar_rad = error_bar_.rt_step(config.error_bar, law_.sample());
  if (monitor_.is_due(motor.q1_rad)) {
    rt_monitor(config, motor);
  }
  return estimate_;
}

void Estimator::rt_monitor(const AxisConfig& config, const MotorState& motor) {
  const Sample<Q24>& sample = law_.sample();
  monitor_.rt_step(config.monitor, config.control,
                   {.q1_rad = sample.q1,
                    .q1_reversal_rad = sample.q1_reversal,
                    .tau_nm = sample.tau,
                    .forward = sample.forward,
                    .joint_lead_rad = estimate_.q2_reported_rad - law_.beta() * sample.q1,
                    .has_joint = motor.has_joint,
                    .joint_error_rad = motor.joint_rad - estimate_.q2_reported_rad,
                    .crossed = law_.beta() < Q24{}});
}

}  // namespace capstan
