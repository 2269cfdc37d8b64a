// SPDX-License-Identifier: Apache-2.0
#include "capstan/firmware/console/shell.hpp"

#include "capstan/firmware/console/shell_commands.hpp"

namespace capstan {
namespace {

/// What follows the first words of a text.
auto behind(std::string_view text, std::size_t words) -> std::string_view {
  for (; words > 0 && !next_word(text).empty(); --words) {
  }
  return text;
}

}  // namespace

void Shell::receive(char c) {
  switch (editor_.take(c)) {
    case LineEditor::Key::kNone:
      break;
    case LineEditor::Key::kComplete:
      complete();
      break;
    case LineEditor::Key::kCancel:
      if (stream_ != nullptr) {
        cancel_stream();  // its answer brings the prompt
        break;
      }
      [[fallthrough]];
    case LineEditor::Key::kKill:
      if (echo_) {
        out_ << "\r\n";
        editor_.prompt();
      }
      break;
    case LineEditor::Key::kLine:
      execute(editor_.text());
      editor_.begin();
      break;
  }
  lines_.flush();
}

void Shell::execute(std::string_view line) {
  std::string_view rest = line;
  const std::string_view word = next_word(rest);
  const bool after_damage = editor_.take_damage() || last_damaged_;
  last_damaged_ = editor_.damaged();
  if (editor_.damaged() && word != "disarm") {  // what wants torque off is never refused
    error("not_text", "the line contains characters that are not text, so it may be damaged and was not read",
          "check the connection and its speed, and send the line again");
    return;
  }
  if (editor_.too_long()) {
    error("line_too_long", "the line has more than 160 characters and was not read", "send a shorter one");
    return;
  }
  if (streams(Stream::Manner::kYields)) {
    out_ << "ok\r\n";  // of what streamed
    stream_ = nullptr;
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
    if (!refuses_more(*this, behind(rest, command.most_words))) {
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
      refused();
      return;
    case BoardAnswer::kUnknown:
      error("unknown_command", "there is no such command", "'help' lists all of them");
  }
}

auto Shell::refuses_to_act(bool after_damage) -> bool {
  if (editor_.recalled()) {
    error("recalled",
          "commands that give torque, move a joint or restart the board cannot be recalled from the history, and "
          "nothing was done",
          "type the line again");
    return true;
  }
  if (after_damage) {
    error("after_damage", "the previous line was damaged, so this one is not trusted, and nothing was done",
          "check the connection and its speed, and send the line again");
    return true;
  }
  return false;
}

void Shell::cancel_stream() {
  if (stream_ != nullptr) {
    stream_->cancel(*this);
  }
}

void Shell::disarm_now() {
  cancel_stream();
  static_cast<void>(machine_.post({.kind = Request::Kind::kDisarm}));  // never refused
  disarming_ = true;
  poll();
}

void Shell::poll() {
  disarming_ = disarming_ && !machine_.requests_taken();
  if (beside_ != nullptr) {
    beside_->step(*this);
  }
  if (stream_ != nullptr) {
    stream_->step(*this);
  }
  lines_.flush();
}

}  // namespace capstan
