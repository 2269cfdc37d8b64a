// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/tools/identify/least_squares.hpp"
#include "capstan/tools/identify/term_catalogue.hpp"

namespace capstan::tools {

/// How often a play of some half width turns round in the logs, and goes on by more than `least`.
/// @param q1  motor angle, all logs one below the other
auto turns_of_play(const Eigen::VectorXd& q1, const Blocks& logs, double half_width, double least) -> int;

/// Where the plays of a joint stand as a log of it begins, as a share of their half widths: 0 in the middle, 1 and -1
/// as a motion backward and forward leaves them. Told by which of five such starts a sum of plays of one sign
/// (Prandtl-Ishlinskii) and a cubic leave least of the joint angle; the middle, unless another leaves a tenth less,
/// mean square.
/// @param q1  motor angle and `q2` joint angle of one log, as many rows each
auto start_of_plays(const Eigen::VectorXd& q1, const Eigen::VectorXd& q2) -> double;

/// By how much a play that begins at that share of its half width is ahead of one that begins in its middle, each
/// sample: nothing more once they meet.
auto lead_of_play(const Samples& samples, double half_width, double start) -> Eigen::VectorXd;

}  // namespace capstan::tools
