// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/model/force_estimate.hpp"
#include "capstan/model/tendon.hpp"

namespace capstan {

/// Two tendons between two pulleys; "pulled" is the one the motor tightens. Host only.
struct TendonPair {
  Tendon pulled;
  Tendon pushed;
  double r1;  ///< input radius, m
  double r2;  ///< output radius, m
};

/// How the joint follows the motor within one phase, tip held: dtau_in / dq1 = stiffness and dtau_out = gain dtau_in.
struct PhaseStiffness {
  double stiffness;  ///< (3.19)-(3.21), N m/rad
  double gain;       ///< what of a change of motor torque reaches the joint, 1
};

/// Stiffness and gain of a phase. In phases I and II the fronts of the tendons that are not fully active count, in
/// (0, 1]; (3.20) takes the moving part as if it had been even before, so it is a lower bound there.
/// kOneSlack: (3.26), whose printed form lacks r1^2.
inline auto phase_stiffness(const TendonPair& pair, ForcePhase phase, double pulled_front = 1.0,
                            double pushed_front = 1.0) -> PhaseStiffness {
  const bool pulled_reaches = phase != ForcePhase::kHeld && phase != ForcePhase::kUnknown;
  const bool pushed_reaches = phase == ForcePhase::kBothActive;
  const double pulled = apparent_stiffness(pair.pulled, 1.0, pulled_reaches ? 1.0 : pulled_front);
  const double pushed =
      phase == ForcePhase::kOneSlack ? 0.0 : apparent_stiffness(pair.pushed, -1.0, pushed_reaches ? 1.0 : pushed_front);
  const double out = (pulled_reaches ? std::exp(-pair.pulled.eta) * pulled : 0.0) +
                     (pushed_reaches ? std::exp(pair.pushed.eta) * pushed : 0.0);
  return {pair.r1 * pair.r1 * (pulled + pushed), pair.r2 / pair.r1 * out / (pulled + pushed)};
}

/// Compliance that the motor feels, dq1 / dtau_in, rad/(N m), with the joint against a spring:
///   1 / K_t = 1 / K_dual + (r2 / r1) gain / K_env.
/// (3.22) and (3.24)-(3.26) print the second part as 1 / K_env. That holds only for equal radii in phase III; the
/// environment is seen through the ratio of the pulleys and through what friction lets pass.
inline auto combined_compliance(const TendonPair& pair, const PhaseStiffness& phase, double environment) -> double {
  return 1.0 / phase.stiffness + pair.r2 / pair.r1 * phase.gain / environment;
}

/// The same turned round: K_env from the compliance felt, N m/rad; negative or infinite where the measured compliance
/// is no more than the instrument's own.
inline auto environment_stiffness(const TendonPair& pair, const PhaseStiffness& phase, double compliance) -> double {
  return pair.r2 / pair.r1 * phase.gain / (compliance - 1.0 / phase.stiffness);
}

}  // namespace capstan
