// SPDX-License-Identifier: Apache-2.0
#include "capstan/firmware/console/shell.hpp"

#include <algorithm>

#include "capstan/firmware/console/shell_commands.hpp"

namespace capstan {
namespace {

auto words_in(std::string_view text) -> std::size_t {
  std::size_t count = 0;
  while (!next_word(text).empty()) {
    ++count;
  }
  return count;
}

}  // namespace

Shell::Shell(Machine& machine, TextSink& sink, Board& board, bool echo)
    : machine_(machine), sink_(sink), out_(sink), board_(board), echo_(echo), editor_(out_, echo) {}

void Shell::receive(char c) {
  switch (editor_.take(c)) {
    case LineEditor::Key::kNone:
      break;
    case LineEditor::Key::kComplete:
      complete();
      break;
    case LineEditor::Key::kCancel:
      if (activity_ != Activity::kIdle) {
        end_stream();  // its answer brings the prompt
        break;
      }
      [[fallthrough]];
    case LineEditor::Key::kKill:
      if (echo_) {
        out_ << "\r\n";
        prompt();
      }
      break;
    case LineEditor::Key::kLine:
      execute(editor_.text());
      editor_.begin();
      break;
  }
}

void Shell::prompt() {
  editor_.prompt();
}

void Shell::ok() {
  out_ << "ok\r\n";
  activity_ = Activity::kIdle;
  prompt();
}

void Shell::error(const char* name, const char* sentence, const char* cure) {
  out_ << "error " << name << ": " << sentence << "; " << cure << "\r\n";
  activity_ = Activity::kIdle;
  prompt();
}

void Shell::execute(std::string_view line) {
  std::string_view rest = line;
  const std::string_view word = next_word(rest);
  const bool after_damage = editor_.take_damage() || last_damaged_;
  last_damaged_ = editor_.damaged();
  if (editor_.damaged() && word != "disarm") {  // what wants torque off is never refused
    error("not_text", "the line has characters that are no text, so it may have been damaged and was not read",
          "check the line and its speed, and send it again");
    return;
  }
  if (editor_.too_long()) {
    error("line_too_long", "the line has more than 160 characters and was not read", "send a shorter one");
    return;
  }
  if (activity_ == Activity::kWatching) {
    out_ << "ok\r\n";  // of the watch, which ends here
    activity_ = Activity::kIdle;
  }
  if (busy()) {
    out_ << "error busy: the last command has not answered yet; wait for its ok or error\r\n";
    return;
  }
  if (word.empty() || word.front() == '#') {
    ok();  // a host that waits for an answer to every line waits for this one too
    return;
  }
  for (const ShellCommand& command : shell_commands()) {
    if (word != command.name) {
      continue;
    }
    if (command.acts && refuses_to_act(after_damage)) {
      return;
    }
    if (!command.acts) {
      editor_.remember();  // only what begins with a command, for a slip of the keys may have put a key into it
    }
    if (words_in(rest) > command.most_words) {
      error("usage", "the command was given more words than it takes, and nothing was done",
            "'help' shows its arguments");
    } else {
      command.run(*this, rest);
    }
    return;
  }
  switch (board_.run_command(word, rest, out_)) {
    case BoardAnswer::kDone:
      editor_.remember();
      ok();
      return;
    case BoardAnswer::kRefused:
      editor_.remember();
      prompt();
      return;
    case BoardAnswer::kUnknown:
      error("unknown_command", "there is no such command", "'help' lists all of them");
  }
}

auto Shell::refuses_to_act(bool after_damage) -> bool {
  if (editor_.recalled()) {
    error("recalled", "what gives torque, moves or restarts is not taken from the history, and nothing was done",
          "type the line anew");
    return true;
  }
  if (after_damage) {
    error("after_damage", "the line before was damaged, so this one is not trusted, and nothing was done",
          "check the connection and its speed, and send the line again");
    return true;
  }
  return false;
}

void Shell::disarm_now() {
  end_stream();
  urgent_ = Urgent::kWanted;
  poll();
}

void Shell::poll() {
  if (urgent_ == Urgent::kWanted && machine_.post({.kind = Request::Kind::kDisarm})) {
    urgent_ = Urgent::kPosted;
  } else if (urgent_ == Urgent::kPosted && machine_.settled()) {
    urgent_ = Urgent::kNone;
  }
  if (framing_) {
    go_on_framing();
  }
  switch (activity_) {
    case Activity::kIdle:
      break;
    case Activity::kLogging:
      go_on_logging();
      break;
    case Activity::kDumpingFaults:
      go_on_dumping_faults();
      break;
    case Activity::kExperimenting:
      go_on_experimenting();
      break;
    case Activity::kCommissioning:
      go_on_commissioning();
      break;
    case Activity::kDumping:
      go_on_dumping();
      break;
    case Activity::kWatching:
      go_on_watching();
      break;
    default:
      if (machine_.settled()) {
        finish();
      }
      break;
  }
}

void Shell::finish() {
  switch (activity_) {
    case Activity::kArming:
      finish_arming();
      break;
    case Activity::kMoving:
      if (energised(machine_.telemetry().state)) {
        ok();
      } else {
        error("not_armed", "torque went away before the move began", "'faults' says why");
      }
      break;
    default:
      ok();
      break;
  }
}

/// With the joints that show it, where it is a joint's.
void Shell::print_fault(const char* what, const FaultInfo& entry) {
  out_ << what << entry.name << ": " << entry.cause << "; " << entry.cure;
  const char* before = " (joint";
  for (std::size_t axis = 0; axis < machine_.axes(); ++axis) {
    if ((machine_.axis_telemetry(axis).faults & bit(entry.fault)) != 0) {
      out_ << before << static_cast<std::uint32_t>(axis);
      before = ", joint";
    }
  }
  out_ << (before[0] == ',' ? ")\r\n" : "\r\n");
}

void Shell::finish_arming() {
  const MachineTelemetry now = machine_.telemetry();
  if (now.state == State::kArmed) {
    return;  // the joints are taken over within this cycle
  }
  if (energised(now.state)) {
    ok();
    return;
  }
  for (const FaultInfo& entry : kFaultTable) {
    if ((now.conditions & bit(entry.fault)) != 0) {
      print_fault("blocked by ", entry);
    }
  }
  if (now.state == State::kFaulted) {
    error("faulted", "a fault is latched", "read 'faults', then 'disarm' and 'arm'");
  } else if (now.conditions == 0) {
    error("blocked", "what blocked arming has gone meanwhile", "'arm' again");
  } else {
    error("blocked", "arming is blocked by the conditions above", "cure them and 'arm' again");
  }
}

auto Shell::parse_axis(std::string_view& text, std::size_t& axis) -> bool {
  constexpr std::string_view kPrefix = "joint";
  if (text.size() <= kPrefix.size() || std::string_view(text.data(), kPrefix.size()) != kPrefix) {
    return false;
  }
  const char digit = text[kPrefix.size()];
  if (digit < '0' || digit > '9') {
    return false;
  }
  axis = static_cast<std::size_t>(digit - '0');
  text.remove_prefix(kPrefix.size() + 1);
  return axis < machine_.axes();
}

auto Shell::parse_name(std::string_view text, Name& name) -> bool {
  if (!parse_axis(text, name.axis) || text.empty() || text.front() != '.') {
    return false;
  }
  text.remove_prefix(1);
  name.parameter = find_parameter(text);
  return name.parameter != nullptr;
}

}  // namespace capstan
