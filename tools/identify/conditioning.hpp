// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "capstan/tools/identify/term_catalogue.hpp"
#include "capstan/tools/log/axis_log.hpp"

namespace capstan::tools {

/// What a running law is given at each sample of a log. The joint angle is left to the law.
auto measured_series(const AxisLog& log) -> std::vector<Measured<double>>;

/// What the firmware's conditioner makes of a log, sample by sample. The joint angle of the last cycle is the measured
/// one, where there is one: a fit has no estimate yet.
auto causal_samples(const AxisLog& log, const ConditionerShape<double>& shape) -> Samples;

/// Resolution and noise of the motor angle, rad.
struct AngleNoise {
  double step_rad = 0.0;   ///< of the encoder; 0 if none is seen
  double white_rad = 0.0;  ///< standard deviation
};
auto motor_angle_noise(const std::vector<AxisLog>& logs) -> AngleNoise;

/// Thresholds for the direction switch worth trying, rad, ascending. The first is just above what noise alone can do:
/// 1.5 encoder steps or 8 standard deviations, whichever is more; 0.75 steps where the logs show that the encoder does
/// not tremble on its edges. None is above 2 % of the motion.
auto direction_thresholds(const std::vector<AxisLog>& logs, const AngleNoise& noise) -> std::vector<double>;

/// Samples per direction between two switches, and the torque of steady motion.
auto direction_changes(const Samples& samples) -> std::vector<std::size_t>;

/// Mean over 2 h + 1 neighbours within each log; fewer at its ends.
auto moving_mean(const Eigen::MatrixXd& columns, const std::vector<Eigen::Index>& log_rows, Eigen::Index half_width)
    -> Eigen::MatrixXd;

/// Mean of every `factor` rows. @pre the number of rows is a multiple of it
auto decimated(const Eigen::MatrixXd& columns, Eigen::Index factor) -> Eigen::MatrixXd;

}  // namespace capstan::tools
