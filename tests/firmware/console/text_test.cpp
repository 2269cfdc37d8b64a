// SPDX-License-Identifier: Apache-2.0
#include "capstan/firmware/console/text.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <cstdlib>

#include "capstan/tests/firmware/support.hpp"

namespace capstan {
namespace {

template <typename T>
auto printed(T value) -> std::string {
  test::StringSink sink;
  Print(sink) << value;
  return sink.take();
}

/// Parses the whole of `text`; lowest() marks a refusal, with the reason in `result`.
auto parsed(std::string_view text, ParseResult& result) -> Q24 {
  Q24 value;
  std::size_t used = 0;
  result = parse_real(text, value, used);
  return value;
}

auto reads_back(std::int32_t raw) -> bool {
  const std::string text = printed(Q24::from_raw(raw));
  Q24 value;
  std::size_t used = 0;
  return parse_real(text, value, used) == ParseResult::kOk && used == text.size() && value.raw() == raw;
}

/// The distance of the parsed number from the C library's reading of the same text, in units of 2^-24.
auto error_in_steps(const std::string& text) -> double {
  ParseResult result{};
  const Q24 value = parsed(text, result);
  EXPECT_EQ(result, ParseResult::kOk) << text;
  return std::fabs(std::strtod(text.c_str(), nullptr) * 16777216.0 - static_cast<double>(value.raw()));
}

TEST(Text, CornersOfTheFormatReadBackAsPrinted) {
  for (const std::int32_t raw :
       {0, 1, -1, INT32_MAX, INT32_MIN, INT32_MAX - 1, INT32_MIN + 1, 1 << 23, -(1 << 23), 1 << 24}) {
    EXPECT_TRUE(reads_back(raw)) << raw;
  }
}

RC_GTEST_PROP(Text, AnyQuantityReadsBackAsPrinted, (std::int32_t raw)) {
  RC_ASSERT(reads_back(raw));
}

TEST(Text, SmallQuantitiesReadBackAsPrinted) {
  for (std::int32_t raw = -3000; raw <= 3000; ++raw) {
    ASSERT_TRUE(reads_back(raw)) << raw;
  }
}

TEST(Text, RoundNumbersArePrintedWithoutFalseDigits) {
  EXPECT_EQ(printed(Q24::from_double(0.02)), "0.02");
  EXPECT_EQ(printed(Q24::from_double(-0.5)), "-0.5");
  EXPECT_EQ(printed(Q24::from_int(100)), "100");
  EXPECT_EQ(printed(Q24{}), "0");
  EXPECT_EQ(printed(Q24::from_raw(1)), "0.00000006");
  EXPECT_EQ(printed(Q24::lowest()), "-128");
}

TEST(Text, IntegersArePrintedWithAllTheirDigits) {
  EXPECT_EQ(printed(std::int32_t{INT32_MIN}), "-2147483648");
  EXPECT_EQ(printed(std::int32_t{INT32_MAX}), "2147483647");
  EXPECT_EQ(printed(std::uint32_t{0}), "0");
  EXPECT_EQ(printed(std::uint32_t{UINT32_MAX}), "4294967295");
}

RC_GTEST_PROP(Text, ADecimalReadsAsTheNearestQuantity, ()) {
  const int whole = *rc::gen::inRange(-127, 128);
  const auto digits = *rc::gen::container<std::string>(rc::gen::inRange('0', static_cast<char>('9' + 1)));
  const std::string text = std::to_string(whole) + "." + digits;
  RC_ASSERT(error_in_steps(text) <= 0.5 + 1e-6);
}

RC_GTEST_PROP(Text, AnExponentMovesTheDecimalPoint, ()) {
  const int exponent = *rc::gen::inRange(-12, 13);
  const int mantissa = *rc::gen::inRange(-999999, 1000000);
  const std::string text =
      std::to_string(mantissa) + (*rc::gen::arbitrary<bool>() ? "e" : "E") + std::to_string(exponent);
  const double exact = std::strtod(text.c_str(), nullptr);
  ParseResult result{};
  const Q24 value = parsed(text, result);
  if (std::fabs(exact) < 127.9999) {
    RC_ASSERT(result == ParseResult::kOk);
    RC_ASSERT(std::fabs(exact * 16777216.0 - static_cast<double>(value.raw())) <= 0.5 + 1e-6);
  } else {
    RC_ASSERT(result == ParseResult::kOutOfRange);
  }
}

TEST(Text, LongDigitStringsReadAsTheNearestQuantity) {
  for (const char* text :
       {"3.14159265358979323846264338327950288419716939937510", "0000000000000000000000000000000000012.5",
        "0.000000000000000000000000000000000000000000000000001", "127.99999994039535522460937500",
        "99999999999999999999999999e-25", "1e-400", "0e999999", "0.1e+2", "00.50"}) {
    EXPECT_LE(error_in_steps(text), 0.5 + 1e-6) << text;
  }
}

TEST(Text, NumbersBeyondTheFormatAreOutOfRange) {
  for (const char* text :
       {"128", "-128.1", "1e3", "1e9999", "99999999999999999999999999999999", "127.99999998", "1e99999999999"}) {
    ParseResult result{};
    static_cast<void>(parsed(text, result));
    EXPECT_EQ(result, ParseResult::kOutOfRange) << text;
  }
}

TEST(Text, WordsAndEmptinessAreNotNumbers) {
  for (const char* text :
       {"", "-", "+", ".", "-.", "nan", "NaN", "inf", "-inf", "infinity", "e5", ".e5", "x", " 1", "--1", "+-1"}) {
    ParseResult result{};
    static_cast<void>(parsed(text, result));
    EXPECT_EQ(result, ParseResult::kNotANumber) << text;
  }
}

TEST(Text, WhatFollowsTheNumberIsLeftToTheUnit) {
  Q24 value;
  std::size_t used = 0;
  for (const auto& [text, length] :
       {std::pair{"30deg", 2U}, {"5e", 1U}, {"5e-", 1U}, {"1.5e2x", 5U}, {"2. rad", 2U}, {"0x10", 1U}}) {
    EXPECT_NE(parse_real(text, value, used), ParseResult::kNotANumber) << text;
    EXPECT_EQ(used, length) << text;
  }
}

TEST(Text, ARefusedNumberLeavesTheValueAlone) {
  Q24 value = Q24::from_int(7);
  std::size_t used = 0;
  EXPECT_NE(parse_real("1000", value, used), ParseResult::kOk);
  EXPECT_NE(parse_real("nan", value, used), ParseResult::kOk);
  EXPECT_EQ(value, Q24::from_int(7));
}

RC_GTEST_PROP(Text, DegreesBecomeRadians, ()) {
  const int tenths = *rc::gen::inRange(-73000, 73001);
  const std::string text = std::to_string(tenths / 10) + "." + std::to_string(std::abs(tenths % 10));
  Q24 value;
  std::size_t used = 0;
  RC_ASSERT(parse_scaled(text, {.degrees = true}, value, used) == ParseResult::kOk);
  const double exact = std::strtod(text.c_str(), nullptr) * 3.14159265358979323846 / 180.0;
  RC_ASSERT(std::fabs(value.to_double() - exact) <= 1.3e-7 + 1e-8 * std::fabs(exact));
}

TEST(Text, ANumberInASmallUnitMayItselfBeBeyondTheFormat) {
  Q24 value;
  std::size_t used = 0;
  ASSERT_EQ(parse_scaled("250", {.exponent = -3}, value, used), ParseResult::kOk);
  EXPECT_EQ(value, Q24::from_double(0.25));
  ASSERT_EQ(parse_scaled("-127999", {.exponent = -3}, value, used), ParseResult::kOk);
  EXPECT_EQ(value, Q24::from_double(-127.999));
  EXPECT_EQ(parse_scaled("128000", {.exponent = -3}, value, used), ParseResult::kOutOfRange);
  EXPECT_EQ(parse_scaled("7334", {.degrees = true}, value, used), ParseResult::kOutOfRange);
  EXPECT_EQ(parse_scaled("1e9", {.degrees = true}, value, used), ParseResult::kOutOfRange);
}

TEST(Text, IntegersReadUpToTheirLimitsAndNoFurther) {
  std::int32_t value = 0;
  EXPECT_EQ(parse_integer("2147483647", value), ParseResult::kOk);
  EXPECT_EQ(value, INT32_MAX);
  EXPECT_EQ(parse_integer("-2147483648", value), ParseResult::kOk);
  EXPECT_EQ(value, INT32_MIN);
  EXPECT_EQ(parse_integer("+17", value), ParseResult::kOk);
  EXPECT_EQ(value, 17);
  for (const char* text : {"2147483648", "-2147483649", "99999999999999999999999999999999999999"}) {
    EXPECT_EQ(parse_integer(text, value), ParseResult::kOutOfRange) << text;
  }
  for (const char* text : {"", "-", "+", "1.0", "1e3", "0x10", "12 ", " 12", "nan", "1-"}) {
    EXPECT_EQ(parse_integer(text, value), ParseResult::kNotANumber) << text;
  }
  EXPECT_EQ(value, 17) << "a refused number must leave the value alone";
}

RC_GTEST_PROP(Text, AnyIntegerReadsBackAsPrinted, (std::int32_t number)) {
  std::int32_t value = 0;
  RC_ASSERT(parse_integer(printed(number), value) == ParseResult::kOk);
  RC_ASSERT(value == number);
}

TEST(Text, WordsAreTakenFromTheFrontOneByOne) {
  std::string_view text = " \tset  a.b\t3 ";
  EXPECT_EQ(next_word(text), "set");
  EXPECT_EQ(next_word(text), "a.b");
  EXPECT_EQ(next_word(text), "3");
  EXPECT_EQ(next_word(text), "");
  EXPECT_EQ(next_word(text), "");
}

TEST(Text, ALineReachesItsSinkWholeAndWhatIsLongerInPieces) {
  struct Pieces final : TextSink {
    void do_write(std::string_view text) override { all.emplace_back(text); }
    std::vector<std::string> all;
  } pieces;
  LineSink lines(pieces);
  Print out(lines);
  out << "q2 " << 12 << ' ' << Q24::from_double(0.5);
  EXPECT_TRUE(pieces.all.empty());
  out << "\r\n";
  EXPECT_EQ(pieces.all, std::vector<std::string>{"q2 12 0.5\r\n"});
  out << "capstan> ";
  lines.flush();
  lines.flush();
  EXPECT_EQ(pieces.all.back(), "capstan> ");
  ASSERT_EQ(pieces.all.size(), 2U);
  const std::string longer(300, 'x');
  out << longer << "\n";
  std::string joined;
  for (std::size_t i = 2; i < pieces.all.size(); ++i) {
    EXPECT_LE(pieces.all[i].size(), 128U);
    joined += pieces.all[i];
  }
  EXPECT_EQ(joined, longer + "\n");
}

}  // namespace
}  // namespace capstan
