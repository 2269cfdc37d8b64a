// SPDX-License-Identifier: Apache-2.0
// The shell's view of what the machine does now, and its way into force control.
#include "firmware/shell_commands.hpp"

namespace capstan {
namespace {

constexpr std::array<const char*, 6> kLimitNames = {"limits.current",
                                                    "limits.continuous_current",
                                                    "limits.current_rate",
                                                    "limits.motor_min/motor_max",
                                                    "limits.joint_min/joint_max/joint_speed",
                                                    "limits.joint_torque or the reach of the force law"};

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
  if (force.law == 0) {
    return;
  }
  out << " force " << joint.joint_torque_nm << " Nm";
  if (joint.mode == ControlMode::kForce) {
    out << " of " << joint.joint_torque_reference_nm << " Nm";
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

void print_thermometer(Print& out, const MachineTelemetry& now) {
  if (ScalarTraits<Q24>::is_missing(now.temperature_c)) {
    out << "thermometer none: thermal_drift knows no temperature\r\n";
    return;
  }
  out << "thermometer " << now.temperature_c << " C"
      << (now.warnings == 0 ? "" : ", silent now: thermal_drift stays at this value") << "\r\n";
}

}  // namespace

void Shell::print_warnings(WarningSet warnings) {
  for (const WarningInfo& entry : kWarningTable) {
    if ((warnings & bit(entry.warning)) != 0) {
      out_ << "  warning " << entry.name << ": " << entry.cause << "; " << entry.cure << "\r\n";
    }
  }
}

void ShellCommands::status(Shell& shell, std::string_view /*arguments*/) {
  const MachineTelemetry now = shell.machine_.telemetry();
  Print& out = shell.out_;
  out << "state " << name(now.state) << " fault " << info(now.first_fault).name << " cycles " << now.tick
      << " overruns " << now.overruns << "\r\n";
  for (std::size_t axis = 0; axis < shell.machine_.axes(); ++axis) {
    const AxisTelemetry joint = shell.machine_.axis_telemetry(axis);
    out << "joint" << static_cast<std::uint32_t>(axis);
    if (shell.machine_.config()[axis].motor.fitted == 0) {
      out << " not fitted\r\n";
      continue;
    }
    out << " motor " << joint.q1_rad << " rad torque " << joint.tau_nm << " Nm joint " << joint.q2_rad << " rad"
        << (joint.estimate_valid ? "" : " (not valid)") << " reference " << joint.q2_reference_rad << " rad current "
        << joint.current_a << " A";
    print_force(out, joint, shell.machine_.config()[axis].force);
    for (std::size_t i = 0; i < kLimitNames.size(); ++i) {
      if ((joint.limits & (1U << i)) != 0) {
        out << " limited by " << kLimitNames[i];
      }
    }
    out << "\r\n";
    shell.print_warnings(joint.warnings);
  }
  print_thermometer(out, now);
  shell.ok();
}

/// "force=TORQUE [rate=R]"
void ShellCommands::move_force(Shell& shell, std::size_t axis, std::string_view arguments) {
  const AxisConfig& config = shell.machine_.config()[axis];
  Request request{.kind = Request::Kind::kForce, .axis = axis, .torque_rate_nm_s = config.force.rate_nm_per_s};
  for (std::string_view word = next_word(arguments); !word.empty(); word = next_word(arguments)) {
    const std::size_t sign = std::min(word.find('='), word.size());
    const std::string_view name(word.data(), sign);
    std::string_view value(word.data() + std::min(sign + 1, word.size()),
                           word.size() - std::min(sign + 1, word.size()));
    const bool force = name == "force";
    if ((!force && name != "rate") ||
        parse_quantity(value, force ? "Nm" : "Nm/s", force ? request.joint_torque_nm : request.torque_rate_nm_s) !=
            ValueError::kNone) {
      shell.error("not_a_torque", "the target is not a joint torque with an optional rate, and nothing was done",
                  "write 'move joint0 force=0.05Nm rate=0.02Nm/s'");
      return;
    }
  }
  if (abs(request.joint_torque_nm) > config.limits.joint_torque_nm || request.torque_rate_nm_s <= Q24{}) {
    shell.out_ << "error range: the joint's torque goes up to limits.joint_torque " << config.limits.joint_torque_nm
               << " Nm at a rate above 0, and nothing was done; give a target in that range\r\n";
    shell.prompt();
    return;
  }
  if (config.force.law == 0) {
    shell.error("no_force_law", "force control turns a force law round, and this joint has none",
                "identify one with the tip held and 'capstan apply' it");
    return;
  }
  const State state = shell.machine_.telemetry().state;
  const AxisTelemetry joint = shell.machine_.axis_telemetry(axis);
  if (!energised(state)) {
    shell.error("not_armed", "nothing presses without torque", "'arm' first");
  } else if (state == State::kExperiment || (joint.moving && joint.mode != ControlMode::kForce)) {
    shell.error("moving", "force control begins with the joint at rest, and it moves", "'hold' it first");
  } else {
    post(shell, request, Shell::Activity::kMoving);
  }
}

}  // namespace capstan
