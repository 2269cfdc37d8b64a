// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "capstan/tests/tools/plant/told_errors.hpp"
#include "capstan/tools/identify/force_fit.hpp"

namespace capstan::tools::plant {

/// A drawn instrument turned by hand, tip held or against a spring.
/// @param learning  whose strokes, to identify it from: pull_push, preisach; empty: a wandering motion
auto force_log_of(const std::string& learning, std::uint64_t seed, double spring_nm_per_rad) -> AxisLog;

/// What a board's error bars of the joint's torque are worth, in its own numbers; widths and errors in N m.
/// @param section  a joint file with the force law
auto told_torque_errors(const std::string& section, const AxisLog& log) -> ToldErrors;

/// The force law of a drawn instrument with its tip held, as a joint file.
auto force_file_of(const std::string& model, std::uint64_t seed) -> std::string;

/// Prints what error bars of force laws made in one motion are worth in another, on joints drawn by these seeds.
void ask_torque_error_bars(std::uint64_t first, int joints);

}  // namespace capstan::tools::plant
