// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/tools/select/grown_law.hpp"

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
  std::vector<std::string> effects;  ///< names by the contract, in the order they came
  GrownLaw grown;                    ///< on all rows
  double before = 0.0, after = 0.0;  ///< rms error of base and law on the last fifth, both chosen and fitted without it
  double target_rms = 0.0;           ///< there
};

/// Chooses the law of the logs' effort (or joint torque, where the motor's is an input) that predicts unseen rows best,
/// from rigid dynamics (from a gain) on. It is always found: where nothing lowers the error it is the base.
auto select_effort_law(const std::vector<AxisLog>& logs) -> EffortSelection;

/// The law's effort over all logs, one below the other, seen as it was when it was fitted.
auto run_effort_law(const std::vector<AxisLog>& logs, const EffortLaw& law) -> Eigen::VectorXd;

}  // namespace capstan::tools
