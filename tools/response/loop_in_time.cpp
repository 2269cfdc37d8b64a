// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/response/loop_in_time.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "capstan/firmware/safety/gate.hpp"
#include "capstan/model/scalar.hpp"

namespace capstan::tools {
namespace {

constexpr int kSteps = 20;  // of a cycle, exact between them: they only round the delay
constexpr double kStepS = kCycleS / kSteps;
constexpr double kLeastLagS = 1e-6, kMostLag = 1.2;  // s; rad that a lag may turn
constexpr int kHalvings = 6, kTaylor = 12;           // of a step's exponential, for the least lag

// Numbers that decide, chosen on 28 November 2026 on the drawn joints 4300 to 4303 of commission_test (forceps, wrist,
// finger, elbow), whose gains were raised until they swung; docs/tuning.md reports other seeds.
constexpr int kStartCycles = 600;   // until what the start leaves has died away
constexpr int kWindowCycles = 100;  // a dozen periods: as long as what an elbow's start leaves
constexpr int kWindows = 40;        // of which the middle one is meant; a burst now and then is no swing that lasts

constexpr double kMostNm = 100.0;  // of the board's numbers
constexpr double kRunsAway = 1e3;  // of the speed of the way: the numbers end soon

/// The board's gate, whose amperes are newton metres here.
auto gate_of(const LoopGains& gains) -> AxisConfig {
  AxisConfig config;
  config.motor.torque_per_current_nm_per_a = Q24::from_int(1);
  config.limits.current_a = config.limits.continuous_current_a = Q24::from_double(kMostNm);
  config.limits.current_rate_a_per_cycle = Q24::from_double(std::clamp(gains.rate_nm, 1e-6, kMostNm));
  config.limits.motor_min_rad = Q24::from_int(-100);
  config.limits.motor_max_rad = Q24::from_int(100);
  return config;
}

/// What control makes of the angle that the encoder shows, cycle by cycle: as law_of has it by frequency.
class Control {
 public:
  Control(const LoopGains& gains, double factor, double joint)
      : gains_(gains),
        stiffness_(factor * gains.stiffness),
        damping_(factor * gains.damping),
        joint_(joint),
        rate_gain_(SamplePeriod<double>(kCycleS).filter_gain(gains.rate_time_constant_s)) {}

  [[nodiscard]] auto step(double angle) -> double {
    const double rate = (angle - before_) / kCycleS;
    before_ = angle;
    rate_ += rate_gain_ * (rate - rate_);
    integral_ += gains_.ki_per_s * kCycleS * angle;
    const double by_joint = joint_ * (gains_.kp * angle + integral_ + gains_.kd_s * rate);
    return -stiffness_ * (angle + by_joint) - damping_ * rate_;
  }

