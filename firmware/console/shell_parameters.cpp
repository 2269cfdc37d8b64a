// SPDX-License-Identifier: Apache-2.0
// The shell's commands that read and change parameters.
#include <algorithm>

#include "capstan/firmware/console/shell_commands.hpp"

namespace capstan {
namespace {

constexpr AxisConfig kFresh;

auto is_group(std::string_view name) -> bool {
  const auto all = parameters();
  return std::any_of(all.begin(), all.end(),
                     [name](const ParameterInfo& parameter) { return name == parameter.group; });
}

}  // namespace

void ShellCommands::get(Shell& shell, std::string_view arguments) {
  Shell::Name wanted;
  if (!shell.parse_name(next_word(arguments), wanted)) {
    shell.error("unknown_parameter", "there is no such parameter", "'list' shows all of them");
    return;
  }
  const ParameterInfo& parameter = *wanted.parameter;
  shell.out_ << "joint" << static_cast<std::uint32_t>(wanted.axis) << '.' << parameter.group << '.' << parameter.name
             << ' ';
  print_value(shell.out_, parameter, raw_value(shell.machine_.config()[wanted.axis], parameter));
  shell.out_ << " (";
  print_range(shell.out_, parameter);
  shell.out_ << ")\r\n";
  shell.ok();
}

/// `name`: "group.name" or "group", with or without a joint before it.
void ShellCommands::help_parameters(Shell& shell, std::string_view name) {
  std::size_t axis = 0;
  std::string_view rest = name;
  if (shell.parse_axis(rest, axis) && rest.size() > 1 && rest.front() == '.') {
    name = std::string_view(rest.data() + 1, rest.size() - 1);
  }
  const ParameterInfo* one = find_parameter(name);
  bool found = false;
  for (const ParameterInfo& parameter : parameters()) {
    if (&parameter != one && name != parameter.group) {
      continue;
    }
    found = true;
    Print& out = shell.out_;
    out << "  " << parameter.group << '.' << parameter.name << ": " << parameter.doc << "\r\n      ";
    print_range(out, parameter);
    out << ", default ";
    print_value(out, parameter, raw_value(kFresh, parameter));
    switch (parameter.change) {
      case ParameterChange::kAnyTime:
        out << ", changes at any time\r\n";
        break;
      case ParameterChange::kDisarmed:
        out << ", changes while disarmed\r\n";
        break;
      case ParameterChange::kMaintenance:
        out << ", changes while disarmed and in maintenance\r\n";
        break;
    }
  }
  if (found) {
    shell.ok();
  } else {
    shell.error("unknown_topic", "there is no such command, parameter or group",
                "'help' lists the commands, 'list' the parameters");
  }
}

/// Takes the room for a new set, with the one in force in it. False: another console has it, and that was answered.
auto Shell::begin_staging() -> bool {
  staged_ = machine_.staging(this);
  if (staged_.empty()) {
    error("staging", "another console puts a set together, and nothing was changed", "'commit' or 'abandon' it there");
    return false;
  }
  std::copy(machine_.config().begin(), machine_.config().end(), staged_.begin());
  return true;
}

void Shell::abandon() {
  staging_ = false;
  staged_ = {};
  machine_.end_staging(this);
}

void ShellCommands::set(Shell& shell, std::string_view arguments) {
  if (shell.staging_) {
    if (shell.stage(arguments)) {
      shell.ok();
    }
    return;
  }
  if (!shell.begin_staging()) {
    return;
  }
  if (shell.stage(arguments)) {
    shell.commit();
  }
  shell.abandon();  // what is to be taken is on its way, and what was refused is forgotten
}

auto Shell::stage(std::string_view arguments) -> bool {
  Name wanted;
  if (!parse_name(next_word(arguments), wanted)) {
    error("unknown_parameter", "there is no such parameter", "'list' shows all of them");
    return false;
  }
  const ParameterInfo& parameter = *wanted.parameter;
  std::int32_t raw = 0;
  const ValueError problem = parse_value(arguments, parameter, raw);
  if (problem == ValueError::kNone) {
    set_raw_value(staged_[wanted.axis], parameter, raw);
    return true;
  }
  out_ << "error "
       << (problem == ValueError::kNotANumber ? "not_a_number"
           : problem == ValueError::kUnit     ? "unit"
                                              : "range")
       << ": " << parameter.group << '.' << parameter.name << " takes ";
  print_range(out_, parameter);
  out_ << " and nothing was changed; give a "
       << (problem == ValueError::kRange ? "value in that range" : "number, with that unit or none") << "\r\n";
  prompt();
  return false;
}

/// Says why the staged set was refused.
void Shell::print_refusal(const SetAnswer& answer) {
  using Refusal = SetAnswer::Refusal;
  switch (answer.refusal) {
    case Refusal::kNone:
      return;
    case Refusal::kNeedsRest:
      error("armed", "the model, the motor and the limits change only without torque, and nothing was changed",
            "'disarm' first");
      return;
    case Refusal::kBusy:
      error("busy", "the cycle has not taken the last change yet, and nothing was changed", "send the line again");
      return;
    case Refusal::kSafetyLimit:
      out_ << "error maintenance: " << answer.limit->group << '.' << answer.limit->name
           << " is a safety limit, and nothing was changed; 'maintenance open' first, with the key if one is set\r\n";
      break;
    case Refusal::kInconsistent:
      out_ << "error inconsistent: nothing was changed, because ";
      if (!answer.grid.ok() && answer.reason == std::string_view(describe(answer.grid.fault))) {
        out_ << "at row " << static_cast<std::uint32_t>(answer.grid.row) << ", column "
             << static_cast<std::uint32_t>(answer.grid.column) << " of the preisach grid ";
      }
      out_ << answer.reason << "\r\n";  // it ends in its own cure
      break;
  }
  prompt();
}

void Shell::commit() {
  const bool open = maintenance_.is_open(machine_.telemetry().tick);
  const SetAnswer answer = machine_.configure(staged_, open ? Rights::kMaintenance : Rights::kOperator);
  if (!answer.taken()) {
    print_refusal(answer);
    return;
  }
  abandon();
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
  const bool one_group = !filter.empty();
  const bool dot = one_group && filter.front() == '.';
  if (dot) {
    filter.remove_prefix(1);
  }
  if (one_group && !(dot && is_group(filter))) {
    shell.error("unknown_group", "there is no such group of parameters",
                "'list' shows all of them, 'list joint0.limits' one");
    return;
  }
  for (std::size_t axis = 0; axis < shell.machine_.axes(); ++axis) {
    for (const ParameterInfo& parameter : parameters()) {
      if ((one_axis && axis != only) || (one_group && filter != parameter.group)) {
        continue;
      }
      shell.out_ << "joint" << static_cast<std::uint32_t>(axis) << '.' << parameter.group << '.' << parameter.name
                 << ' ';
      print_value(shell.out_, parameter, raw_value(shell.machine_.config()[axis], parameter));
      shell.out_ << " (";
      print_range(shell.out_, parameter);
      shell.out_ << ") " << parameter.doc << "\r\n";
    }
  }
  shell.ok();
}

void ShellCommands::replay_lines(Shell& shell, bool changed_only) {
  shell.out_ << "begin\r\n";
  for (std::size_t axis = 0; axis < shell.machine_.axes(); ++axis) {
    for (const ParameterInfo& parameter : parameters()) {
      const std::int32_t raw = raw_value(shell.machine_.config()[axis], parameter);
      if (changed_only && raw == raw_value(kFresh, parameter)) {
        continue;
      }
      shell.out_ << "set joint" << static_cast<std::uint32_t>(axis) << '.' << parameter.group << '.' << parameter.name
                 << ' ';
      print_value(shell.out_, parameter, raw);
      shell.out_ << "\r\n";
    }
  }
  shell.out_ << "commit\r\n";
  shell.ok();
}

void ShellCommands::dump(Shell& shell, std::string_view /*arguments*/) {
  replay_lines(shell, false);
}
void ShellCommands::diff(Shell& shell, std::string_view /*arguments*/) {
  replay_lines(shell, true);
}

void ShellCommands::begin(Shell& shell, std::string_view /*arguments*/) {
  if (shell.begin_staging()) {
    shell.staging_ = true;
    shell.ok();
  }
}

void ShellCommands::commit(Shell& shell, std::string_view /*arguments*/) {
  if (!shell.staging_) {
    shell.error("not_staging", "nothing is staged", "'begin', then 'set' what you want to change");
    return;
  }
  shell.commit();
}

void ShellCommands::abandon(Shell& shell, std::string_view /*arguments*/) {
  shell.abandon();
  shell.ok();
}

void ShellCommands::defaults(Shell& shell, std::string_view /*arguments*/) {
  if (shell.begin_staging()) {
    std::fill(shell.staged_.begin(), shell.staged_.end(), kFresh);
    shell.staging_ = true;
    shell.ok();
  }
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
  shell.abandon();
  switch (shell.machine_.load()) {
    case LoadResult::kLoaded:
      shell.print_load_report("");
      shell.activity_ = Shell::Activity::kApplying;
      break;
    case LoadResult::kForeign:
      shell.print_load_report("");
      shell.error("storage_foreign", "the stored set has a format of another version, and nothing was changed",
                  "flash the version that stored it, or load a model and 'save' it");
      break;
    case LoadResult::kEmpty:
      shell.error("storage_empty", "nothing was ever saved, and nothing was changed", "'set' what you want and 'save'");
      break;
    case LoadResult::kUnfinished:
      shell.error("storage_unfinished", "power went while the first set was saved, and nothing was changed",
                  "'set' what you want and 'save' again");
      break;
    case LoadResult::kUnreadable:
      shell.error("storage_failed", "the memory can not be read, and nothing was changed",
                  "'reboot', and if this comes back replace the memory");
      break;
    case LoadResult::kCorrupt:
      shell.error("storage_corrupt", "no bank holds a whole set, and nothing was changed",
                  "load a model and 'save' it");
      break;
    case LoadResult::kRefused:
      shell.error("busy", "the last change is not taken yet or another console stages one, and nothing was changed",
                  "send the line again");
      break;
  }
}

}  // namespace capstan
