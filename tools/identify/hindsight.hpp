// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/tools/identify/conditioning.hpp"
#include "capstan/tools/identify/least_squares.hpp"

namespace capstan::tools {

/// Samples as they are known afterwards, for deciding which effect it is: the direction turns when the motor did
/// instead of when the causal switch notices it, torque and angle are those of that reversal, neither rate nor
/// acceleration lags, and the motor angle goes straight from count to count. What is reported in the end is the causal
/// law's error.
struct Hindsight {
  Samples samples;
  Blocks uncertain;  ///< rows around reversals where even hindsight can not tell the direction, for the encoder's
                     ///< resolution
  Eigen::VectorXd hidden_rad;  ///< what the encoder's resolution may still be hiding of q1: one draw, no measurement
};
auto hindsight_samples(const AxisLog& log, const ConditionerShape<double>& conditioner, const AngleNoise& noise)
    -> Hindsight;

/// Half width, in samples, of the window for the rate: as short as keeps the rate's noise below 2 % of the motion's.
auto rate_half_window(const AxisLog& log, const AngleNoise& noise) -> Eigen::Index;

/// Slope of a straight line through 2 h + 1 neighbours, per second; fewer neighbours at the ends.
auto local_slope(const Eigen::VectorXd& signal, Eigen::Index half_window, double period_s) -> Eigen::VectorXd;

}  // namespace capstan::tools
