// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/tools/identify/least_squares.hpp"

namespace capstan::tools {

/// Rows before the motor has once covered most of its range say nothing of a law: the joint's place depends there on a
/// motion that was not logged. Chosen with the other numbers of select/deciding_numbers.hpp: without it catheter_2_3
/// was 2.15 times a plain fit instead of 0.87, wrist_single_q5 2.12 instead of 1.42.
struct SettlingRule {
  double share_of_range = 0.9;
  double most_share_of_rows = 0.25;  ///< at most this share of a log is left out for it
};

/// Rows of each log from where it has settled. @param q1  motor angle, all logs one below the other
auto settled_rows(const Eigen::VectorXd& q1, const Blocks& logs, const SettlingRule& rule = {}) -> Blocks;

}  // namespace capstan::tools
