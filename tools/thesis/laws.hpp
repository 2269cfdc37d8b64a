// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "capstan/hal/sim/motion.hpp"
#include "capstan/tools/joint_file/joint_file.hpp"
#include "capstan/tools/log/axis_log.hpp"

namespace capstan::tools {

/// The three laws that the tables compare, fitted to the same logs.
struct Laws {
  JointFile kinematic;  ///< KM: q2 = beta q1
  JointFile thesis;     ///< PM: (5.28), or (6.21) with drag
  JointFile augmented;  ///< PM with the offset of the zero, pretension_offset, slip_propagation and what `extra` names
};

/// @param drag   PM is the dynamic law (6.21)
/// @param extra  further effects of the catalogue for the augmented law
auto fit_laws(const std::vector<AxisLog>& logs, bool drag, const std::vector<std::string>& extra = {}) -> Laws;

/// Root mean square of what a law running free is off, deg.
auto law_error_deg(const AxisLog& log, const JointFile& law) -> double;
auto rms_deg(const Eigen::VectorXd& angle_rad) -> double;

/// alpha_t, alpha_b, beta of a law, as the thesis lists them.
auto parameter_line(const JointFile& law) -> std::string;

/// A motion from rest of one sine.
auto sine(double amplitude_deg, double frequency_hz, double duration_s) -> sim::Motion;
/// Schroeder-phased sum of sines (5.31) of this root mean square.
auto multisine(double rms_deg, const std::vector<double>& frequencies_hz, double duration_s) -> sim::Motion;
/// amplitude exp(-decay t) sin(2 pi f t).
auto decaying_sine(double amplitude_deg, double frequency_hz, double decay_per_s, double duration_s) -> sim::Motion;

}  // namespace capstan::tools
