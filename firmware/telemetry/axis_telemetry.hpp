// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/firmware/control/modes.hpp"
#include "capstan/firmware/estimate/tendon_health.hpp"
#include "capstan/firmware/safety/warnings.hpp"

namespace capstan {

/// One joint's numbers of the last cycle, for shell, log and telemetry. Written at the end of a cycle from the values
/// that went down it. No stage of the cycle reads them; an experiment does, to choose what it asks in the next cycle.
struct AxisTelemetry {
  Q24 q1_rad;
  Q24 tau_nm;
  Q24 q2_rad;           ///< estimated joint angle
  Q24 q2_reported_rad;  ///< what a joint sensor with the law's sensor effects would say
  Q24 q2_error_rad;     ///< how far from the joint that may be, 95 of 100 times; negative: not known
  Q24 q2_reference_rad;
  Q24 q1_reference_rad;           ///< where the servo holds the motor; its own angle while there is none
  Q24 current_a;                  ///< measured
  Q24 drive_a;                    ///< commanded
  Q24 drive_nm;                   ///< the torque of that
  Q24 excitation_nm;              ///< of it, what an experiment added
  Q24 joint_torque_nm;            ///< by the force law or the tendons of the law, 0 without either
  Q24 joint_torque_error_nm;      ///< how far from the joint's torque that may be, 95 of 100 times; negative: not known
  Q24 joint_torque_reference_nm;  ///< wanted, in force control
  Q24 law_torque_nm;              ///< by the effort law for the motion a quarter of its window ago, 0 without one
  Q24 disturbance_nm;             ///< measured torque of that instant less the law's, filtered; 0 while not known
  Q24 misfit;                     ///< how near the monitor is to a warning, 0 to 1
  Q24 tension;                    ///< of the tendons, as a share of the healthy joint's; 0: not known
  Q24 pretension_n;               ///< of the tendons, N; 0: not known
  Q24 pretension_95_n;            ///< half of its 95 % interval
  std::array<Q24, 3> tip_m{};     ///< of a wrist's jaw, from its pitch axis, (6.12); zeros where there is none
  FaultSet faults = 0;            ///< present now
  LimitSet limits = 0;
  bool estimate_valid = false;
  bool disturbance_known = false;
  bool joint_torque_known = false;  ///< the force law's past no longer matters
  ForcePhase joint_torque_phase = ForcePhase::kUnknown;
  WarningSet warnings = 0;
  TendonHealth tendons = TendonHealth::kNothing;
  ControlMode mode = ControlMode::kPosition;
  bool moving = false;           ///< its reference is, or comes as a stream
  std::int32_t look_counts = 0;  ///< of the last look at rest without a load, LookAnswer
  Q24 look_a;                    ///< torque that made it
  std::uint32_t looks = 0;       ///< how many there were; wraps
};

}  // namespace capstan
