// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/firmware/parameters/config.hpp"

namespace capstan {

/// Control of the joint's torque through the inverse force law: the joint has no sensor of it, so this is feedforward
/// with memory. The law follows every torque that the motor is told, in whatever mode, and so knows its past.
///   tau = law^-1(wanted, on the branch that the wanted torque's direction is on) + rest
/// A reversal crosses the hysteresis: `rest` is what the inverse jumped by, and fades within reversal_time, so the
/// motor does not ring. The motor's torque moves only in the direction of the wanted one: rounding must not cross the
/// hysteresis to and fro.
class ForceControl {
 public:
  /// @param config  the law refers to its grid: it must outlive this object, and rt_configure follow each change of it
  explicit ForceControl(const ForceConfig& config) { rt_configure(config); }
  ForceControl(const ForceControl&) = delete;
  auto operator=(const ForceControl&) -> ForceControl& = delete;
  ~ForceControl() = default;

  /// The law anew, from the same place in memory; its past is forgotten.
  void rt_configure(const ForceConfig& config);
  [[nodiscard]] auto has_law() const -> bool { return law_.is_there(); }

  /// What the motor was told in the last cycle, N m.
  void rt_observe(Q24 motor_nm);
  /// What the law makes of it. `known`: its past no longer matters; until then it is taken as demagnetised.
  [[nodiscard]] auto estimate() const -> const ForceEstimate<Q24>& { return estimate_; }

  /// Takes over at the motor's present torque: what is wanted begins where the law says that the joint's torque is, and
  /// goes on to the goal, the last one until rt_aim gives another.
  void rt_start(Q24 motor_nm);
  /// From now on the joint's torque goes to `goal_nm` at `rate_nm_per_s` at most.
  void rt_aim(Q24 goal_nm, Q24 rate_nm_per_s);
  /// Motor torque, N m. @pre has_law()
  auto rt_update(const ForceConfig& config) -> Q24;

  [[nodiscard]] auto wanted() const -> Q24 { return wanted_; }
  [[nodiscard]] auto goal() const -> Q24 { return goal_; }
  [[nodiscard]] auto arrived() const -> bool { return wanted_ == goal_; }
  /// The wanted torque is beyond what the law reaches.
  [[nodiscard]] auto out_of_reach() const -> bool { return out_of_reach_; }

 private:
  void rt_turn(Q24 threshold_nm);

  ForceConfig::Law law_;
  ForceEstimate<Q24> estimate_;
  Q24 goal_;
  Q24 rate_nm_per_s_;
  Q24 wanted_;
  Q24 extreme_;  // of what was wanted, in the present direction
  Q24 aim_;      // the inverse
  Q24 rest_;     // of its last jump
  bool rising_ = true;
  bool jumps_ = true;  // at the next solution: the branch is a new one
  bool out_of_reach_ = false;
};

}  // namespace capstan
