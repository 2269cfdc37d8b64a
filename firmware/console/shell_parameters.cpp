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

/// False: the value was refused.
auto stage(Session& session, std::string_view arguments) -> bool {
  Session::Name wanted;
  if (!session.parse_name(next_word(arguments), wanted)) {
    session.error("unknown_parameter", "there is no such parameter", "'list' shows all of them");
    return false;
  }
  const ParameterInfo& parameter = *wanted.parameter;
  std::int32_t raw = 0;
  const ValueError problem = parse_value(arguments, parameter, raw);
  if (problem == ValueError::kNone) {
    set_raw_value(session.staged()[wanted.axis], parameter, raw);
    return true;
  }
  Print& out = session.out();
  out << "error "
      << (problem == ValueError::kNotANumber ? "not_a_number"
          : problem == ValueError::kUnit     ? "unit"
                                             : "range")
      << ": " << parameter.group << '.' << parameter.name << " takes ";
  print_range(out, parameter);
  out << " and nothing was changed; give a "
      << (problem == ValueError::kRange            ? "value in that range"
          : parameter.type == ParameterType::kReal ? "number, with that unit or none"
                                                   : "whole number")
      << "\r\n";
  session.refused();
  return false;
}

void commit_staged(Session& session) {
  const bool open = session.maintenance().is_open(session.machine().telemetry().tick);
  const SetAnswer answer =
      session.machine().configure(session.staged(), open ? Rights::kMaintenance : Rights::kOperator);
  if (!answer.taken()) {
    print_refusal(session, answer);
    return;
  }
  session.abandon();
  session.answer_when_taken();
}

void replay_lines(Session& session, bool changed_only) {
  session.out() << "begin\r\n";
  for (std::size_t axis = 0; axis < session.machine().axes(); ++axis) {
    for (const ParameterInfo& parameter : parameters()) {
      const std::int32_t raw = raw_value(session.machine().config()[axis], parameter);
      if (changed_only && raw == raw_value(kFresh, parameter)) {
        continue;
      }
      session.out() << "set joint" << static_cast<std::uint32_t>(axis) << '.' << parameter.group << '.'
                    << parameter.name << ' ';
      print_value(session.out(), parameter, raw);
      session.out() << "\r\n";
    }
  }
  session.out() << "commit\r\n";
  session.ok();
}

}  // namespace

/// `name`: "group.name" or "group", with or without a joint before it.
void help_parameters(Session& session, std::string_view name) {
  std::size_t axis = 0;
  std::string_view rest = name;
  if (session.parse_axis(rest, axis) && rest.size() > 1 && rest.front() == '.') {
    name = std::string_view(rest.data() + 1, rest.size() - 1);
  }
  const ParameterInfo* one = find_parameter(name);
  bool found = false;
  for (const ParameterInfo& parameter : parameters()) {
    if (&parameter != one && name != parameter.group) {
      continue;
    }
    found = true;
    Print& out = session.out();
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
    session.ok();
  } else {
    session.error("unknown_topic", "there is no such command, parameter or group",
                  "'help' lists the commands, 'list' the parameters");
  }
}

/// Says why the staged set was refused.
void print_refusal(Session& session, const SetAnswer& answer) {
  using Refusal = SetAnswer::Refusal;
  switch (answer.refusal) {
    case Refusal::kNone:
      return;
    case Refusal::kNeedsRest:
      session.error("armed", "the model, the motor and the limits change only without torque, and nothing was changed",
                    "'disarm' first");
      return;
    case Refusal::kBusy:
      session.error("busy", "the cycle has not taken the last change yet, and nothing was changed",
                    "send the line again");
      return;
    case Refusal::kSafetyLimit:
      session.out()
          << "error maintenance: " << answer.limit->group << '.' << answer.limit->name
          << " is a safety limit, and nothing was changed; 'maintenance open' first, with the key if one is set\r\n";
      break;
    case Refusal::kNoSuchJoint:
      session.out() << "error inconsistent: nothing was changed, because " << answer.limit->group << '.'
                    << answer.limit->name
                    << " names this joint itself or one that the board has not; give another's number, or -1\r\n";
      break;
    case Refusal::kInconsistent:
      session.out() << "error inconsistent: nothing was changed, because ";
      if (!answer.grid.ok() && answer.reason == std::string_view(describe(answer.grid.fault))) {
        session.out() << "at row " << static_cast<std::uint32_t>(answer.grid.row) << ", column "
                      << static_cast<std::uint32_t>(answer.grid.column) << " of the preisach grid ";
      }
      session.out() << answer.reason << "\r\n";  // it ends in its own cure
      break;
  }
  session.refused();
}

