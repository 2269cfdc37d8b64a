// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/tools/diagnose/diagnosis.hpp"

namespace capstan::tools {

/// A parameter that differs between two times by more than both intervals and chance allow.
struct MovedParameter {
  std::string name, unit;  ///< "motor_angle.beta"
  double healthy = 0.0, now = 0.0;
  Interval healthy_ci95 = {}, now_ci95 = {};
};

/// Of two fits of one law, most spreads first. A thousandth of pairs that differ by chance alone have one at all.
auto moved_between(const JointFile& healthy, const JointFile& now) -> std::vector<MovedParameter>;
/// "motor_angle.beta moved from 0.9 [0.89, 0.91] to 0.95 [0.94, 0.96] 1", with digits enough to tell the figures apart.
auto moved_sentence(const MovedParameter& one) -> std::string;

/// What has changed between two times of one joint.
struct Comparison {
  std::vector<std::string> terms;                  ///< of the law that both are measured by
  std::vector<MovedParameter> moved;               ///< most spreads first
  std::vector<AddedEffect> came;                   ///< effects that the healthy joint did not have
  Diagnosis healthy, now;                          ///< of an angle `now` begins from the healthy joint's law
  std::optional<PretensionDrift> pretension = {};  ///< of now, and what it has changed by between the two times
};

/// What a healthy joint is compared by, worked out once for any number of later times.
struct HealthyJoint {
  Diagnosis diagnosis;
  JointFile law;     ///< as far as it has names
  JointFile fitted;  ///< the same fitted to all of the logs, with intervals
  /// Ratio and zero beside a loop in place of tendons, which are the healthy joint's and bend both where they have
  /// changed.
  std::optional<JointFile> by_loop = {};
};

/// A law of the options is the joint's, of whatever time: both times are then measured by it.
/// Throws as diagnose(), and Refusal where the logs are not fit for a diagnosis or hold no law.
auto healthy_joint(const std::vector<AxisLog>& logs, const DiagnoseOptions& options) -> HealthyJoint;

/// Fits the healthy joint's law to the logs of now, and asks what it lacks there. Throws as diagnose().
auto compare(const HealthyJoint& healthy, const std::vector<AxisLog>& now, const DiagnoseOptions& options)
    -> Comparison;
/// Both, one after the other.
auto compare(const std::vector<AxisLog>& healthy, const std::vector<AxisLog>& now, const DiagnoseOptions& options)
    -> Comparison;

/// Schema capstan.comparison/1.
auto comparison_json(const Comparison& comparison) -> std::string;

}  // namespace capstan::tools
