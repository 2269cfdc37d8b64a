// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/log/csv_log.hpp"

#include <gtest/gtest.h>

#include <functional>

#include "capstan/model/fixed.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

auto message_of(const std::function<void()>& action) -> std::string {
  try {
    action();
  } catch (const BadInput& error) {
    return error.what();
  }
  return "nothing was thrown";
}

TEST(CsvLog, ReadsColumnsByName) {
  const CsvLog log = CsvLog::parse("time_s,a\n0,1.5\n0.1,-2e-3\n", "x.csv");
  EXPECT_EQ(log.rows(), 2U);
  EXPECT_EQ(log.column("a")[1], -2e-3);
  EXPECT_TRUE(log.warnings().empty());
}

TEST(CsvLog, TakesWindowsLineEndsAndAByteOrderMark) {
  const CsvLog log = CsvLog::parse("\xEF\xBB\xBFtime_s,a\r\n0,1\r\n1,2\r\n", "x.csv");
  EXPECT_EQ(log.column("a")[1], 2.0);
  EXPECT_EQ(log.time()[1], 1.0);
}

TEST(CsvLog, MappedColumnsAreScaled) {
  const CsvLog log = CsvLog::parse("t,i\n0,2\n1,4\n", "x.csv", parse_mappings({"time_s=t", "axis0/tau_Nm=i*0.5"}));
  EXPECT_TRUE(log.has("axis0/tau_Nm"));
  EXPECT_EQ(log.column("axis0/tau_Nm")[1], 2.0);
}

TEST(CsvLog, AMissingColumnIsNamedWithThoseThatExistAndTheCure) {
  const CsvLog log = CsvLog::parse("time_s,b\n0,1\n", "x.csv");
  const std::string message = message_of([&] { static_cast<void>(log.column("a")); });
  EXPECT_NE(message.find("x.csv:1: there is no column a among time_s, b"), std::string::npos) << message;
  EXPECT_NE(message.find("--map a=COLUMN"), std::string::npos) << message;
}

TEST(CsvLog, AMappingToAColumnThatIsNotThereNamesThatColumn) {
  const CsvLog log = CsvLog::parse("time_s,b\n0,1\n", "x.csv", parse_mappings({"a=c"}));
  EXPECT_NE(message_of([&] { static_cast<void>(log.column("a")); }).find("no column c"), std::string::npos);
}

TEST(CsvLog, ACellThatIsNoNumberIsNamedWithItsLine) {
  for (const char* cell : {"nan", "inf", "", "abc", "1;2"}) {
    const CsvLog log = CsvLog::parse(std::string("time_s,a\n0,1\n1,") + cell + "\n2,3\n", "x.csv");
    const std::string message = message_of([&] { static_cast<void>(log.column("a")); });
    EXPECT_NE(message.find("x.csv:3: column a holds '" + std::string(cell) + "'"), std::string::npos) << message;
  }
}

TEST(CsvLog, WhatIsNotAskedForIsNotJudged) {
  const CsvLog log = CsvLog::parse("time_s,a,remark\n0,1,nan\n1,2,hello\n", "x.csv");
  EXPECT_EQ(log.column("a").sum(), 3.0);
}

TEST(CsvLog, RepeatedAndBackwardTimeAreToldApartWithTheirLine) {
  const CsvLog repeated = CsvLog::parse("time_s\n0\n1\n1\n", "x.csv");
  EXPECT_NE(message_of([&] { static_cast<void>(repeated.time()); }).find("x.csv:4: time_s repeats 1"),
            std::string::npos);
  const CsvLog backward = CsvLog::parse("time_s\n0\n1\n0.5\n", "x.csv");
  EXPECT_NE(message_of([&] { static_cast<void>(backward.time()); }).find("x.csv:4: time_s runs backward to 0.5"),
            std::string::npos);
}

TEST(CsvLog, ALastLineThatIsCutOffIsDroppedWithAWarning) {
  for (const char* text : {"time_s,a\n0,1\n1,2\n2", "time_s,a\n0,1\n1,2\n2,3", "time_s,a\n0,1\n1,2\n2\n"}) {
    const CsvLog log = CsvLog::parse(text, "x.csv");
    EXPECT_EQ(log.rows(), 2U) << text;
    ASSERT_EQ(log.warnings().size(), 1U) << text;
    EXPECT_NE(log.warnings()[0].find("x.csv:4:"), std::string::npos) << log.warnings()[0];
  }
}

TEST(CsvLog, AShortLineInTheMiddleIsRefusedWithItsNumber) {
  EXPECT_NE(message_of([] { CsvLog::parse("time_s,a\n0,1\n1\n2,3\n", "x.csv"); }).find("x.csv:3: the line has 1 cells"),
            std::string::npos);
}