void commands::get(Session& session, std::string_view arguments) {
  Session::Name wanted;
  if (!session.parse_name(next_word(arguments), wanted)) {
    session.error("unknown_parameter", "there is no such parameter", "'list' shows all of them");
    return;
  }
  const ParameterInfo& parameter = *wanted.parameter;
  session.out() << "joint" << static_cast<std::uint32_t>(wanted.axis) << '.' << parameter.group << '.' << parameter.name
                << ' ';
  print_value(session.out(), parameter, raw_value(session.machine().config()[wanted.axis], parameter));
  session.out() << " (";
  print_range(session.out(), parameter);
  session.out() << ")\r\n";
  session.ok();
}

void commands::set(Session& session, std::string_view arguments) {
  if (session.staging()) {
    if (stage(session, arguments)) {
      session.ok();
    }
    return;
  }
  if (!session.take_staging_room()) {
    return;
  }
  if (stage(session, arguments)) {
    commit_staged(session);
  }
  session.abandon();  // what is to be taken is on its way, and what was refused is forgotten
}

void commands::list(Session& session, std::string_view arguments) {
  std::string_view filter = next_word(arguments);
  std::size_t only = 0;
  const bool one_axis = !filter.empty();
  if (one_axis && !session.parse_axis(filter, only)) {
    session.error("unknown_joint", "there is no such joint", "give joint0 and so on, or nothing");
    return;
  }
  const bool one_group = !filter.empty();
  const bool dot = one_group && filter.front() == '.';
  if (dot) {
    filter.remove_prefix(1);
  }
  if (one_group && !(dot && is_group(filter))) {
    session.error("unknown_group", "there is no such group of parameters",
                  "'list' shows all of them, 'list joint0.limits' one");
    return;
  }
  for (std::size_t axis = 0; axis < session.machine().axes(); ++axis) {
    for (const ParameterInfo& parameter : parameters()) {
      if ((one_axis && axis != only) || (one_group && filter != parameter.group)) {
        continue;
      }
      session.out() << "joint" << static_cast<std::uint32_t>(axis) << '.' << parameter.group << '.' << parameter.name
                    << ' ';
      print_value(session.out(), parameter, raw_value(session.machine().config()[axis], parameter));
      session.out() << " (";
      print_range(session.out(), parameter);
      session.out() << ") " << parameter.doc << "\r\n";
    }
  }
  session.ok();
}

void commands::dump(Session& session, std::string_view /*arguments*/) {
  replay_lines(session, false);
}
void commands::diff(Session& session, std::string_view /*arguments*/) {
  replay_lines(session, true);
}

void commands::begin(Session& session, std::string_view /*arguments*/) {
  if (session.take_staging_room()) {
    session.keep_staging();
    session.ok();
  }
}

void commands::commit(Session& session, std::string_view /*arguments*/) {
  if (!session.staging()) {
    session.error("not_staging", "nothing is staged", "'begin', then 'set' what you want to change");
    return;
  }
  commit_staged(session);
}

void commands::abandon(Session& session, std::string_view /*arguments*/) {
  session.abandon();
  session.ok();
}

void commands::defaults(Session& session, std::string_view /*arguments*/) {
  if (session.take_staging_room()) {
    std::fill(session.staged().begin(), session.staged().end(), kFresh);
    session.keep_staging();
    session.ok();
  }
}

void commands::save(Session& session, std::string_view /*arguments*/) {
  if (energised(session.machine().telemetry().state)) {
    session.error("armed", "saving stops the processor for up to seconds", "'disarm' first");
  } else if (!session.machine().save()) {
    session.error("storage", "the storage did not take the parameters, and the old set is still there",
                  "'save' again; if that fails too the memory is worn or write protected");
  } else {
    session.ok();
  }
}

void commands::load(Session& session, std::string_view /*arguments*/) {
  if (energised(session.machine().telemetry().state)) {
    session.error("armed", "a model changes only without torque", "'disarm' first");
    return;
  }
  session.abandon();
  switch (session.machine().load()) {
    case LoadResult::kLoaded:
      print_load_report(session.out(), session.machine().load_report(), "");
      session.answer_when_taken();
      break;
    case LoadResult::kForeign:
      print_load_report(session.out(), session.machine().load_report(), "");
      session.error("storage_foreign", "the stored set has a format of another version, and nothing was changed",
                    "flash the version that stored it, or load a model and 'save' it");
      break;
    case LoadResult::kEmpty:
      session.error("storage_empty", "nothing was ever saved, and nothing was changed",
                    "'set' what you want and 'save'");
      break;
    case LoadResult::kUnfinished:
      session.error("storage_unfinished", "power went while the first set was saved, and nothing was changed",
                    "'set' what you want and 'save' again");
      break;
    case LoadResult::kUnreadable:
      session.error("storage_failed", "the memory can not be read, and nothing was changed",
                    "'reboot', and if this comes back replace the memory");
      break;
    case LoadResult::kCorrupt:
      session.error("storage_corrupt", "no bank holds a whole set, and nothing was changed",
                    "load a model and 'save' it");
      break;
    case LoadResult::kRefused:
      session.error("busy", "the last change is not taken yet or another console stages one, and nothing was changed",
                    "send the line again");
      break;
  }
}

}  // namespace capstan
