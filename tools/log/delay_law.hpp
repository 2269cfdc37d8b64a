// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "capstan/tools/log/shift_fit.hpp"

namespace capstan::tools {

/// Strokes whose lengths and times differ by less, rms over mean, are alike.
inline constexpr double kAlikeStrokes = 0.02;

/// Where a motion turns, by its angle alone.
struct Turns {
  Eigen::VectorXd direction;  ///< per row: 1, -1, before the first motion 0
  Eigen::Index count = 0;
  double spread = 0.0;   ///< of the strokes' lengths or times, rms over mean; 0: each is like the last
  double repeats = 1.0;  ///< how often a motion of several strokes comes as a whole
  double unsure = 0.0;   ///< rows to which the angle's steps let a turn be known, median
};
/// A turn is certain only after some travel. It is put where the way back began, at the acceleration that the first of
/// that travel shows: not at the start of a rest, and not where the first step came.
auto turns_of(const Eigen::VectorXd& angle) -> Turns;

/// Half width of the window through which an angle's noise and steps do not matter, rows.
struct DelayWindows {
  Eigen::Index speed = 0, acceleration = 0;
};
auto delay_windows(const Eigen::VectorXd& angle, const Turns& turns) -> DelayWindows;

struct LawChannels {
  const Eigen::VectorXd* q1 = nullptr;
  const Eigen::VectorXd* tau = nullptr;  ///< may be missing
  double period_s = 0.0;
  double own_play = 0.0;  ///< half width of the gap that the target shows, beside those that are always looked for
};

/// Half width of the one gap behind an angle that, with a cubic, follows a target best that is late by so many rows.
auto own_play(const Eigen::VectorXd& angle, const Eigen::VectorXd& target, Eigen::Index late) -> double;

/// Columns of a flexible law of the motor's motion and, if there is one, of its torque: acceleration (the first),
/// speed, any function of the angle, friction by direction, angle and speed, friction that lags in travel; any function
/// of the torque by direction, its lag and its creep. All that a log may have without any channel being late.
auto delay_law(const LawChannels& channels, const Turns& turns, const LogParts& parts) -> std::vector<Eigen::MatrixXd>;

}  // namespace capstan::tools
