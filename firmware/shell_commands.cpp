// SPDX-License-Identifier: Apache-2.0
#include "firmware/shell_commands.hpp"

#include <algorithm>

#include "firmware/version.hpp"

namespace capstan {

/// The commands' bodies. A struct only so that they may use the shell's private parts.
struct ShellCommands {
  static void help(Shell& shell, std::string_view arguments);
  static void version(Shell& shell, std::string_view arguments);
  static void status(Shell& shell, std::string_view arguments);
  static void faults(Shell& shell, std::string_view arguments);
  static void get(Shell& shell, std::string_view arguments);
  static void set(Shell& shell, std::string_view arguments);
  static void list(Shell& shell, std::string_view arguments);
  static void dump(Shell& shell, std::string_view arguments);
  static void diff(Shell& shell, std::string_view arguments);
  static void begin(Shell& shell, std::string_view arguments);
  static void commit(Shell& shell, std::string_view arguments);
  static void abandon(Shell& shell, std::string_view arguments);
  static void defaults(Shell& shell, std::string_view arguments);
  static void save(Shell& shell, std::string_view arguments);
  static void load(Shell& shell, std::string_view arguments);
  static void arm(Shell& shell, std::string_view arguments);
  static void disarm(Shell& shell, std::string_view arguments);
  static void move(Shell& shell, std::string_view arguments);
  static void hold(Shell& shell, std::string_view arguments);
  static void log(Shell& shell, std::string_view arguments);

