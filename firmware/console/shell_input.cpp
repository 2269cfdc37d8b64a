// SPDX-License-Identifier: Apache-2.0
#include "capstan/firmware/console/shell_input.hpp"

#include <algorithm>
#include <utility>

namespace capstan {
namespace {
constexpr char kNoText = '\0';  // no key of a terminal: the shell refuses a line with it, and says why
constexpr char kCancel = 0x03;
constexpr char kBackspace = '\b';
constexpr char kDelete = 0x7F;
constexpr char kKillLine = 0x15;

auto ends_line(char c) -> bool {
  return c == '\r' || c == '\n';
}
}  // namespace

auto ShellInput::ends_disarm(char c) -> bool {
  if (ends_line(c) || c == kKillLine || c == kCancel) {
    std::string_view line(start_.data(), std::min(length_, start_.size()));
    length_ = 0;
    return ends_line(c) && next_word(line) == "disarm";
  }
  if (c == kBackspace || c == kDelete) {
    length_ -= length_ > 0 ? 1 : 0;
    return false;
  }
  if (length_ < start_.size()) {
    start_[length_] = c;
  }
  ++length_;
  return false;
}

void ShellInput::take(char c, bool urgent) {
  const bool disarm = ends_disarm(c);
  if (shell_.busy() && c == kCancel) {
    forget();
    return;
  }
  if (!push(c)) {
    lost_ = true;
    lost_end_ = ends_line(c);
  }
  if (disarm && urgent && shell_.busy()) {
    if (lost_) {
      disarm_without_room();
    }
    shell_.disarm_now();
  }
}

auto ShellInput::push(char c) -> bool {
  const std::size_t mark = !lost_ ? 0 : lost_end_ ? 2 : 1;
  if (room() <= mark) {
    return false;
  }
  const auto put = [this](char one) { waiting_[(first_ + count_++) % waiting_.size()] = one; };
  if (lost_) {
    put(kNoText);
  }
  if (lost_ && lost_end_) {
    put('\n');
  }
  lost_ = false;
  put(c);
  return true;
}

/// One answer says that lines were lost, and the next is that of the `disarm`.
void ShellInput::disarm_without_room() {
  count_ = 0;
  lost_ = lost_end_ = true;
  for (const char c : std::string_view("disarm\n")) {
    static_cast<void>(push(c));
  }
}

void ShellInput::poll() {
  shell_.poll();
  while (count_ > 0 && !shell_.busy()) {
    const char c = std::exchange(waiting_[first_], '\0');  // a key leaves nothing behind
    first_ = (first_ + 1) % waiting_.size();
    --count_;
    in_line_ = !ends_line(c);
    shell_.receive(c);
  }
  shell_.poll();
}

void ShellInput::peer_left() {
  forget();
  shell_.peer_left();
}

void ShellInput::forget() {
  count_ = 0;
  lost_ = in_line_ = false;
  length_ = 0;
  shell_.receive(kCancel);
}

}  // namespace capstan
