// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/tools/diagnose/search.hpp"
#include "capstan/tools/identify/loop.hpp"
#include "capstan/tools/identify/torque_balance.hpp"

namespace capstan::tools {

/// What a torque is told from, beside a healthy joint's loop.
auto torque_logs(const Preparation& p, const JointFile& healthy, const Loop& before) -> TorqueLogs;

/// A law's loop beside the healthy joint's: how wide and how late it is, and how large what made it so. What it is made
/// of has to outlive it.
class LoopSize {
 public:
  /// @param before  the healthy joint's
  /// @param law     with a loop; how late it is is looked for where that is known of the healthy joint's
  LoopSize(const Preparation& p, const JointFile& healthy, const Loop& before, const LawForm& law);

  /// At the motor.
  [[nodiscard]] auto half_width_rad() const -> double;
  /// Over the healthy joint's.
  [[nodiscard]] auto width() const -> double { return half_width_rad() / before_.half_width_rad; }

  /// How large a change of the loop alone is: of a play the gap to either side at the joint, else what the pretension
  /// or the stiffness is over the healthy joint's.
  [[nodiscard]] auto of_change(const std::string& name) const -> EffectSize;
  /// How much later the joint is than the healthy one was: its sensors have clocks of their own, too. Nothing where
  /// the name is no delay, or the healthy joint's is not known.
  [[nodiscard]] auto of_delay(const std::string& name) const -> std::optional<EffectSize>;
  /// An angle that errs takes no torque; a detent turns the joint by what its torque stretches.
  [[nodiscard]] auto is_torque_periodic() const -> bool;

 private:
  [[nodiscard]] auto with_intervals() const -> JointFile;
  [[nodiscard]] auto of_pretension(double width_95) const -> std::optional<EffectSize>;
  [[nodiscard]] auto lateness_of_drag() const -> double;

  const Preparation& p_;
  const JointFile& healthy_;
  const Loop& before_;
  LawForm law_;
};

}  // namespace capstan::tools
