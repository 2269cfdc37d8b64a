// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "capstan/model/fixed.hpp"

namespace capstan {

/// Where the shell's answers go. Never blocks for long; a sink that is full drops and counts.
class TextSink {
 public:
  void write(std::string_view text) { do_write(text); }
  /// Characters that found no room since start.
  [[nodiscard]] auto dropped() const -> std::uint32_t { return do_dropped(); }

 protected:
  ~TextSink() = default;  // never owned through this face: a virtual one would need operator delete

 private:
  virtual void do_write(std::string_view text) = 0;
  [[nodiscard]] virtual auto do_dropped() const -> std::uint32_t { return 0; }
};

/// Collects a line, or what there is when it is flushed, before it is handed on: a sink that waits for room in vain
/// then waits once for it, and not for each of the parts it is put together from.
class LineSink final : public TextSink {
 public:
  explicit LineSink(TextSink& sink) : sink_(sink) {}
  void flush();

 private:
  void do_write(std::string_view text) override;
  [[nodiscard]] auto do_dropped() const -> std::uint32_t override { return sink_.dropped(); }

  TextSink& sink_;
  std::array<char, 128> line_{};
  std::size_t length_ = 0;
};

/// Formats without heap, floating point or printf: the target has none of them.
class Print {
 public:
  explicit Print(TextSink& sink) : sink_(sink) {}
  auto operator<<(std::string_view text) -> Print&;
  auto operator<<(const char* text) -> Print& { return *this << std::string_view(text); }
  auto operator<<(char c) -> Print& { return *this << std::string_view(&c, 1); }
  auto operator<<(std::int32_t value) -> Print&;
  auto operator<<(std::uint32_t value) -> Print&;
  /// Shortest decimal that reads back as the same number.
  auto operator<<(Q24 value) -> Print&;

 private:
  TextSink& sink_;
};

/// A time in s from milliseconds, with three decimals: exact.
void print_seconds(Print& out, std::uint32_t ms);

enum class ParseResult : std::uint8_t { kOk, kNotANumber, kOutOfRange };

/// Reads a whole decimal integer.
auto parse_integer(std::string_view text, std::int32_t& value) -> ParseResult;
/// Reads a decimal number such as -1.25, .5 or 3e-2 and rounds it to the nearest Q24. `used` is how many characters
/// belong to the number; what follows is the unit. "nan" and "inf" are not numbers. `value` is set only if the result
/// is kOk.
auto parse_real(std::string_view text, Q24& value, std::size_t& used) -> ParseResult;

/// A unit that people type instead of the one a quantity has: value = number * 10^exponent, and from degrees to rad if
/// so said.
struct UnitScale {
  std::int32_t exponent = 0;
  bool degrees = false;
};
/// The same for a number in another unit, which alone may lie outside Q24: 500 (mA) is 0.5 A.
auto parse_scaled(std::string_view text, const UnitScale& scale, Q24& value, std::size_t& used) -> ParseResult;

/// Takes blanks and tabs off the front of `text`.
void skip_blanks(std::string_view& text);
/// Takes the next word, separated by blanks, off the front of `text`; empty at the end.
auto next_word(std::string_view& text) -> std::string_view;

}  // namespace capstan
