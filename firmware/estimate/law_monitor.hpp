// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "capstan/firmware/parameters/config.hpp"
#include "capstan/firmware/safety/warnings.hpp"

namespace capstan {

/// Tells when a law no longer fits its joint: worn tendons, lost pretension. It compares the law with the joint's
/// sensor where there is one, else the motor's torque to and fro with that of the steady motion the joint was
/// identified with; of that only what differs between the two directions counts, for a load at the tip shifts both.
///
/// What counts is taken every kStride of the motor's travel, so a joint at rest proves nothing, and kStretch samples
/// are a stretch. Of each stretch m is the mean square of the error, or the square of the mean friction's, over what is
/// expected squared, and
///   level = max(0, level + m - excess^2),   warning at level > h = kLogStretches / theta.
/// theta is the root of -ln(1 - 2 theta) / 2 = theta excess^2: for m with the widest tail that a mean square of normal
/// errors can have (one degree of freedom: a stretch whose errors are all alike) E e^(theta (m - excess^2)) = 1, hence
/// on average at least e^kLogStretches = 3.3 million stretches between two false warnings (Wald; Lorden 1971), each 1
/// rad of travel or more, as long as stretches are independent and as good as expected. Cost: fifty
/// instructions in a cycle of motion, and 450 for a stretch, which is judged when its owner says so.
class LawMonitor {
 public:
  static constexpr std::int32_t kStretch = 256;
  static constexpr Q24 kStride = Q24::from_double(1.0 / 256.0);  ///< rad of the motor
  static constexpr double kLogStretches = 15.0;

  /// What a cycle knows.
  struct Input {
    Q24 q1_rad;
    Q24 q1_reversal_rad;  ///< where the present direction began
    Q24 tau_nm;
    bool forward;
    bool has_joint;       ///< the joint's sensor gave a value
    Q24 joint_error_rad;  ///< that value minus the law's
  };

  explicit LawMonitor(const MonitorConfig& config) { rt_configure(config); }
  /// Begins anew; a warning goes away.
  void rt_configure(const MonitorConfig& config);
  /// It was told what error to expect.
  [[nodiscard]] auto watches() const -> bool { return watches_; }
  void rt_step(const MonitorConfig& config, const ControlConfig& control, const Input& now);
  /// Judges the stretch if it is complete. It divides, so where there are many joints they take turns.
  void rt_judge(const MonitorConfig& config);

  [[nodiscard]] auto warnings() const -> WarningSet { return warnings_; }
  /// How far it is to a warning: 0 nothing, 1 there.
  [[nodiscard]] auto level() const -> Q24 { return share_; }

 private:
  LawMonitor() = default;
  struct Side {
    std::int64_t sum = 0;  // of the torque beyond the steady one
    std::int32_t count = 0;
  };
  void rt_sensor_stretch(const MonitorConfig& config);
  void rt_friction_stretch(const MonitorConfig& config);
  void rt_weigh(Q24 excess, Q24 mean_square, Warning warning);

  Q24 last_q1_;
  std::int64_t squares_ = 0;
  std::int32_t count_ = 0;
  std::array<Side, 2> sides_{};  // backward, forward
  Q24 level_;
  Q24 share_;
  Q24 threshold_ = Q24::from_int(1);
  WarningSet warnings_ = 0;
  bool watches_ = false;
};

}  // namespace capstan
