// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <utility>

#include "capstan/firmware/console/text.hpp"

namespace capstan {

/// The line that is being typed. On a terminal it is echoed and edited (arrows, Home, End, Delete, Ctrl-A E B F D K U
/// W, history by up and down or Ctrl-P N), and what follows the word `maintenance` is shown as stars and never
/// remembered; without one only backspace, delete and Ctrl-U mean anything, and other controls damage it. Bounded
/// memory: the oldest lines are forgotten first.
class LineEditor {
 public:
  static constexpr std::size_t kLength = 160;
  static constexpr std::size_t kHistoryBytes = 256;
  enum class Key : std::uint8_t {
    kNone,      ///< the line goes on
    kLine,      ///< it is complete; read text(), then call begin()
    kKill,      ///< forgotten
    kCancel,    ///< forgotten, and what streams is to end
    kComplete,  ///< Tab on a terminal
  };

  LineEditor(Print& out, bool echo) : out_(out), echo_(echo) {}
  auto take(char c) -> Key;

  [[nodiscard]] auto text() const -> std::string_view { return {line_.data(), length_}; }
  /// More was typed than fits.
  [[nodiscard]] auto too_long() const -> bool { return too_long_; }
  /// Something came that is no text; without it the line could mean anything.
  [[nodiscard]] auto damaged() const -> bool { return damaged_; }
  /// Something that is no text came since this was asked last, in this line or in one that was forgotten.
  auto take_damage() -> bool { return std::exchange(heard_damage_, false); }
  /// It was brought back from the history, or edited from a line that was.
  [[nodiscard]] auto recalled() const -> bool { return was_recalled_; }
  /// What is typed now is shown as stars: it may be a key.
  [[nodiscard]] auto hidden() const -> bool { return hidden_; }
  /// A new line; of a hidden one nothing is left.
  void begin();
  /// Adds text() to the history unless it is blank, hidden or the newest there already.
  void remember();

  void prompt();
  /// Up to the cursor.
  [[nodiscard]] auto before_cursor() const -> std::string_view { return {line_.data(), cursor_}; }
  void insert(std::string_view text);
  /// Prompt, line and cursor anew, after something else was printed.
  void redraw();

 private:
  auto take_escape(char c) -> bool;
  void edit_key(char final_character);
  auto take_control(char c) -> bool;
  void insert(char c);
  void erase_before();
  void erase_from(std::size_t first, std::size_t count);
  void move_to(std::size_t cursor);
  void recall(std::size_t age);
  [[nodiscard]] auto remembered(std::size_t age) const -> std::string_view;
  void forget();

  Print& out_;
  bool echo_;
  std::array<char, kLength> line_{};
  std::size_t length_ = 0;
  std::size_t cursor_ = 0;
  bool too_long_ = false;
  bool damaged_ = false;
  bool hidden_ = false;
  bool was_recalled_ = false;
  bool heard_damage_ = false;
  char last_ = 0;
  enum class Escape : std::uint8_t { kNone, kBegun, kSequence };
  Escape escape_ = Escape::kNone;
  char escape_digit_ = 0;
  std::array<char, kHistoryBytes> history_{};  // lines, each with a zero behind it, oldest first
  std::size_t history_size_ = 0;
  std::size_t recalled_ = 0;  // how old the line that is shown is; 0: a new one
};

}  // namespace capstan
