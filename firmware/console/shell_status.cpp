// SPDX-License-Identifier: Apache-2.0
// The shell's view of what the machine does now.
#include "capstan/firmware/console/shell_commands.hpp"

#include "capstan/firmware/control/modes.hpp"

namespace capstan {
namespace {

/// How far the force law may be off while its past is unknown: half of the widest that its loop gets.
auto widest(const ForceConfig::Law::Grid::Table& grid) -> Q24 {
  Q24 most;
  const std::size_t last = grid.levels - 1;
  for (std::size_t level = 0; level < grid.levels; ++level) {
    most = std::max(most, grid.force(last, level) - grid.force(level, level));
  }
  return most * Q24::from_double(0.5);
}

void print_force(Print& out, const AxisTelemetry& joint, const ForceConfig& force) {
  if (force.law == 0 && joint.joint_torque_phase == ForcePhase::kUnknown) {
    return;  // neither a law of forces nor tendons in the law of motion
  }
  out << " force " << joint.joint_torque_nm << " Nm";
  if (!joint.estimate_valid) {
    out << " (not valid)";
    return;
  }
  if (joint.mode == ControlMode::kForce) {
    out << " of " << joint.joint_torque_reference_nm << " Nm";
  }
  if (joint.joint_torque_error_nm >= Q24{}) {
    out << " within " << joint.joint_torque_error_nm << " Nm";
  }
  if (joint.joint_torque_known) {
    return;
  }
  if (force.law == static_cast<std::int32_t>(ForceLawKind::kPreisach)) {
    out << " (past unknown: within " << widest(force.grid) << " Nm until the motor's torque was at an end of its grid)";
  } else {
    out << " (past unknown: right once the motor's torque has passed the tendons)";
  }
}

void print_disturbance(Print& out, const AxisTelemetry& joint, const EffortConfig& effort) {
  if (!is_on(effort.law)) {
    return;
  }
  out << " disturbance " << joint.disturbance_nm << " Nm" << (joint.disturbance_known ? "" : " (not known yet)");
}

/// Zeros are no tip: they are the pitch axis itself.
void print_tip(Print& out, const AxisTelemetry& joint) {
  if (joint.tip_m != std::array<Q24, 3>{}) {
    out << " tip " << joint.tip_m[0] << ' ' << joint.tip_m[1] << ' ' << joint.tip_m[2] << " m";
  }
}

void print_thermometer(Print& out, const MachineTelemetry& now) {
  if (ScalarTraits<Q24>::is_missing(now.temperature_c)) {
    out << "thermometer none: thermal_drift has no temperature\r\n";
    return;
  }
  out << "thermometer " << now.temperature_c << " C"
      << (now.warnings == 0 ? "" : ", silent now: thermal_drift stays at this value") << "\r\n";
}

}  // namespace

void print_warnings(Print& out, WarningSet warnings) {
  for (const WarningInfo& entry : kWarningTable) {
    if ((warnings & bit(entry.code)) != 0) {
      out << "  warning " << entry.name << ": " << entry.cause << "; " << entry.cure << "\r\n";
    }
  }
}

void print_tendons(Print& out, const AxisTelemetry& joint) {
  if (joint.tendons != TendonHealth::kNothing) {
    const TendonHealthInfo& tendons = info(joint.tendons);
    out << "  tendons " << tendons.name << ": " << tendons.cause << "; " << tendons.cure << "\r\n";
  }
}

namespace {

void print_machine(Session& session, const MachineTelemetry& now) {
  Print& out = session.out();
  out << "state " << name(now.state) << " fault " << info(now.first_fault).name << " cycles " << now.tick
      << " overruns " << now.overruns << "\r\n";
  if (const LoadReport& report = session.machine().load_report();
      report.older || report.migrated() || report.result == LoadResult::kForeign) {
    print_load_report(out, report, "");
  }
}

void print_joint(Session& session, std::size_t axis) {
  Print& out = session.out();
  const AxisTelemetry joint = session.machine().axis_telemetry(axis);
  out << "joint" << static_cast<std::uint32_t>(axis);
  if (session.machine().config()[axis].motor.fitted == 0) {
    out << " not fitted\r\n";
    return;
  }
  out << " motor " << joint.q1_rad << " rad torque " << joint.tau_nm << " Nm joint " << joint.q2_rad << " rad"
      << (joint.estimate_valid ? "" : " (not valid)") << " reference " << joint.q2_reference_rad << " rad current "
      << joint.current_a << " A";
  if ((joint.faults & (bit(Fault::kSensorMissing) | bit(Fault::kSensorInvalid))) != 0) {
    out << " (the last values of a sensor that is missing or invalid)";
  }
  if (joint.mode == ControlMode::kMotor) {
    out << " motor reference " << joint.q1_reference_rad << " rad";
  }
  print_disturbance(out, joint, session.machine().config()[axis].effort);
  print_force(out, joint, session.machine().config()[axis].force);
  if (joint.q2_error_rad >= Q24{}) {
    out << " within " << joint.q2_error_rad << " rad";
  }
  if (joint.tension > Q24{}) {
    out << " tension " << joint.tension << " of the healthy joint's";
  }
  if (joint.pretension_n > Q24{}) {
    out << " pretension " << joint.pretension_n << " +-" << joint.pretension_95_n << " N";
  }
  print_tip(out, joint);
  for (const LimitInfo& info : kLimitTable) {
    if ((joint.limits & bit(info.limit)) != 0) {
      out << " limited by " << info.settings;
    }
  }
  out << "\r\n";
  print_law_status(out, session.machine().config()[axis]);
  print_warnings(out, joint.warnings);
  print_tendons(out, joint);
}

/// The machine, its joints, and what belongs to none of them.
class StatusStream final : public PartsStream {
  auto print(Session& session, std::uint32_t part) -> bool override {
    const MachineTelemetry now = session.machine().telemetry();
    if (part == 0) {
      print_machine(session, now);
    } else if (part <= session.machine().axes()) {
      print_joint(session, part - 1);
    } else {
      print_thermometer(session.out(), now);
      session.ok();
      return false;
    }
    return true;
  }
};

}  // namespace

void commands::status(Session& session, std::string_view /*arguments*/) {
  session.answer(session.make<StatusStream>());
}

}  // namespace capstan
