// SPDX-License-Identifier: Apache-2.0
#include "capstan/firmware/console/text.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

namespace capstan {
namespace {

constexpr auto is_digit(char c) -> bool {
  return c >= '0' && c <= '9';
}
constexpr auto is_blank(char c) -> bool {
  return c == ' ' || c == '\t';
}

/// A decimal number mantissa * 10^exponent.
struct Decimal {
  std::int64_t mantissa = 0;
  int exponent = 0;
  bool any = false;
};

void take_digits(std::string_view text, std::size_t& at, bool fraction, Decimal& number) {
  for (; at < text.size() && is_digit(text[at]); ++at) {
    number.any = true;
    if (number.mantissa < 1'000'000'000'000'000) {
      number.mantissa = number.mantissa * 10 + (text[at] - '0');
      number.exponent -= fraction ? 1 : 0;
    } else {
      number.exponent += fraction ? 0 : 1;
    }
  }
}

auto take_exponent(std::string_view text, std::size_t& at) -> int {
  std::size_t look = at;
  if (look >= text.size() || (text[look] != 'e' && text[look] != 'E')) {
    return 0;
  }
  ++look;
  bool negative = false;
  if (look < text.size() && (text[look] == '-' || text[look] == '+')) {
    negative = text[look] == '-';
    ++look;
  }
  if (look >= text.size() || !is_digit(text[look])) {
    return 0;  // the letter belongs to a unit
  }
  int exponent = 0;
  for (; look < text.size() && is_digit(text[look]); ++look) {
    exponent = exponent < 1000 ? exponent * 10 + (text[look] - '0') : exponent;
  }
  at = look;
  return negative ? -exponent : exponent;
}

/// mantissa * 10^exponent * 2^24, rounded to nearest; false if it is beyond kLargest.
auto scale_to_raw(Decimal number, std::int64_t& raw) -> bool {
  constexpr std::int64_t kLargest = 10'000;  // more degrees than the 128 rad of a quantity
  while (number.exponent > 0 && number.mantissa != 0 && number.mantissa <= kLargest) {
    number.mantissa *= 10;
    --number.exponent;
  }
  if (number.exponent > 0 && number.mantissa != 0) {
    return false;
  }
  for (; number.exponent < -17 && number.mantissa != 0; ++number.exponent) {
    number.mantissa /= 10;  // beyond the seventeenth decimal, far below the resolution
  }
  if (number.mantissa == 0) {
    raw = 0;
    return true;
  }
  std::int64_t divisor = 1;
  for (int exponent = number.exponent; exponent < 0; ++exponent) {
    divisor *= 10;
  }
  raw = number.mantissa / divisor;
  if (raw > kLargest) {
    return false;
  }
  std::int64_t rest = number.mantissa % divisor;
  for (int bit = 0; bit < Q24::kFrac; ++bit) {  // long division, one binary digit at a time
    rest *= 2;
    raw = raw * 2 + (rest >= divisor ? 1 : 0);
    rest -= rest >= divisor ? divisor : 0;
  }
  raw += rest * 2 >= divisor ? 1 : 0;
  return true;
}

/// pi / 180 in 30 binary places: right to 8e-9 of the value, which is below the resolution up to 3 rad.
constexpr std::int64_t kRadianPerDegree = 18740330;
constexpr int kRadianPerDegreeBits = 30;

}  // namespace

void LineSink::flush() {
  if (length_ > 0) {
    sink_.write({line_.data(), std::exchange(length_, 0)});
  }
}

void LineSink::do_write(std::string_view text) {
  const bool whole = !text.empty() && (text.back() == '\n' || text.back() == '\0');  // a line, or a frame
  while (!text.empty()) {
    const std::size_t count = std::min(text.size(), line_.size() - length_);
    std::copy_n(text.begin(), count, line_.begin() + static_cast<std::ptrdiff_t>(length_));
    length_ += count;
    text.remove_prefix(count);
    if (length_ == line_.size()) {
      flush();
    }
  }
  if (whole) {
    flush();
  }
}

auto Print::operator<<(std::string_view text) -> Print& {
  sink_.write(text);
  return *this;
}

auto Print::operator<<(std::uint32_t value) -> Print& {
  std::array<char, 10> digits{};
  std::size_t at = digits.size();
  do {
    digits[--at] = static_cast<char>('0' + value % 10);
    value /= 10;
  } while (value != 0);
  return *this << std::string_view(digits.data() + at, digits.size() - at);
}

auto Print::operator<<(std::int32_t value) -> Print& {
  if (value < 0) {
    *this << '-';
  }
  const auto wide = static_cast<std::int64_t>(value);
  return *this << static_cast<std::uint32_t>(wide < 0 ? -wide : wide);
}

auto Print::operator<<(Q24 value) -> Print& {
  const std::int64_t raw = value.raw();
  const std::int64_t magnitude = raw < 0 ? -raw : raw;
  // Eight decimals tell any two neighbours apart (2^-24 = 6e-8); fewer are printed where they read back the same.
  constexpr std::int64_t kScale = 100'000'000;
  std::int64_t decimals = (magnitude * kScale + (std::int64_t{1} << 23)) >> Q24::kFrac;
  int places = 8;
  std::int64_t unit = 1;
  while (places > 0) {
    const std::int64_t shorter = (decimals + 5 * unit) / (10 * unit) * (10 * unit);
    const std::int64_t back = ((shorter << Q24::kFrac) + kScale / 2) / kScale;
    if (back != magnitude) {
      break;
    }
    decimals = shorter;
    unit *= 10;
    --places;
  }
  if (raw < 0) {
    *this << '-';
  }
  *this << static_cast<std::uint32_t>(decimals / kScale);
  std::int64_t rest = decimals % kScale;
  if (places > 0) {
    *this << '.';
  }
  for (std::int64_t digit = kScale / 10; places > 0; --places, digit /= 10) {
    *this << static_cast<char>('0' + rest / digit);
    rest %= digit;
  }
  return *this;
}

void print_seconds(Print& out, std::uint32_t ms) {
  const std::uint32_t thousandths = ms % 1000;
  out << ms / 1000 << '.' << thousandths / 100 << thousandths / 10 % 10 << thousandths % 10;
}

auto parse_integer(std::string_view text, std::int32_t& value) -> ParseResult {
  Decimal number;
  std::size_t at = !text.empty() && (text[0] == '-' || text[0] == '+') ? 1 : 0;
  take_digits(text, at, false, number);
  if (!number.any || at != text.size()) {
    return ParseResult::kNotANumber;
  }
  const std::int64_t result = text[0] == '-' ? -number.mantissa : number.mantissa;
  if (number.exponent != 0 || result > INT32_MAX || result < INT32_MIN) {
    return ParseResult::kOutOfRange;
  }
  value = static_cast<std::int32_t>(result);
  return ParseResult::kOk;
}

auto parse_scaled(std::string_view text, const UnitScale& scale, Q24& value, std::size_t& used) -> ParseResult {
  Decimal number;
  std::size_t at = !text.empty() && (text[0] == '-' || text[0] == '+') ? 1 : 0;
  take_digits(text, at, false, number);
  if (at < text.size() && text[at] == '.') {
    ++at;
    take_digits(text, at, true, number);
  }
  if (!number.any) {
    return ParseResult::kNotANumber;
  }
  number.exponent += take_exponent(text, at) + scale.exponent;
  used = at;
  std::int64_t raw = 0;
  if (!scale_to_raw(number, raw)) {
    return ParseResult::kOutOfRange;
  }
  if (scale.degrees) {
    raw = shift_right_rounded<kRadianPerDegreeBits>(raw * kRadianPerDegree);
  }
  if (text[0] == '-') {
    raw = -raw;
  }
  if (raw > Q24::max().raw() || raw < Q24::lowest().raw()) {
    return ParseResult::kOutOfRange;
  }
  value = Q24::from_wide(raw);
  return ParseResult::kOk;
}

auto parse_real(std::string_view text, Q24& value, std::size_t& used) -> ParseResult {
  return parse_scaled(text, {}, value, used);
}

void skip_blanks(std::string_view& text) {
  while (!text.empty() && is_blank(text.front())) {
    text.remove_prefix(1);
  }
}

auto next_word(std::string_view& text) -> std::string_view {
  skip_blanks(text);
  std::size_t length = 0;
  while (length < text.size() && !is_blank(text[length])) {
    ++length;
  }
  const std::string_view word(text.data(), length);
  text.remove_prefix(length);
  return word;
}

}  // namespace capstan
