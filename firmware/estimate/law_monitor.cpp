// SPDX-License-Identifier: Apache-2.0
#include "capstan/firmware/estimate/law_monitor.hpp"

#include "capstan/model/exponential.hpp"

namespace capstan {
namespace {

/// mean / expected^2 in Q24, where both are raw squares.
auto ratio_of(std::int64_t mean, Q24 expected) -> Q24 {
  const std::int64_t scale = std::int64_t{expected.raw()} * expected.raw();
  constexpr std::int64_t kMost = std::int64_t{100} << Q24::kFrac;
  // Both lose the same bits where the quotient would not fit.
  const int shift = mean > (std::int64_t{1} << 38) ? 24 : 0;
  const std::int64_t below = std::max<std::int64_t>(scale >> shift, 1);
  const std::int64_t above = mean >> shift;
  return above / below >= 100 ? Q24::from_wide(kMost) : Q24::from_wide((above << Q24::kFrac) / below);
}

/// The largest u with -ln(1 - u) <= c u, from below: u <- 1 - e^(-c u) rises to it.
auto root_of(Q24 c) -> Q24 {
  constexpr Q24 kOne = Q24::from_int(1);
  Q24 u = kOne - kOne / c;
  for (int i = 0; i < 24; ++i) {
    u = kOne * share_gone(c * u, kOne);
  }
  return u;
}

}  // namespace

void LawMonitor::rt_configure(const MonitorConfig& config) {
  *this = LawMonitor{};
  watches_ = config.joint_rms_rad > Q24{} || config.torque_rms_nm > Q24{};
  const Q24 theta = root_of(config.excess * config.excess) * Q24::from_double(0.5);
  threshold_ = Q24::from_double(kLogStretches) / theta;
}

void LawMonitor::rt_step(const MonitorConfig& config, const ControlConfig& control, const Input& now) {
  if (!is_due(now.q1_rad)) {
    return;
  }
  last_q1_ = now.q1_rad;
  if (settled_ < kUnsettled) {
    ++settled_;
    return;
  }
  const bool sensed = now.has_joint && config.joint_rms_rad > Q24{};
  constexpr Q24 kMost = Q24::from_int(1);  // 256 squares of it fit
  const std::int64_t error = sensed ? clamp(now.joint_error_rad, -kMost, kMost).raw() : 0;
  if (sensed && count_ < kStretch) {
    squares_ += error * error;
    ++count_;
  }
  if (abs(now.q1_rad - now.q1_reversal_rad) > config.settle_rad) {
    Side& side = sides_[now.forward ? 1 : 0];
    side.torque += (now.tau_nm - (now.forward ? control.torque_forward_nm : control.torque_backward_nm)).raw();
    const std::int64_t lead = now.joint_lead_rad.raw();  // wider, for it is negated
    side.lead += now.crossed ? -lead : lead;
    side.error += now.crossed ? -error : error;
    side.sensed += sensed ? 1 : 0;
    ++side.count;
  }
}

void LawMonitor::rt_judge(const AxisConfig& config) {
  if (count_ == kStretch) {
    rt_sensor_stretch(config.monitor);
  } else if (sides_[0].count >= kSteadyStretch && sides_[1].count >= kSteadyStretch) {
    rt_steady_stretch(config);
  }
}

void LawMonitor::rt_sensor_stretch(const MonitorConfig& config) {
  rt_weigh(sensor_, config.excess, ratio_of(squares_ / kStretch, config.joint_rms_rad), Warning::kLawMisfit);
  squares_ = 0;
  count_ = 0;
}

void LawMonitor::rt_steady_stretch(const AxisConfig& config) {
  const auto& [back, forth] = sides_;
  // Half of what differs between the two ways, and the middle of both.
  const auto half_of = [](std::int64_t forward, std::int64_t backward) {
    return Q24::from_wide((forward - backward) / 2);
  };
  const Q24 more = half_of(forth.torque / forth.count, back.torque / back.count);
  if (config.monitor.torque_rms_nm > Q24{}) {
    rt_weigh(friction_, config.monitor.excess,
             ratio_of(std::int64_t{more.raw()} * more.raw(), config.monitor.torque_rms_nm),
             more > Q24{} ? Warning::kFrictionHigher : Warning::kFrictionLower);
  }
  const std::int64_t error_forth = forth.error / forth.count;
  const std::int64_t error_back = back.error / back.count;
  const Q24 healthy = half_of(config.control.torque_forward_nm.raw(), config.control.torque_backward_nm.raw());
  tendons_.rt_judge(config.monitor,
                    {.friction_nm = healthy + more,
                     .healthy_nm = healthy,
                     .motors_nm = config.observer.coulomb_nm,
                     .loop_rad = -half_of(forth.lead / forth.count, back.lead / back.count),
                     .has_joint = forth.sensed == forth.count && back.sensed == back.count,
                     .wider_rad = -half_of(error_forth, error_back),  // the joint is behind on either way
                     .shifted_rad = half_of(error_forth, -error_back)},
                    warnings_);
  sides_ = {};
}

void LawMonitor::rt_weigh(Test& test, Q24 excess, Q24 mean_square, Warning warning) {
  test.level = clamp(test.level + (mean_square - excess * excess), Q24{}, threshold_);
  test.share = test.level / threshold_;
  if (test.level >= threshold_) {
    warnings_ |= bit(warning);
  }
}

}  // namespace capstan
