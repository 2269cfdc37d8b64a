// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <cmath>

#include "capstan/firmware/loop/axis.hpp"

namespace capstan::test {

inline constexpr double kCountsPerRad = 40960.0 / 6.283185307179586;  // of the default motor

inline auto q(double value) -> Q24 {
  return Q24::from_double(value);
}
inline auto has(LimitSet limits, Limit limit) -> bool {
  return (limits & bit(limit)) != 0;
}
inline auto sensed_at(double q1_rad, double current_a) -> AxisSensed {
  return {.encoder_counts = static_cast<std::int32_t>(std::lround(q1_rad * kCountsPerRad)),
          .current_a = q(current_a),
          .encoder = Quality::kOk,
          .current = Quality::kOk};
}

inline auto config_without_rate_limit() -> AxisConfig {
  AxisConfig config;
  config.limits.current_rate_a_per_cycle = Q24::from_int(100);
  return config;
}

/// An axis whose stages are called one by one, with the values of the last call of each handed on.
class AxisBench {
 public:
  explicit AxisBench(const AxisConfig& config) : axis_(config) {}

  void estimate(const AxisSensed& sensed) {
    motor_ = axis_.rt_sense(sensed);
    joint_ =
        axis_.rt_estimate(motor_, {.measured = {.q1 = motor_.q1_rad, .tau = motor_.tau_nm}, .faults = motor_.faults});
    report();
  }
  auto faults(bool energised) -> FaultSet { return faults_ = axis_.rt_faults(motor_, joint_, energised); }
  auto command(const Request& command) -> bool { return axis_.rt_command(motor_, joint_, command); }
  void arm() { axis_.rt_arm(joint_); }
  auto control() -> Q24 {
    const Q24 torque = axis_.rt_reference(motor_, joint_, true).torque_nm;
    report();
    return torque;
  }
  auto drive(Q24 torque_nm, bool energised) -> AxisDrive {
    const AxisDrive drive = axis_.rt_drive(motor_, torque_nm, energised);
    report();
    return drive;
  }
  /// One cycle at an angle with a measured current, in which a current is asked for; the one that passed the gate, A.
  /// The default torque constant is 0.1 Nm/A.
  auto gated(double q1_rad, double current_a, double wanted_a, bool energised = true) -> double {
    estimate(sensed_at(q1_rad, current_a));
    const AxisDrive out = drive(q(0.1 * wanted_a), energised);
    EXPECT_EQ(out.enabled, energised);
    EXPECT_EQ(out.current_a, telemetry().drive_a);
    return out.current_a.to_double();
  }
  auto axis() -> Axis& { return axis_; }
  [[nodiscard]] auto in_motion() const -> bool { return axis_.in_motion(); }
  [[nodiscard]] auto telemetry() const -> const AxisTelemetry& { return axis_.telemetry(); }

 private:
  void report() { axis_.rt_report(motor_, joint_, nullptr, faults_); }

  Axis axis_;
  MotorState motor_;
  JointEstimate joint_;
  FaultSet faults_ = 0;
};

/// The same at rest with torque.
inline void arm_at_rest(AxisBench& axis) {
  axis.estimate(sensed_at(0.0, 0.0));
  axis.arm();
}

}  // namespace capstan::test
