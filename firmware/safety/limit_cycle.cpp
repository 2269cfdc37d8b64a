// SPDX-License-Identifier: Apache-2.0
#include "capstan/firmware/safety/limit_cycle.hpp"

namespace capstan {
namespace {

// Numbers that decide, chosen in November 2026 on the simulated forceps, seeds 21 to 26 and 91000 to 91047; false
// alarms are counted on others.
constexpr std::int32_t kWindow = 512;     // cycles
constexpr std::int32_t kTurns = 16;       // in a window, at least: 15.6 Hz, as fast as a hand trembles
constexpr std::int32_t kUsualTurns = 48;  // where the inertia is not known
// Turns of 1.33 times the swing of the inertia on the servo's stiffness, (1.33 x 2 x 0.512 s / 2 pi)^2 K / J, with K in
// N m/rad and J in g m2. Drawn forceps begin to swing at 1.5 to 2 times that.
constexpr std::int64_t kSwing = 47;
constexpr std::int32_t kAskedTurns = 2;    // of the wanted angle, at most
constexpr std::int32_t kWarnWindows = 2;   // one after the other
constexpr std::int32_t kFaultWindows = 8;  // 4.1 s
constexpr std::int32_t kCounts = 4;        // from side to side; a motor that stands between two counts shows one or two

// Torque and motion lose their means by the same filter, 64 ms, so what is left of them keeps its phase.
constexpr int kMeanShift = 6;
constexpr Q24 kTurn = Q24::from_double(6.283185307179586);

auto about_mean(std::int32_t raw, std::int64_t& mean) -> std::int64_t {
  mean += raw - (mean >> kMeanShift);
  return raw - (mean >> kMeanShift);
}

}  // namespace

void LimitCycleWatch::Turns::rt_step(Q24 value, Q24 width) {
  const bool further = rising ? value > extreme : value < extreme;
  if (further) {
    extreme = value;
  } else if (abs(value - extreme) > width) {
    extreme = value;
    rising = !rising;
    ++count;
  }
}

void LimitCycleWatch::rt_configure(const AxisConfig& config) {
  width_ = Q24::from_raw(kCounts * (kTurn.raw() / std::max(config.motor.encoder_counts_per_turn, std::int32_t{1})));
  stiffness_nm_per_rad_ = config.control.stiffness_nm_per_rad;
  inertia_gm2_ = config.observer.inertia_gm2;
}

void LimitCycleWatch::rt_rest() {
  error_.count = wanted_.count = 0;
  cycles_ = windows_ = 0;
  asked_ = warned_ = known_ = false;
  fed_ = 0;
}

auto LimitCycleWatch::rt_step(const MotorState& motor, const JointReference& reference, bool asked) -> FaultSet {
  error_.rt_step(reference.q1_rad - motor.q1_rad, width_);
  wanted_.rt_step(reference.q2_rad, width_);
  const Q24 moved = known_ ? motor.q1_rad - last_q1_ : Q24{};
  last_q1_ = motor.q1_rad;
  known_ = true;
  const std::int64_t torque = about_mean(motor.tau_nm.raw(), mean_torque_);
  fed_ += torque * about_mean(moved.raw(), mean_step_);
  asked_ = asked_ || asked || reference.begins;
  return ++cycles_ < kWindow ? 0 : rt_end_window();
}

auto LimitCycleWatch::rt_end_window() -> FaultSet {
  const std::int64_t turns = error_.count;
  const bool fast = inertia_gm2_ > Q24{}
                        ? turns >= kTurns && turns * turns * inertia_gm2_.raw() >= kSwing * stiffness_nm_per_rad_.raw()
                        : turns >= kUsualTurns;
  const bool swings = !asked_ && fast && wanted_.count <= kAskedTurns && fed_ > 0;
  windows_ = swings ? std::min(windows_ + 1, kFaultWindows) : 0;
  warned_ = warned_ || windows_ >= kWarnWindows;
  error_.count = wanted_.count = cycles_ = 0;
  fed_ = 0;
  asked_ = false;
  // What is too fast for an inertia that nobody knows may be warned of, and is no reason to stop.
  return windows_ >= kFaultWindows && inertia_gm2_ > Q24{} ? bit(Fault::kLimitCycle) : 0;
}

}  // namespace capstan
