// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "capstan/firmware/estimate/tendon_health.hpp"
#include "capstan/firmware/safety/warnings.hpp"

namespace capstan {

/// Tells when a law no longer fits its joint: worn tendons, lost pretension. It compares the law with the joint's
/// sensor where there is one, and the motor's torque to and fro with that of the steady motion the joint was
/// identified with; of that only what differs between the two directions counts, for a load at the tip shifts both.
/// What both say together has a cause: TendonJudge.
///
/// What counts is taken every kStride of the motor's travel, so a joint at rest proves nothing, and kStretch samples
/// are a stretch (kSteadyStretch to and fro of friction). Of each stretch m is the mean square of the error, or the
/// square of the mean friction's, over what is expected squared, and
///   level = max(0, level + m - excess^2),   warning at level > h = kLogStretches / theta.
/// theta is the root of -ln(1 - 2 theta) / 2 = theta excess^2: for m with the widest tail that a mean square of normal
/// errors can have (one degree of freedom: a stretch whose errors are all alike) E e^(theta (m - excess^2)) = 1, hence
/// on average at least e^kLogStretches = 3.3 million stretches between two false warnings (Wald; Lorden 1971), each 1
/// rad of travel or more, as long as stretches are independent and as good as expected. Cost: fifty
/// instructions in a cycle of motion, and 450 for a stretch, which is judged when its owner says so.
class LawMonitor {
 public:
  static constexpr std::int32_t kStretch = 256;
  /// Of steady motion, on either way: with two reversals and what settles behind them more than 1 rad too.
  static constexpr std::int32_t kSteadyStretch = kStretch / 4;
  static constexpr Q24 kStride = Q24::from_double(1.0 / 256.0);  ///< rad of the motor
  static constexpr double kLogStretches = 15.0;
  /// Strides after a start that prove nothing: the law does not know yet where the joint came from.
  static constexpr std::int32_t kUnsettled = 2 * kStretch;

  /// What a cycle knows.
  struct Input {
    Q24 q1_rad;
    Q24 q1_reversal_rad;  ///< where the present direction began
    Q24 tau_nm;
    bool forward;
    Q24 joint_lead_rad;   ///< the law's joint angle beyond the ratio's, along the motor's motion
    bool has_joint;       ///< the joint's sensor gave a value
    Q24 joint_error_rad;  ///< that value minus the law's
    bool crossed;         ///< the joint turns against the motor
  };

  explicit LawMonitor(const MonitorConfig& config) { rt_configure(config); }
  /// Begins anew; a warning goes away.
  void rt_configure(const MonitorConfig& config);
  /// The law's memory begins anew.
  void rt_unsettle() { settled_ = 0; }
  /// It was told what error to expect, and the motor has come a stride further: rt_step does something.
  [[nodiscard]] auto is_due(Q24 q1_rad) const -> bool { return watches_ && abs(q1_rad - last_q1_) >= kStride; }
  void rt_step(const MonitorConfig& config, const ControlConfig& control, const Input& now);
  /// Judges the stretch if it is complete. It divides, so where there are many joints they take turns.
  void rt_judge(const AxisConfig& config);

  [[nodiscard]] auto warnings() const -> WarningSet { return warnings_; }
  /// How far it is to a warning: 0 nothing, 1 there.
  [[nodiscard]] auto level() const -> Q24 { return std::max(sensor_.share, friction_.share); }
  [[nodiscard]] auto tendons() const -> const TendonJudge& { return tendons_; }

 private:
  LawMonitor() = default;
  /// One direction of a stretch.
  struct Side {
    std::int64_t torque = 0;  // beyond the steady one
    std::int64_t lead = 0;    // of the joint by the law, along the motor's motion
    std::int64_t error = 0;   // of the law against the joint's sensor, along the motor's motion
    std::int32_t count = 0;
    std::int32_t sensed = 0;  // of them with the sensor
  };
  /// One sequential test.
  struct Test {
    Q24 level;
    Q24 share;  // of the threshold
  };
  void rt_sensor_stretch(const MonitorConfig& config);
  void rt_steady_stretch(const AxisConfig& config);
  void rt_weigh(Test& test, Q24 excess, Q24 mean_square, Warning warning);

  Q24 last_q1_;
  std::int32_t settled_ = 0;  // strides, up to kUnsettled
  std::int64_t squares_ = 0;
  std::int32_t count_ = 0;
  std::array<Side, 2> sides_{};  // backward, forward
  Test sensor_;
  Test friction_;
  Q24 threshold_ = Q24::from_int(1);
  TendonJudge tendons_;
  WarningSet warnings_ = 0;
  bool watches_ = false;
};

}  // namespace capstan
