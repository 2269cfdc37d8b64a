// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/tools/diagnose/split.hpp"
#include "capstan/tools/identify/given_motion.hpp"
#include "capstan/tools/identify/identify.hpp"

namespace capstan::tools {

/// The logs on the coarse grid on which decisions are taken: each row is the mean of `factor` samples of every signal
/// alike.
struct CoarseSignals {
  Eigen::VectorXd time_s;  ///< since the start of the first log, logs one after the other
  Eigen::VectorXd q1, dq1, ddq1, tau;
  Eigen::VectorXd forward;          ///< share of the row's samples that move forward, 0 to 1
  Eigen::VectorXd tau_rev, q1_rev;  ///< torque and angle at the last reversal
  std::vector<SideSignal> side;
};

/// Everything that is decided before any candidate is looked at.
struct Preparation {
  std::vector<AxisLog> logs;
  ConditionerShape<double> conditioner;
  AngleNoise noise;
  LawDesign causal, noncausal;  ///< of an effort both are the given motion's
  /// Noncausal samples with what its sensors may have hidden added, one draw each: resolution of q1 and, where it is an
  /// input, noise of the torque. What a law makes of that is neither noise of the target nor an effect.
  std::vector<LawDesign> disturbed;
  Eigen::VectorXd target;      ///< q2 or the effort, every sample
  Eigen::Index factor = 1;     ///< samples per coarse row
  Eigen::Index smoothing = 0;  ///< half width of the moving mean before that, samples
  double coarse_period_s = 0.0;
  Blocks coarse_logs;              ///< rows of each log, warm-up left out
  std::optional<Repeats> repeats;  ///< in coarse rows
  Split split;                     ///< in coarse rows
  CoarseSignals signals;
  Blocks uncertain;  ///< coarse rows whose direction is not known, in order
  std::vector<std::string> notes;

  /// Columns of every sample on the coarse grid: moving mean, mean of each row's samples, interpolated.
  [[nodiscard]] auto coarse(const Eigen::MatrixXd& columns) const -> Eigen::MatrixXd;
  /// Coarse columns with the uncertain rows replaced by straight lines. The same is done to every column and to the
  /// target, so a law that holds on the other rows holds on these.
  [[nodiscard]] auto interpolated(Eigen::MatrixXd columns) const -> Eigen::MatrixXd;
  /// Samples to learn from, at full rate, without those whose direction is not known: a few of them, with a jump of the
  /// law on the wrong side, would weigh more than all the others.
  [[nodiscard]] auto certain() const -> Blocks;
};

/// Why these logs can not be diagnosed, and what to record instead; empty if they can.
auto reason_unfit(const std::vector<AxisLog>& logs) -> std::string;

/// Why these logs can name no effect, though a law can be learned from them, and what to record instead; empty if they
/// can.
auto reason_nameless(const std::vector<AxisLog>& logs) -> std::string;

/// @pre reason_unfit() is empty; every log has the target
auto prepare(std::vector<AxisLog> logs, const LawForm& base) -> Preparation;

/// The same with the motor's rate through another filter.
auto with_rate_filter(Preparation p, double time_constant_s) -> Preparation;

}  // namespace capstan::tools
