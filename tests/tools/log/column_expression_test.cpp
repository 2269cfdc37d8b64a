// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/log/column_expression.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "capstan/tools/log/csv_log.hpp"
#include "capstan/tools/support/errors.hpp"

namespace capstan::tools {
namespace {

const std::vector<std::string> kNames = {"a", "b", "a-b", "Motor [deg]", "2", "axis0/q1_rad", "strom(A)", "grüße"};

/// With a = 2, b = 5, "a-b" = 100, "Motor [deg]" = 180, "2" = 7, "axis0/q1_rad" = 11, "strom(A)" = 13, "grüße" = 17.
auto value_of(const std::string& text) -> double {
  const std::vector<double> all = {2, 5, 100, 180, 7, 11, 13, 17};
  const ColumnExpression expression(text, kNames);
  std::vector<Eigen::VectorXd> values;
  for (const std::size_t index : expression.columns()) {
    values.push_back(Eigen::VectorXd::Constant(3, all[index]));
  }
  return expression.evaluate(values)[2];
}

TEST(ColumnExpression, SumsDifferencesAndFactors) {
  EXPECT_EQ(value_of("a+b"), 7.0);
  EXPECT_EQ(value_of("b - a"), 3.0);
  EXPECT_EQ(value_of("0.5*(a + b)"), 3.5);
  EXPECT_EQ(value_of("-a*3"), -6.0);
  EXPECT_EQ(value_of("2*a^2/4"), 2.0);
  EXPECT_EQ(value_of("1e-3*b"), 0.005);
  EXPECT_EQ(value_of(".5*a"), 1.0);
}

TEST(ColumnExpression, DegreesBecomeRadians) {
  EXPECT_DOUBLE_EQ(value_of("deg(Motor [deg])"), std::numbers::pi);
  EXPECT_DOUBLE_EQ(value_of("Motor [deg]*deg"), std::numbers::pi);
  EXPECT_DOUBLE_EQ(value_of("rad(a*pi/2)"), 180.0);
  EXPECT_DOUBLE_EQ(value_of("deg (Motor [deg] - 90 + 0*a)"), std::numbers::pi / 2);
}

TEST(ColumnExpression, FunctionsAreTheirs) {
  EXPECT_DOUBLE_EQ(value_of("sin(a) + cos(a) + abs(-b) + sqrt(b) + sign(-a)"),
                   std::sin(2.0) + std::cos(2.0) + 5.0 + std::sqrt(5.0) - 1.0);
}

TEST(ColumnExpression, NamesMayHoldAnyCharacterAndTheLongestCounts) {
  EXPECT_EQ(value_of("a-b"), 100.0);
  EXPECT_EQ(value_of("a - b"), -3.0);
  EXPECT_EQ(value_of("axis0/q1_rad*2"), 22.0);
  EXPECT_EQ(value_of("2*strom(A)"), 26.0);
  EXPECT_EQ(value_of("grüße+a"), 19.0);
  EXPECT_EQ(value_of("'2' + 2*a"), 11.0);
  EXPECT_EQ(value_of("'a' - b"), -3.0);
}

TEST(ColumnExpression, WhatIsNoneIsRefusedWithTheReason) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"a +", "it ends too early"},
      {"(a", "it ends too early"},
      {"a b", "do not fit together"},
      {"a = 3", "'=' has no meaning here"},
      {"a ? b : a", "'?' has no meaning here"},
      {"c*2", "there is no column c"},
      {"exp(a)", "there is no column exp"},
      {"'x'", "there is no column 'x'"},
      {"'a", "there is no column"},
      {"3", "it names no column"},
      {"3a", "'3a' is neither a number nor a column"},
      {"1e999*a", "is neither a number"},
      {"", "it names no column"},
      {"a" + std::string(1000, '+') + "b", "longer than 1000"},
  };
  for (const auto& [text, reason] : cases) {
    try {
      value_of(text);
      FAIL() << text;
    } catch (const BadExpression& why) {
      EXPECT_NE(std::string(why.what()).find(reason), std::string::npos) << text << ": " << why.what();
    }
  }
}

TEST(CsvLogMap, ExpressionsAreWorkedOutRowByRow) {
  const CsvLog log = CsvLog::parse("t,left,right\n0,90,30\n1,180,60\n", "x.csv",
                                   parse_mappings({"time_s=t", "axis0/q1_rad=deg(0.5*(left + right))"}));
  EXPECT_DOUBLE_EQ(log.column("axis0/q1_rad")[0], std::numbers::pi / 3);
  EXPECT_DOUBLE_EQ(log.column("axis0/q1_rad")[1], 2 * std::numbers::pi / 3);
}

TEST(CsvLogMap, ARowWithoutAValueIsNamedWithItsLine) {
  const CsvLog log = CsvLog::parse("time_s,a,b\n0,1,2\n1,1,0\n", "x.csv", parse_mappings({"axis0/tau_Nm=a/b"}));
  try {
    static_cast<void>(log.column("axis0/tau_Nm"));
    FAIL();
  } catch (const BadInput& refusal) {
    EXPECT_NE(std::string(refusal.what()).find("has no value at line 3 of x.csv"), std::string::npos) << refusal.what();
  }
}

TEST(CsvLogMap, ABadExpressionIsRefusedWithTheForms) {
  for (const char* bad : {"a*x", "(a", "a b"}) {
    const CsvLog log = CsvLog::parse("time_s,a,b\n0,1,2\n1,1,0\n", "x.csv", parse_mappings({"q=" + std::string(bad)}));
    EXPECT_TRUE(log.has("q"));
    EXPECT_THROW(static_cast<void>(log.column("q")), BadInput) << bad;
  }
}

}  // namespace
}  // namespace capstan::tools
