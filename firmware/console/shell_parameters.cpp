// SPDX-License-Identifier: Apache-2.0
// The shell's commands that read and change parameters.
#include <algorithm>

#include "capstan/firmware/console/shell_commands.hpp"
#include "capstan/firmware/parameters/crc32.hpp"

namespace capstan {
namespace {

constexpr AxisConfig kFresh;

/// The group's name where it stays, for a line does not; nullptr if there is none.
auto group_named(std::string_view name) -> const char* {
  const auto all = parameters();
  const auto found =
      std::find_if(all.begin(), all.end(), [name](const ParameterInfo& parameter) { return name == parameter.group; });
  return found == all.end() ? nullptr : found->group;
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

/// Lines of parameters, joint by joint.
class ParametersStream final : public PartsStream {
 public:
  enum class Lines : std::uint8_t { kMeanings, kReplay, kReplayChanged };
  static constexpr std::size_t kAllJoints = Session::kMaxAxes;

  void begin(Session& session) {
    in_force_ = digest(session);
    if (lines != Lines::kMeanings) {
      session.out() << "begin\r\n";
    }
    session.answer(*this);
  }

  Lines lines = Lines::kMeanings;
  std::size_t only = kAllJoints;
  const char* group = nullptr;  ///< nullptr: all

 private:
  auto print(Session& session, std::uint32_t part) -> bool override;
  void end(Session& session) const;
  /// Of the values in force: another console may change them while a slow line takes what they were.
  static auto digest(Session& session) -> std::uint32_t {
    const auto joints = session.machine().config();
    Crc32 crc;
    crc.add({reinterpret_cast<const std::uint8_t*>(joints.data()), joints.size_bytes()});
    return crc.value();
  }

  std::uint32_t in_force_ = 0;
};

auto ParametersStream::print(Session& session, std::uint32_t part) -> bool {
  const std::size_t axis = part / parameters().size();
  if (axis >= session.machine().axes()) {
    end(session);
    return false;
  }
  const ParameterInfo& parameter = parameters()[part % parameters().size()];
  const std::int32_t raw = raw_value(session.machine().config()[axis], parameter);
  if ((only != kAllJoints && axis != only) || (group != nullptr && parameter.group != std::string_view(group)) ||
      (lines == Lines::kReplayChanged && raw == raw_value(kFresh, parameter))) {
    return true;
  }
  Print& out = session.out();
  out << (lines == Lines::kMeanings ? "joint" : "set joint") << static_cast<std::uint32_t>(axis) << '.'
      << parameter.group << '.' << parameter.name << ' ';
  print_value(out, parameter, raw);
  if (lines == Lines::kMeanings) {
    out << " (";
    print_range(out, parameter);
    out << ") " << parameter.doc;
  }
  out << "\r\n";
  return true;
}

void ParametersStream::end(Session& session) const {
  if (digest(session) != in_force_) {
    session.error("changed", "another console changed parameters during this listing, so the lines are not consistent",
                  "send the line again");
    return;
  }
  if (lines != Lines::kMeanings) {
    session.out() << "commit\r\n";
  }
  session.ok();
}

void replay_lines(Session& session, bool changed_only) {
  auto& stream = session.make<ParametersStream>();
  stream.lines = changed_only ? ParametersStream::Lines::kReplayChanged : ParametersStream::Lines::kReplay;
  stream.begin(session);
}

/// What `help` says of a group, or of one parameter.
class MeaningsStream final : public PartsStream {
 public:
  const ParameterInfo* one = nullptr;
  const char* group = nullptr;

 private:
  auto print(Session& session, std::uint32_t part) -> bool override;
};

auto MeaningsStream::print(Session& session, std::uint32_t part) -> bool {
  if (part == parameters().size()) {
    session.ok();
    return false;
  }
  const ParameterInfo& parameter = parameters()[part];
  if (&parameter != one && (group == nullptr || parameter.group != std::string_view(group))) {
    return true;
  }
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
  return true;
}

}  // namespace

/// `name`: "group.name" or "group", with or without a joint before it.
void help_parameters(Session& session, std::string_view name) {
  std::size_t axis = 0;
  std::string_view rest = name;
  if (session.parse_axis(rest, axis) && rest.size() > 1 && rest.front() == '.') {
    name = std::string_view(rest.data() + 1, rest.size() - 1);
  }
  auto& stream = session.make<MeaningsStream>();
  stream.one = find_parameter(name);
  stream.group = group_named(name);
  if (stream.one != nullptr || stream.group != nullptr) {
    session.answer(stream);
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
                    << " must be the number of another joint of this board, or -1 for none; correct it\r\n";
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
  auto& stream = session.make<ParametersStream>();
  if (!filter.empty() && !session.parse_axis(filter, stream.only)) {
    session.error("unknown_joint", "there is no such joint", "give joint0 and so on, or nothing");
    return;
  }
  if (!filter.empty()) {
    const bool dot = filter.front() == '.';
    filter.remove_prefix(1);
    stream.group = dot ? group_named(filter) : nullptr;
    if (stream.group == nullptr) {
      session.error("unknown_group", "there is no such group of parameters",
                    "'list' shows all of them, 'list joint0.limits' one");
      return;
    }
  }
  stream.begin(session);
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
      session.error("storage_foreign", "the stored set has another version's format, and nothing was changed",
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
      session.error("storage_failed", "the memory cannot be read, and nothing was changed",
                    "'reboot', and if this comes back replace the memory");
      break;
    case LoadResult::kCorrupt:
      session.error("storage_corrupt", "no bank holds a complete set, and nothing was changed",
                    "load a model and 'save' it");
      break;
    case LoadResult::kRefused:
      session.error("busy", "the last change is not taken yet or another console stages one, and nothing was changed",
                    "send the line again");
      break;
  }
}

}  // namespace capstan