TEST(CsvLog, ALogWithoutRowsOrHeaderIsRefused) {
  EXPECT_THROW(CsvLog::parse("", "x.csv"), BadInput);
  EXPECT_THROW(CsvLog::parse("time_s,a\n", "x.csv"), BadInput);
  EXPECT_THROW(CsvLog::parse("0,1\n1,2\n", "x.csv"), BadInput);
  EXPECT_THROW(CsvLog::parse("a,a\n1,2\n", "x.csv"), BadInput);
  EXPECT_THROW(CsvLog::read("/no/such/file.csv"), BadInput);
}

TEST(CsvLog, ALogWithoutHeaderIsToldSoAlsoIfItsFirstRowRepeatsANumber) {
  const auto refusal = [](const char* text) -> std::string {
    try {
      static_cast<void>(CsvLog::parse(text, "x.csv"));
      return "";
    } catch (const BadInput& problem) {
      return problem.what();
    }
  };
  EXPECT_NE(refusal("0,0,0.52,0.06\n0.01,0,0.5,0.06\n").find("the first line holds numbers"), std::string::npos);
  EXPECT_NE(refusal("time_s,a,a\n0,1,2\n").find("column a appears twice"), std::string::npos);
}

TEST(CsvLog, MinutesAndSecondsGoOnOverTheFullHourAndHoursOverMidnight) {
  const auto end = [](const char* rows) {
    const Eigen::VectorXd time = CsvLog::parse(std::string("time_s,a\n") + rows, "x.csv").time();
    return time[time.size() - 1];
  };
  EXPECT_NEAR(end("59:59.900,1\n00:00.000,1\n00:00.100,1\n"), 0.2, 1e-9);
  EXPECT_NEAR(end("23:59:59.900,1\n00:00:00.000,1\n00:00:00.100,1\n"), 0.2, 1e-9);
}

TEST(CsvLog, TimesOfTooFewDigitsAreToldSo) {
  std::string rows = "time_s,a\n";
  for (int i = 0; i < 40; ++i) {
    rows += (i < 20 ? "1.7e+09,1\n" : "1.70001e+09,1\n");
  }
  try {
    static_cast<void>(CsvLog::parse(rows, "x.csv").time());
    FAIL();
  } catch (const BadInput& problem) {
    EXPECT_NE(std::string(problem.what()).find("export the times with more digits"), std::string::npos)
        << problem.what();
  }
}

TEST(CsvLog, RemarksOfABoardAreSkippedAndLineNumbersCountThem) {
  const CsvLog log = CsvLog::parse("# no stiffness\ntime_s,a\n0,1\n# site 3\n1,2\n# site 4 stiffness 0.1\n", "x.csv");
  EXPECT_EQ(log.column("a"), Eigen::Vector2d(1.0, 2.0));
  EXPECT_TRUE(log.warnings().empty());
  try {
    static_cast<void>(CsvLog::parse("# told\ntime_s,a\n0,1\n1\n2,3\n", "x.csv"));
    FAIL();
  } catch (const BadInput& bad) {
    EXPECT_NE(std::string(bad.what()).find("x.csv:4"), std::string::npos) << bad.what();
  }
  EXPECT_THROW(CsvLog::parse("# nothing else\n", "x.csv"), BadInput);
}

TEST(CsvLog, AppendedColumnsLeaveTheOthersAsTheyWereWritten) {
  const CsvLog log = CsvLog::parse("time_s,a\n0,1.500\n1,2e0\n", "x.csv");
  const std::string text = log.text_with({"b"}, {Eigen::Vector2d(0.25, -1.0)});
  EXPECT_EQ(text.substr(0, 28), "time_s,a,b\n0,1.500,0.2500000");
  EXPECT_EQ(CsvLog::parse(text, "y.csv").column("b")[1], -1.0);
}

TEST(CsvLog, AColumnOfTheSameNameIsReplacedNotDoubled) {
  const CsvLog log = CsvLog::parse("time_s,b,a\n0,9,1\n1,9,2\n", "x.csv");
  const CsvLog again = CsvLog::parse(log.text_with({"b"}, {Eigen::Vector2d(5.0, 6.0)}), "y.csv");
  EXPECT_EQ(again.column_names(), (std::vector<std::string>{"time_s", "a", "b"}));
  EXPECT_EQ(again.column("b")[0], 5.0);
}

TEST(CsvLog, PrintedNumbersBringBackEveryStepOfTheFirmwareFormat) {
  for (std::int32_t raw = -2000000000; raw < 2000000000; raw += 39999979) {
    const double value = Q24::from_raw(raw).to_double();
    const auto read = parse_number(log_number(value));
    ASSERT_TRUE(read.has_value());
    EXPECT_EQ(Q24::from_double(*read).raw(), raw);
  }
}

}  // namespace
}  // namespace capstan::tools
