// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/tools/identify/conditioning.hpp"
#include "capstan/tools/identify/least_squares.hpp"

namespace capstan::tools {

/// Samples as they are known afterwards, for deciding which effect it is: the direction turns when the motor did
/// instead of when the causal switch notices it, torque and angle are those of that reversal, neither rate nor
/// acceleration lags, and the motor angle goes straight from count to count. What is reported in the end is the causal
/// law's error.
/// Angle and rate stand before and behind the input terms alike, as in a causal sample: the ratio reads what is behind.
struct NoncausalSamples {
  Samples samples;
  Blocks uncertain;  ///< rows around reversals where even noncausal samples can not tell the direction, for the
                     ///< encoder's resolution
  Eigen::VectorXd hidden_rad;  ///< what the encoder's resolution may still be hiding of q1: one draw, no measurement
  /// The same of the rates, with what their windows blur: what was seen, seen again. rad/s, krad/s2
  Eigen::VectorXd hidden_rate, hidden_acceleration;
};
auto noncausal_samples(const AxisLog& log, const ConditionerShape<double>& conditioner, const AngleNoise& noise)
    -> NoncausalSamples;

/// Rows of one log whose direction the running switch does not know yet, or whose direction the encoder hides. A law
/// with a jump by direction is on the wrong side of it there, and taught by these rows it would make the jump smaller
/// than it is (with 8192 counts at 200 Hz an elongation of 0.150 came out as 0.131, 28 November 2026).
auto doubtful_rows(const Samples& running, const NoncausalSamples& afterwards) -> Blocks;

/// Lets the motor be at this angle with this rate, where no input term has acted: what is behind them is the same.
inline void set_motion(Sample<double>& sample, double q1, double dq1) {
  sample.q1 = sample.h = q1;
  sample.dq1 = sample.dh = dq1;
}

/// Half width, in samples, of the window for the rate: as short as keeps the rate's noise below 2 % of the motion's.
auto rate_half_window(const AxisLog& log, const AngleNoise& noise) -> Eigen::Index;

/// Slope of a straight line through 2 h + 1 neighbours, per second; fewer neighbours at the ends.
auto local_slope(const Eigen::VectorXd& signal, Eigen::Index half_window, double period_s) -> Eigen::VectorXd;

/// What a signal shows so many rows later, between rows on a straight line; the last value where it has ended.
auto ahead_by(double rows, const Eigen::Ref<const Eigen::VectorXd>& signal) -> Eigen::VectorXd;

}  // namespace capstan::tools
