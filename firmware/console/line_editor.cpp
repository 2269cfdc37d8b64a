// SPDX-License-Identifier: Apache-2.0
#include "capstan/firmware/console/line_editor.hpp"
#include "capstan/firmware/loop/expect.hpp"

#include <algorithm>

namespace capstan {
namespace {

constexpr char kBackspace = '\b';
constexpr char kDelete = 0x7F;
constexpr char kCancelKey = 0x03;
constexpr char kEscape = 0x1B;
constexpr auto control(char letter) -> char {
  return static_cast<char>(letter & 0x1F);
}

}  // namespace

/// Keys like the arrows send ESC [ ... letter, or ESC letter. True: the character belongs to one.
auto LineEditor::take_escape(char c) -> bool {
  const Escape before = escape_;
  if (c == kEscape) {
    escape_ = Escape::kBegun;
    escape_digit_ = 0;
    return true;
  }
  if (before == Escape::kNone || static_cast<unsigned char>(c) < ' ') {
    escape_ = Escape::kNone;  // a sequence never takes a line's end or a Ctrl-C with it
    return false;
  }
  const bool goes_on = before == Escape::kBegun ? c == '[' || c == 'O' : c < '@' || c > '~';
  escape_ = goes_on ? Escape::kSequence : Escape::kNone;
  if (goes_on) {
    escape_digit_ = escape_digit_ == 0 && c >= '0' && c <= '9' ? c : escape_digit_;
  } else if (before == Escape::kSequence) {
    edit_key(c);
  }
  return true;
}

void LineEditor::edit_key(char final_character) {
  switch (final_character == '~' ? escape_digit_ : final_character) {
    case 'A':
      recall(recalled_ + 1);
      break;
    case 'B':
      recall(recalled_ > 0 ? recalled_ - 1 : 0);
      break;
    case 'C':
      move_to(cursor_ + 1);
      break;
    case 'D':
      move_to(cursor_ > 0 ? cursor_ - 1 : 0);
      break;
    case 'H':
    case '1':
    case '7':
      move_to(0);
      break;
    case 'F':
    case '4':
    case '8':
      move_to(length_);
      break;
    case '3':
      erase_from(cursor_, 1);
      break;
    default:
      break;
  }
}

/// Editing keys of a terminal. True: the character was one.
auto LineEditor::take_control(char c) -> bool {
  switch (c) {
    case control('A'):
      move_to(0);
      return true;
    case control('E'):
      move_to(length_);
      return true;
    case control('B'):
      move_to(cursor_ > 0 ? cursor_ - 1 : 0);
      return true;
    case control('F'):
      move_to(cursor_ + 1);
      return true;
    case control('D'):
      erase_from(cursor_, 1);
      return true;
    case control('K'):
      erase_from(cursor_, length_);
      return true;
    case control('P'):
      recall(recalled_ + 1);
      return true;
    case control('N'):
      recall(recalled_ > 0 ? recalled_ - 1 : 0);
      return true;
    case control('W'): {
      std::size_t first = cursor_;
      while (first > 0 && line_[first - 1] == ' ') {
        --first;
      }
      while (first > 0 && line_[first - 1] != ' ') {
        --first;
      }
      const std::size_t count = cursor_ - first;
      move_to(first);
      erase_from(first, count);
      return true;
    }
    default:
      return false;
  }
}

auto LineEditor::take(char c) -> Key {
  const char last = last_;
  last_ = c;
  if (echo_ && take_escape(c)) {
    return Key::kNone;
  }
  if (c == '\n' && last == '\r') {
    return Key::kNone;  // the second half of a CR LF
  }
  if (c == '\r' || c == '\n') {
    if (echo_) {
      out_ << "\r\n";
    }
    return Key::kLine;
  }
  if (c == kBackspace || c == kDelete) {
    erase_before();
    return Key::kNone;
  }
  if (c == control('U') || c == kCancelKey) {
    begin();
    return c == kCancelKey ? Key::kCancel : Key::kKill;
  }
  if (echo_ && c == '\t') {
    return hidden_ ? Key::kNone : Key::kComplete;
  }
  if (echo_ && take_control(c)) {
    return Key::kNone;
  }
  if (c != '\t' && (c < ' ' || c > '~')) {
    damaged_ = heard_damage_ = true;
    return Key::kNone;
  }
  insert(c);
  return Key::kNone;
}

void LineEditor::begin() {
  if (hidden_) {
    line_.fill('\0');
  }
  length_ = 0;
  cursor_ = 0;
  recalled_ = 0;
  too_long_ = false;
  damaged_ = false;
  hidden_ = false;
  was_recalled_ = false;
}

void LineEditor::insert(char c) {
  if (length_ == line_.size()) {
    too_long_ = true;
    return;
  }
  std::string_view rest = text();
  // Once hidden it stays so, whatever is taken off its front.
  hidden_ = hidden_ || (next_word(rest) == "maintenance" && !rest.empty());
  std::copy_backward(line_.begin() + static_cast<std::ptrdiff_t>(cursor_),
                     line_.begin() + static_cast<std::ptrdiff_t>(length_),
                     line_.begin() + static_cast<std::ptrdiff_t>(length_ + 1));
  line_[cursor_++] = c;
  ++length_;
  if (!echo_) {
    return;
  }
  if (cursor_ == length_) {
    out_ << (hidden_ ? '*' : c);
  } else {
    redraw();
  }
}

void LineEditor::insert(std::string_view text) {
  for (const char c : text) {
    insert(c);
  }
}

void LineEditor::erase_before() {
  if (cursor_ == 0) {
    return;
  }
  if (cursor_ == length_) {
    line_[--length_] = '\0';
    --cursor_;
    if (echo_) {
      out_ << "\b \b";
    }
    return;
  }
  --cursor_;
  erase_from(cursor_, 1);
}

void LineEditor::erase_from(std::size_t first, std::size_t count) {
  count = std::min(count, length_ - first);
  if (count == 0) {
    return;
  }
  std::copy(line_.begin() + static_cast<std::ptrdiff_t>(first + count),
            line_.begin() + static_cast<std::ptrdiff_t>(length_), line_.begin() + static_cast<std::ptrdiff_t>(first));
  length_ -= count;
  redraw();
}

void LineEditor::move_to(std::size_t cursor) {
  cursor_ = std::min(cursor, length_);
  redraw();
}

void LineEditor::prompt() {
  if (echo_) {
    out_ << "capstan> ";
  }
}

void LineEditor::redraw() {
  if (!echo_) {
    return;
  }
  out_ << '\r';
  prompt();
  for (std::size_t i = 0; i < length_; ++i) {
    out_ << (hidden_ ? '*' : line_[i]);
  }
  out_ << "\x1B[K";  // to the end of the screen's line
  for (std::size_t i = cursor_; i < length_; ++i) {
    out_ << '\b';
  }
}

auto LineEditor::remembered(std::size_t age) const -> std::string_view {
  std::size_t end = history_size_;
  for (std::size_t i = 1; end > 0; ++i) {
    std::size_t begin = end - 1;
    while (begin > 0 && history_[begin - 1] != '\0') {
      --begin;
    }
    if (i == age) {
      return {history_.data() + begin, end - 1 - begin};
    }
    end = begin;
  }
  return {};
}

void LineEditor::recall(std::size_t age) {
  const std::string_view line = remembered(age);
  if (hidden_ || (age > 0 && line.empty())) {
    return;
  }
  recalled_ = age;
  was_recalled_ = true;
  std::copy(line.begin(), line.end(), line_.begin());
  length_ = line.size();
  cursor_ = length_;
  redraw();
}

void LineEditor::remember() {
  std::string_view rest = text();
  if (!echo_ || hidden_ || next_word(rest).empty() || text() == remembered(1)) {
    return;
  }
  while (history_size_ + length_ + 1 > history_.size()) {
    forget();
  }
  std::copy_n(line_.begin(), length_, history_.begin() + static_cast<std::ptrdiff_t>(history_size_));
  history_size_ += length_;
  history_[history_size_++] = '\0';
}

/// The oldest line. @pre there is one
void LineEditor::forget() {
  CAPSTAN_EXPECT(history_size_ > 0);
  auto* const used = history_.begin() + static_cast<std::ptrdiff_t>(history_size_);
  auto* const next = std::find(history_.begin(), used, '\0') + 1;
  std::copy(next, used, history_.begin());
  history_size_ -= static_cast<std::size_t>(next - history_.begin());
}

}  // namespace capstan
