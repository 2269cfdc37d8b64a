// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/tools/diagnose/diagnosis.hpp"

namespace capstan::tools {

/// The pull-push law that a diagnosis was asked to begin with, to be judged beside a grown one.
struct PullPushBase {
  JointFile joint;
  /// The same as `identify` fits and writes it; nothing where the logs do not determine all of it, so that no file
  /// holds it. The joint is then what the search began with.
  std::optional<PullPushFit> fit;
  std::string undetermined;  ///< why there is no such fit, and what to record
  Eigen::VectorXd estimate;  ///< of all rows as logged; a law that identify writes was fitted without the last ones
};

/// Nothing where the logs give no such law a start.
/// @param searched  the base law of the search; without terms where it came to none
/// @param first_unseen  row of all logs from which on none takes part in the fit that is judged
auto pull_push_base(const std::vector<AxisLog>& logs, const JointFile& searched, Eigen::Index first_unseen)
    -> std::optional<PullPushBase>;

/// The joint's torque by the base law of a diagnosis, over a log as it is: as a board runs it, where a file holds it.
auto run_pull_push_base(const AxisLog& log, const JointFile& joint, const std::optional<PullPushFit>& fit)
    -> Eigen::VectorXd;

}  // namespace capstan::tools
