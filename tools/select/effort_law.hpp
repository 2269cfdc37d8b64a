// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/tools/select/part_laws.hpp"

namespace capstan::tools {

/// A law of an effort or of the torque behind a gear, with what it takes to run it over a log.
struct EffortLaw {
  JointFile joint;              ///< terms and numbers; coefficients that were not chosen are zero
  std::string target;           ///< the column that it explains
  std::string status = "base";  ///< confirmed, provisional or base
  EffortView view;              ///< how logs are looked at

  [[nodiscard]] auto of_gear() const -> bool { return joint.catalogue->target() == TargetKind::kForce; }
};

/// What was chosen, and how it fares.
struct EffortSelection {
  EffortLaw law, base;
  EffortLaw start;                   ///< the base law by its name: inertia and drag, inertia alone, or gain and offset
  std::vector<std::string> effects;  ///< names by the contract, in the order they came
  double before = 0.0, after = 0.0;  ///< rms error of base and law on the last fifth, both chosen and fitted without it
  double target_rms = 0.0;           ///< there
  /// All rows of all logs: the target as it is seen, and what start and law, chosen and fitted without the last fifth,
  /// say of it.
  Eigen::VectorXd measured, by_start, by_law;
  Eigen::Index first_unseen = 0;
};

/// Whether there is enough to choose a law by: rows, motion and a target that changes.
auto can_select_effort_law(const std::vector<AxisLog>& logs) -> bool;

/// Chooses the law of the logs' effort (or joint torque, where the motor's is an input) that predicts unseen rows best,
/// from rigid dynamics (from a gain) on, of which what does not lower the error stays out. It is always found: where
/// nothing lowers the error it is the base.
/// @param bare  from inertia alone on
/// @pre can_select_effort_law()
auto select_effort_law(const std::vector<AxisLog>& logs, bool bare = false) -> EffortSelection;

void set_status(LawStatus status, EffortLaw& law);

/// A law of the same effort that was fitted elsewhere, its terms by their names, to be run over logs like these.
auto runnable_law(const JointFile& law, const std::vector<AxisLog>& logs) -> EffortLaw;

/// The law's effort over all logs, one below the other, seen as it was when it was fitted.
auto run_effort_law(const std::vector<AxisLog>& logs, const EffortLaw& law) -> Eigen::VectorXd;

}  // namespace capstan::tools
