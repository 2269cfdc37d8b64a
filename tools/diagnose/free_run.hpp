// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/tools/diagnose/diagnosis.hpp"
#include "capstan/tools/diagnose/preparation.hpp"

namespace capstan::tools {

/// The causal law that the firmware will run, fitted on the rows that may be learned from; shapes start from those of
/// the form.
auto causal_law(const Preparation& p, const LawForm& form) -> JointFile;

/// Error of an estimate, beside the size of what was measured.
auto error_summary(const Eigen::VectorXd& measured, const Eigen::VectorXd& estimate) -> ErrorSummary;

/// Free-running error of an estimate on the rows set aside.
auto report_error(const Preparation& p, const Eigen::VectorXd& estimate) -> ErrorSummary;

/// rms error of an estimate on the rows set aside where the running direction switch agrees with the noncausal one:
/// without what is owed to an encoder that shows a turn late. In the target's unit.
auto error_of_known_direction(const Preparation& p, const Eigen::VectorXd& estimate) -> double;

/// Of the reversals that the running direction switch is late at, the share that it shows in the very next row: that is
/// the least that a log can show, whatever its encoder. 0 where it is never late.
auto share_late_by_one_row(const Preparation& p) -> double;

/// What the noise of torque and rate brings into a running estimate of a law, rms on the same rows, in the target's
/// unit: its distance from the estimate noncausally, where these are smoothed. No other law of these sensors knows
/// better.
auto noise_of_running(const Preparation& p, const LawForm& form) -> double;

/// Whether a law errs less than the base for certain on the rows set aside, on the coarse grid and noncausally, where
/// decisions are taken. A running estimate errs most where the motor has turned and its encoder does not show it yet,
/// and no effect mends that.
auto holds_on_unseen_rows(const Preparation& p, const LawForm& base, const LawForm& law) -> bool;

/// 95 % interval of rmse(after) / rmse(before), whole blocks resampled in pairs; fewer than eight are cut into so many.
/// @pre there are rows
auto ratio_interval(const Eigen::VectorXd& target, const Blocks& blocks, const Eigen::VectorXd& before,
                    const Eigen::VectorXd& after) -> Interval;
/// 95 % interval of rmse(after) / rmse(before) on the rows set aside, whole blocks resampled in pairs.
auto ratio_interval(const Preparation& p, const Eigen::VectorXd& before, const Eigen::VectorXd& after) -> Interval;

}  // namespace capstan::tools