 private:
  LoopGains gains_;
  double stiffness_, damping_, joint_, rate_gain_;
  double before_ = 0.0, rate_ = 0.0, integral_ = 0.0;
};

/// Of the windows' speeds, and the frequency of those that swing as much or more.
auto median_of(const std::vector<double>& speeds) -> LoopInTime::Swing {
  std::vector<LoopInTime::Swing> windows;
  for (auto from = speeds.begin(); from + kWindowCycles <= speeds.end(); from += kWindowCycles) {
    double power = 0.0;
    int risings = 0;
    for (auto at = from + 1; at != from + kWindowCycles; ++at) {
      power += *at * *at / (kWindowCycles - 1);
      risings += at[-1] < 0.0 && at[0] >= 0.0 ? 1 : 0;
    }
    windows.push_back({std::sqrt(2.0 * power), risings / ((kWindowCycles - 1) * kCycleS)});
  }
  const auto middle = windows.begin() + static_cast<std::ptrdiff_t>(windows.size() / 2);
  std::nth_element(windows.begin(), middle, windows.end(),
                   [](const auto& a, const auto& b) { return a.speed_rad_s < b.speed_rad_s; });
  double hz = 0.0;
  for (auto one = middle; one != windows.end(); ++one) {
    hz += one->hz / static_cast<double>(windows.end() - middle);
  }
  return {.speed_rad_s = middle->speed_rad_s, .hz = hz};
}

}  // namespace

LoopInTime::LoopInTime(const MotorModel& model, const LoopGains& gains, double joint, double friction_nm)
    : model_(model),
      gains_(gains),
      joint_(joint),
      friction_nm_(friction_nm),
      // Half a cycle of the delay is the hold's.
      late_(std::max(0, static_cast<int>(std::lround((model.delay_s - 0.5 * kCycleS) / kStepS)))) {
  model_.delay_s = 0.5 * kCycleS + kStepS * late_;
  model_.lag_s = std::max(model.lag_s, kLeastLagS);
  model_.hold_s = kCycleS;
  step_ = step();
}

void LoopInTime::bend(double hz, Complex value) {
  const double w = 2.0 * std::numbers::pi * hz;
  const double turned = std::atan(w * model_.lag_s) - std::arg(value / model_.at(hz));
  model_.lag_s = std::max(kLeastLagS, std::tan(std::clamp(turned, 0.0, kMostLag)) / w);
  const double heavier = std::abs(model_.at(hz) / value);
  for (double* number : {&model_.inertia_kgm2, &model_.viscous_nms, &model_.stiffness_nm, &model_.joint_inertia_kgm2}) {
    *number *= heavier;
  }
  step_ = step();
}

auto LoopInTime::step() const -> Step {
  Step slope = Step::Zero();
  slope(kTorque, kTorque) = -1.0 / model_.lag_s;
  slope(kTorque, kInput) = 1.0 / model_.lag_s;
  const double inertia = model_.inertia_kgm2;
  slope(kAngle, kSpeed) = 1.0;
  slope(kSpeed, kTorque) = 1.0 / inertia;
  slope(kSpeed, kAngle) = -model_.stiffness_nm / inertia;
  slope(kSpeed, kSpeed) = -model_.viscous_nms / inertia;
  if (model_.joint_inertia_kgm2 > 0.0) {
    const double own = 2.0 * std::numbers::pi * model_.joint_hz;
    const double heavier = model_.joint_inertia_kgm2 / inertia;
    const double damping = 2.0 * model_.joint_damping * own;
    slope(kSpeed, kAngle) -= heavier * own * own;
    slope(kSpeed, kSpeed) -= heavier * damping;
    slope(kSpeed, kJointAngle) = heavier * own * own;
    slope(kSpeed, kJointSpeed) = heavier * damping;
    slope(kJointAngle, kJointSpeed) = 1.0;
    slope(kJointSpeed, kAngle) = own * own;
    slope(kJointSpeed, kSpeed) = damping;
    slope(kJointSpeed, kJointAngle) = -own * own;
    slope(kJointSpeed, kJointSpeed) = -damping - 2.0 * model_.joint_drag * own;
  }
  Step exponential = Step::Identity();
  Step term = Step::Identity();
  for (int i = 1; i <= kTaylor; ++i) {
    term = term * slope * (std::ldexp(kStepS, -kHalvings) / i);
    exponential += term;
  }
  for (int i = 0; i < kHalvings; ++i) {
    exponential = exponential * exponential;
  }
  return exponential;
}

auto LoopInTime::at(double factor, double way_rad_s) const -> Swing {
  const double count = 2.0 * std::numbers::pi / gains_.counts_per_turn;
  const AxisConfig config = gate_of(gains_);
  Gate gate(config);
  Control control(gains_, factor, joint_);
  State state = State::Zero();
  state[kSpeed] = -0.5 * way_rad_s;  // a joint that has just set out
  std::vector<double> torques(static_cast<std::size_t>(late_ + 1), 0.0);
  std::size_t now = 0;
  const double turned = 2.0 * friction_nm_ / model_.inertia_kgm2 * kStepS;
  std::vector<double> speeds;
  for (int cycle = 0; cycle < kStartCycles + kWindows * kWindowCycles; ++cycle) {
    const double way = way_rad_s * kCycleS * cycle;
    const double shown = std::floor((way + state[kAngle]) / count) * count - way;
    const Q24 wanted = Q24::from_double(std::clamp(control.step(shown), -kMostNm, kMostNm));
    const double torque = gate.rt_step(config.limits, MotorState{}, wanted, true).current_a.to_double();
    for (int i = 0; i < kSteps; ++i) {
      torques[now] = torque;
      now = (now + 1) % torques.size();
      state[kInput] = torques[now];
      state = step_ * state;
      // Beyond that the motor goes back, and friction turned with it, until the motor stands.
      state[kSpeed] += std::clamp(-way_rad_s - state[kSpeed], 0.0, turned);
    }
    if (!(std::fabs(state[kSpeed]) < kRunsAway * way_rad_s)) {
      return {.speed_rad_s = kRunsAway * way_rad_s, .hz = 0.0};
    }
    if (cycle >= kStartCycles) {
      speeds.push_back(state[kSpeed]);
    }
  }
  return median_of(speeds);
}

}  // namespace capstan::tools
