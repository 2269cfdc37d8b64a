// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "capstan/tools/response/loop.hpp"

namespace capstan::tools {

/// What a loop does when stiffness and damping, and with them the joint loop, grow by one factor g. Balance of the
/// first harmonic: 1 / P + g F + j w N(a) = 0, P the motor's response while it moves, F the control, N the describing
/// function of friction +-f for a motor that goes at v and swings by the speed a:
///   N = 4 f / (pi a) sqrt(1 - (v / a)^2),  and 0 where a < v: friction of one sign damps nothing.
/// So a moving joint begins to swing where the loop would without friction, and friction lets the swing grow to a = v
/// at once and holds it between v and 1.41 v. A joint that stands is held by friction until it is pushed. What lies
/// between motor encoder and joint, play among it, is a load in P and nothing else: the loop closes over the motor's
/// encoder.
/// The gate limits how fast the current changes, and the more of that the encoder's steps take, the sooner it swings
/// and the slower: that is run in time (LoopInTime) with the speed at which the joint of the log travelled.
struct LimitCycle {
  double onset = 0.0;         ///< the factor at which a moving joint begins to swing
  double hz = 0.0;            ///< there
  double smooth_onset = 0.0;  ///< the factor without the encoder's steps and the gate's limit
};

/// Nothing: no factor up to 100 makes the loop swing below the last line.
/// @pre with these gains the loop is stable
auto predict_limit_cycle(const Response& response, const LoopGains& gains) -> std::optional<LimitCycle>;
auto predict_limit_cycle(const Dense& all, const LoopGains& gains) -> std::optional<LimitCycle>;
/// The one of lower onset; nothing swings later than something.
auto sooner(const std::optional<LimitCycle>& a, const std::optional<LimitCycle>& b) -> std::optional<LimitCycle>;
/// Whether it swings with that multiple of the gains, or with less.
auto swings_by(const Dense& all, const LoopGains& gains, double factor) -> bool;
/// Where the shake of a travelling joint turned its motor about, friction turned with it and is in the response as
/// damping that no steady motion has, so the onset comes sooner than predicted: a sentence with its cure. Else nothing.
auto turned_about(const Response& response) -> std::string;
/// Amplitude of the motor, rad, once the swing is there, of a motor that goes at this speed.
auto swing_rad(const LimitCycle& cycle, double speed_rad_s) -> double;

/// "a moving joint begins to swing at ..." @param speed_rad_s  0: the joint of the log stood
auto sentence_of(const LimitCycle& cycle, double speed_rad_s) -> std::string;

}  // namespace capstan::tools
