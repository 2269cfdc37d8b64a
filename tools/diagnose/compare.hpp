// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/tools/diagnose/diagnosis.hpp"

namespace capstan::tools {

/// A parameter whose 95 % intervals at two times do not meet.
struct MovedParameter {
  std::string name, unit;  ///< "motor_angle.beta"
  double healthy = 0.0, now = 0.0;
  Interval healthy_ci95 = {}, now_ci95 = {};
};

/// What has changed between two times of one joint.
struct Comparison {
  std::vector<std::string> terms;     ///< of the law that both are measured by
  std::vector<MovedParameter> moved;  ///< most spreads first
  std::vector<AddedEffect> came;      ///< effects that the law of the healthy joint lacks now
  Diagnosis healthy, now;             ///< `now` begins from the healthy joint's law
};

/// Diagnoses the healthy joint, fits its law, as far as it has names, to the logs of both times, and asks what it lacks
/// now. Throws as diagnose(), and Refusal where the healthy logs are not fit for a diagnosis or hold no law.
auto compare(const std::vector<AxisLog>& healthy, const std::vector<AxisLog>& now, const DiagnoseOptions& options)
    -> Comparison;

/// Schema capstan.comparison/1.
auto comparison_json(const Comparison& comparison) -> std::string;

}  // namespace capstan::tools