 private:
  static void replay_lines(Shell& shell, bool changed_only);
  static void post(Shell& shell, const Request& request, Shell::Activity activity);
  static void begin_staging(Shell& shell);
};

namespace {

constexpr std::array kCommands = {
    ShellCommand{"help", "", "this list", ShellCommands::help},
    ShellCommand{"version", "", "firmware, board and number of parameters", ShellCommands::version},
    ShellCommand{"status", "", "state, joint angles, currents and active limits", ShellCommands::status},
    ShellCommand{"faults", "", "the latched fault and what would block arming, with causes and cures", ShellCommands::faults},
    ShellCommand{"get", "jointN.group.name", "one parameter with unit and range", ShellCommands::get},
    ShellCommand{"set", "jointN.group.name VALUE [UNIT]", "changes one parameter, or stages it after 'begin'", ShellCommands::set},
    ShellCommand{"list", "[jointN[.group]]", "parameters with unit, range and meaning", ShellCommands::list},
    ShellCommand{"dump", "", "all parameters as lines that can be pasted back", ShellCommands::dump},
    ShellCommand{"diff", "", "the same, only what differs from the defaults", ShellCommands::diff},
    ShellCommand{"begin", "", "starts staging: 'set' changes nothing until 'commit'", ShellCommands::begin},
    ShellCommand{"commit", "", "takes all staged parameters, or none", ShellCommands::commit},
    ShellCommand{"abandon", "", "forgets what was staged", ShellCommands::abandon},
    ShellCommand{"defaults", "", "stages the defaults of every parameter; 'commit' takes them", ShellCommands::defaults},
    ShellCommand{"save", "", "writes the parameters to storage (disarmed only)", ShellCommands::save},
    ShellCommand{"load", "", "reads them back from storage (disarmed only)", ShellCommands::load},
    ShellCommand{"arm", "", "gives torque, holding the joints where they are", ShellCommands::arm},
    ShellCommand{"disarm", "", "takes torque away and acknowledges a fault", ShellCommands::disarm},
    ShellCommand{"move", "jointN ANGLE [rad|deg]", "moves a joint within its limits", ShellCommands::move},
    ShellCommand{"hold", "jointN", "brakes a joint and holds it", ShellCommands::hold},
    ShellCommand{"log", "jointN COUNT [EVERY]", "prints COUNT samples as CSV, one every EVERY ms", ShellCommands::log},
};

}  // namespace

auto shell_commands() -> std::span<const ShellCommand> { return kCommands; }

void ShellCommands::help(Shell& shell, std::string_view /*arguments*/) {
  for (const ShellCommand& command : kCommands) {
    shell.out_ << "  " << command.name << ' ' << command.arguments << "\r\n      " << command.help << "\r\n";
  }
  shell.ok();
}

void ShellCommands::version(Shell& shell, std::string_view /*arguments*/) {
  shell.out_ << "capstan " << kVersion << " board " << shell.board_ << " joints "
             << static_cast<std::uint32_t>(shell.machine_.axes()) << " parameters "
             << static_cast<std::uint32_t>(parameters().size()) << "\r\n";
  shell.ok();
}

void ShellCommands::status(Shell& shell, std::string_view /*arguments*/) {
  static constexpr std::array<const char*, 5> kLimitNames = {"limits.current", "limits.continuous_current",
                                                             "limits.current_rate", "limits.motor_min/motor_max",
                                                             "limits.joint_min/joint_max/joint_speed"};
  const MachineTelemetry now = shell.machine_.telemetry();
  Print& out = shell.out_;
  out << "state " << name(now.state) << " fault " << info(now.first_fault).name << " cycles " << now.tick << " overruns "
      << now.overruns << "\r\n";
  for (std::size_t axis = 0; axis < shell.machine_.axes(); ++axis) {
    const AxisTelemetry joint = shell.machine_.axis_telemetry(axis);
    out << "joint" << static_cast<std::uint32_t>(axis) << " motor " << joint.q1_rad << " rad torque " << joint.tau_nm
        << " Nm joint " << joint.q2_rad << " rad" << (joint.estimate_valid ? "" : " (not valid)") << " reference "
        << joint.q2_reference_rad << " rad current " << joint.current_a << " A";
    for (std::size_t i = 0; i < kLimitNames.size(); ++i) {
      if ((joint.limits & (1U << i)) != 0) {
        out << " limited by " << kLimitNames[i];
      }
    }
    out << "\r\n";
  }
  shell.ok();
}

void ShellCommands::faults(Shell& shell, std::string_view /*arguments*/) {
  const MachineTelemetry now = shell.machine_.telemetry();
  const FaultInfo& first = info(now.first_fault);
  shell.out_ << "latched " << first.name << ": " << first.cause << "; " << first.cure << "\r\n";
  for (const FaultInfo& entry : kFaultTable) {
    if ((now.conditions & bit(entry.fault)) != 0) {
      shell.out_ << "present " << entry.name << ": " << entry.cause << "; " << entry.cure << "\r\n";
    }
  }
  shell.ok();
}

void ShellCommands::get(Shell& shell, std::string_view arguments) {
  Shell::Name wanted;
  if (!shell.parse_name(next_word(arguments), wanted)) {
    shell.error("unknown_parameter", "there is no such parameter", "'list' shows all of them");
    return;
  }
  const ParameterInfo& parameter = *wanted.parameter;
  shell.out_ << "joint" << static_cast<std::uint32_t>(wanted.axis) << '.' << parameter.group << '.' << parameter.name << ' ';
  print_value(shell.out_, parameter, raw_value(shell.machine_.config()[wanted.axis], parameter));
  shell.out_ << " (";
  print_range(shell.out_, parameter);
  shell.out_ << ")\r\n";
  shell.ok();
}

void ShellCommands::begin_staging(Shell& shell) {
  std::copy(shell.machine_.config().begin(), shell.machine_.config().end(), shell.staged_.begin());
}

void ShellCommands::set(Shell& shell, std::string_view arguments) {
  if (!shell.staging_) {
    begin_staging(shell);
  }
  if (!shell.stage(arguments)) {
    return;
  }
  if (shell.staging_) {
    shell.ok();
  } else {
    shell.commit();
  }
}

auto Shell::stage(std::string_view arguments) -> bool {
  Name wanted;
  if (!parse_name(next_word(arguments), wanted)) {
    error("unknown_parameter", "there is no such parameter", "'list' shows all of them");
    return false;
  }
  while (!arguments.empty() && arguments.front() == ' ') {
    arguments.remove_prefix(1);
  }
  const ParameterInfo& parameter = *wanted.parameter;
  std::int32_t raw = 0;
  const ValueError problem = parse_value(arguments, parameter, raw);
  if (problem == ValueError::kNone) {
    set_raw_value(staged_[wanted.axis], parameter, raw);
    return true;
  }
  out_ << "error " << (problem == ValueError::kNotANumber ? "not_a_number" : problem == ValueError::kUnit ? "unit" : "range")
       << ": " << parameter.group << '.' << parameter.name << " takes ";
  print_range(out_, parameter);
  out_ << " and nothing was changed; give a "
       << (problem == ValueError::kRange ? "value in that range" : "number, with that unit or none") << "\r\n";
  prompt();
  return false;
}

void Shell::commit() {
  const bool live = energised(machine_.telemetry().state);
  const std::span<const AxisConfig> now = machine_.config();
  for (std::size_t axis = 0; axis < now.size(); ++axis) {
    for (const ParameterInfo& parameter : parameters()) {
      if (live && parameter.change == ParameterChange::kDisarmed &&
          raw_value(now[axis], parameter) != raw_value(staged_[axis], parameter)) {
        error("armed", "the model, the motor and the limits change only without torque, and nothing was changed",
              "'disarm' first");
        return;
      }
    }
    if (const char* problem = check(staged_[axis])) {
      error("inconsistent", problem, "nothing was changed");
      return;
    }
  }
  staging_ = false;
  if (!machine_.configure(std::span(staged_).first(now.size()))) {
    error("busy", "the cycle has not taken the last change yet", "send the line again");
    return;
  }
  activity_ = Activity::kApplying;
}

void ShellCommands::list(Shell& shell, std::string_view arguments) {
  std::string_view filter = next_word(arguments);
  std::size_t only = 0;
  const bool one_axis = !filter.empty();
  if (one_axis && !shell.parse_axis(filter, only)) {
    shell.error("unknown_joint", "there is no such joint", "give joint0 and so on, or nothing");
    return;
  }
  if (!filter.empty()) {
    filter.remove_prefix(1);  // the dot; what is left is a group
  }
  for (std::size_t axis = 0; axis < shell.machine_.axes(); ++axis) {
    for (const ParameterInfo& parameter : parameters()) {
      if ((one_axis && axis != only) || (!filter.empty() && filter != parameter.group)) {
        continue;
      }
      shell.out_ << "joint" << static_cast<std::uint32_t>(axis) << '.' << parameter.group << '.' << parameter.name << ' ';
      print_value(shell.out_, parameter, raw_value(shell.machine_.config()[axis], parameter));
      shell.out_ << " (";
      print_range(shell.out_, parameter);
      shell.out_ << ") " << parameter.doc << "\r\n";
    }
  }
  shell.ok();
}

void ShellCommands::replay_lines(Shell& shell, bool changed_only) {
  const AxisConfig fresh;
  shell.out_ << "begin\r\n";
  for (std::size_t axis = 0; axis < shell.machine_.axes(); ++axis) {
    for (const ParameterInfo& parameter : parameters()) {
      const std::int32_t raw = raw_value(shell.machine_.config()[axis], parameter);
      if (changed_only && raw == raw_value(fresh, parameter)) {
        continue;
      }
      shell.out_ << "set joint" << static_cast<std::uint32_t>(axis) << '.' << parameter.group << '.' << parameter.name << ' ';
      print_value(shell.out_, parameter, raw);
      shell.out_ << "\r\n";
    }
  }
  shell.out_ << "commit\r\n";
  shell.ok();
}

void ShellCommands::dump(Shell& shell, std::string_view /*arguments*/) { replay_lines(shell, false); }
void ShellCommands::diff(Shell& shell, std::string_view /*arguments*/) { replay_lines(shell, true); }

void ShellCommands::begin(Shell& shell, std::string_view /*arguments*/) {
  begin_staging(shell);
  shell.staging_ = true;
  shell.ok();
}

void ShellCommands::commit(Shell& shell, std::string_view /*arguments*/) {
  if (!shell.staging_) {
    shell.error("not_staging", "nothing is staged", "'begin', then 'set' what you want to change");
    return;
  }
  shell.commit();
}

void ShellCommands::abandon(Shell& shell, std::string_view /*arguments*/) {
  shell.staging_ = false;
  shell.ok();
}

void ShellCommands::defaults(Shell& shell, std::string_view /*arguments*/) {
  shell.staged_.fill(AxisConfig{});
  shell.staging_ = true;
  shell.ok();
}

void ShellCommands::save(Shell& shell, std::string_view /*arguments*/) {
  if (energised(shell.machine_.telemetry().state)) {
    shell.error("armed", "saving stops the processor for up to seconds", "'disarm' first");
  } else if (!shell.machine_.save()) {
    shell.error("storage", "the storage did not take the parameters, and the old set is still there",
                "'save' again; if that fails too the memory is worn or write protected");
  } else {
    shell.ok();
  }
}

void ShellCommands::load(Shell& shell, std::string_view /*arguments*/) {
  if (energised(shell.machine_.telemetry().state)) {
    shell.error("armed", "a model changes only without torque", "'disarm' first");
    return;
  }
  switch (shell.machine_.load()) {
    case LoadResult::kLoaded:
      shell.staging_ = false;
      shell.activity_ = Shell::Activity::kApplying;
      break;
    case LoadResult::kEmpty:
      shell.error("storage_empty", "nothing was ever saved, and nothing was changed", "'set' what you want and 'save'");
      break;
    case LoadResult::kCorrupt:
      shell.error("storage_corrupt", "no bank holds a whole set, and nothing was changed", "load a model and 'save' it");
      break;
  }
}

void ShellCommands::post(Shell& shell, const Request& request, Shell::Activity activity) {
  if (shell.machine_.post(request)) {
    shell.activity_ = activity;
  } else {
    shell.error("busy", "the cycle has not taken the last request yet", "send the line again");
  }
}

void ShellCommands::arm(Shell& shell, std::string_view /*arguments*/) {
  post(shell, {.kind = Request::Kind::kArm}, Shell::Activity::kArming);
}

void ShellCommands::disarm(Shell& shell, std::string_view /*arguments*/) {
  post(shell, {.kind = Request::Kind::kDisarm}, Shell::Activity::kDisarming);
}

void ShellCommands::move(Shell& shell, std::string_view arguments) {
  std::string_view joint = next_word(arguments);
  Request request{.kind = Request::Kind::kMove};
  if (!shell.parse_axis(joint, request.axis) || !joint.empty()) {
    shell.error("unknown_joint", "there is no such joint", "write 'move joint0 30 deg'");
    return;
  }
  while (!arguments.empty() && arguments.front() == ' ') {
    arguments.remove_prefix(1);
  }
  const LimitConfig& limits = shell.machine_.config()[request.axis].limits;
  const ValueError problem = parse_quantity(arguments, "rad", request.position_rad);
  if (problem == ValueError::kNotANumber || problem == ValueError::kUnit) {
    shell.error("not_an_angle", "the target is not an angle", "write 'move joint0 0.5 rad' or 'move joint0 30 deg'");
    return;
  }
  if (problem == ValueError::kRange || request.position_rad < limits.joint_min_rad ||
      request.position_rad > limits.joint_max_rad) {
    shell.error("range", "the target is outside limits.joint_min and limits.joint_max", "give one inside");
    return;
  }
  if (!energised(shell.machine_.telemetry().state)) {
    shell.error("not_armed", "nothing moves without torque", "'arm' first");
    return;
  }
  request.speed_rad_s = limits.joint_speed_rad_s;
  post(shell, request, Shell::Activity::kMoving);
}

void ShellCommands::hold(Shell& shell, std::string_view arguments) {
  std::string_view joint = next_word(arguments);
  Request request{.kind = Request::Kind::kStop};
  if (!shell.parse_axis(joint, request.axis) || !joint.empty()) {
    shell.error("unknown_joint", "there is no such joint", "write 'hold joint0'");
    return;
  }
  post(shell, request, Shell::Activity::kMoving);
}

void ShellCommands::log(Shell& shell, std::string_view arguments) {
  constexpr std::int32_t kLongest = 1'000'000;
  std::string_view joint = next_word(arguments);
  const std::string_view count_text = next_word(arguments);
  const std::string_view every_text = next_word(arguments);
  std::int32_t count = 0;
  std::int32_t every = 1;
  if (!shell.parse_axis(joint, shell.log_axis_) || !joint.empty() ||
      parse_integer(count_text, count) != ParseResult::kOk || count < 1 || count > kLongest ||
      (!every_text.empty() && parse_integer(every_text, every) != ParseResult::kOk) || every < 1 || every > 1000) {
    shell.error("usage", "log takes a joint, a count up to 1000000 and a spacing of 1 to 1000 ms",
                "write 'log joint0 100 10'");
    return;
  }
  LogSample stale;
  while (shell.machine_.next_sample(stale)) {
  }
  shell.log_left_ = static_cast<std::uint32_t>(count);
  shell.log_every_ = static_cast<std::uint32_t>(every);
  shell.log_dropped_before_ = shell.machine_.dropped_samples();
  const auto axis = static_cast<std::uint32_t>(shell.log_axis_);
  Print& out = shell.out_;
  out << "time_s";
  for (const char* column : {"q1_rad", "tau_Nm", "q2_est_rad", "q2_ref_rad", "current_A"}) {
    out << ",axis" << axis << '/' << column;
  }
  out << "\r\n";
  shell.machine_.record(true, shell.log_axis_);
  shell.activity_ = Shell::Activity::kLogging;
}

}  // namespace capstan
