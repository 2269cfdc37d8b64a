// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/log/axis_gate.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "capstan/tests/tools/log/small_log.hpp"
#include "capstan/tools/log/channel_shape.hpp"
#include "capstan/tools/log/time_scale.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using namespace test;

auto text_of(const Log& log, double unit, bool slow_joint = false, Index repeat = 1) -> std::string {
  std::string text = "time_s,axis0/q1_rad,axis0/tau_Nm,axis0/q2_rad\n";
  for (Index i = 0; i < kRows; ++i) {
    const Index k = i - i % repeat;
    text += exact(unit * kPeriod * static_cast<double>(i)) + "," + exact(log.q1[k]) + "," + exact(log.tau[k]) + "," +
            (slow_joint && i % 4 != 0 ? "" : exact(log.q2[k])) + "\n";
  }
  return text;
}

TEST(AxisLogGate, TimeInAnotherUnitIsRefusedWithTheCureAndTakesNoLonger) {
  for (const auto& [unit, word] : {std::pair{1e3, "1e-3"}, {1e6, "1e-6"}, {1e9, "1e-9"}}) {
    const std::string text = text_of({}, unit);
    try {
      read_axis(CsvLog::parse(text, "x.csv"), {});
      FAIL() << unit;
    } catch (const BadInput& refusal) {
      EXPECT_NE(std::string(refusal.what()).find("--map \"time_s=time_s*" + std::string(word)), std::string::npos)
          << refusal.what();
    }
    const auto cured =
        read_axis(CsvLog::parse(text, "x.csv", parse_mappings({"time_s=time_s*" + std::string(word)})), {});
    EXPECT_NEAR(cured.period_s, kPeriod, 1e-9);
    EXPECT_GT(read_axis(CsvLog::parse(text, "x.csv", parse_mappings({"time_s=time_s*1"})), {}).period_s, 1.0);
  }
  EXPECT_TRUE(time_unit_fault(0.25).empty());
}

TEST(AxisLogGate, StepsOfTimeThatTwoUnitsMakeALikelyLogOfNameBothWithTheirRates) {
  const std::string tens = time_unit_fault(100.0);
  EXPECT_NE(tens.find("milliseconds (10 Hz) or microseconds (10000 Hz)"), std::string::npos) << tens;
  EXPECT_NE(tens.find("time_s*1e-3\" or --map \"time_s=time_s*1e-6\""), std::string::npos) << tens;
  EXPECT_NE(time_unit_fault(1e5).find("microseconds (10 Hz) or nanoseconds (10000 Hz)"), std::string::npos);
  EXPECT_EQ(time_unit_fault(1000.0).find("milli"), std::string::npos) << "no joint is logged at 1 Hz";
  EXPECT_NE(time_unit_fault(0.5).find("milliseconds (2000 Hz), not"), std::string::npos) << time_unit_fault(0.5);
  EXPECT_NE(time_unit_fault(1e12).find("FACTOR"), std::string::npos);
}

TEST(AxisLogGate, AWildValueIsNamedByItsLineAndAStraightLineTakesItsPlace) {
  Log log;
  log.q2[100] = 50.0;
  const AxisLog axis = read_axis(CsvLog::parse(text_of(log, 1.0), "x.csv"), {});
  ASSERT_EQ(axis.warnings.size(), 1U);
  EXPECT_NE(axis.warnings[0].find("x.csv:102: axis0/q2_rad stands out"), std::string::npos) << axis.warnings[0];
  EXPECT_LT(std::abs(axis.q2_rad[100]), 1.0);
  AxisRequest all;
  all.every_row = true;
  EXPECT_EQ(read_axis(CsvLog::parse(text_of(log, 1.0), "x.csv"), all).q2_rad[100], 50.0);
}

TEST(AxisLogGate, WildValuesAreNamedByTheirLines) {
  Log log;
  for (Index k = 1; k <= 10; ++k) {
    log.q2[100 * k] = 50.0;
  }
  const AxisLog axis = read_axis(CsvLog::parse(text_of(log, 1.0), "x.csv"), {});
  ASSERT_EQ(axis.warnings.size(), 1U);
  EXPECT_NE(axis.warnings[0].find("(lines 102, 202, 302, 402, 502, 602, 702, 802 and 2 more)"), std::string::npos)
      << axis.warnings[0];
}

TEST(AxisLogGate, TheCureOfDegreesReadsTheColumnThatWasMapped) {
  Log log;
  log.q2 *= 57.29577951308232;
  std::string text = text_of(log, 1.0);
  text.replace(text.find("axis0/q2_rad"), 12, "elbow");
  for (const auto& [mapping, cure] :
       {std::pair("axis0/q2_rad=elbow", "deg(elbow)"), {"axis0/q2_rad=elbow*1.5", "deg((elbow*1.5))"}}) {
    const AxisLog axis = read_axis(CsvLog::parse(text, "x.csv", parse_mappings({mapping})), {});
    ASSERT_EQ(axis.warnings.size(), 1U);
    const std::string option = std::string("--map \"axis0/q2_rad=") + cure + "\"";
    ASSERT_NE(axis.warnings[0].find(option), std::string::npos) << axis.warnings[0];
    const auto cured = parse_mappings({std::string("axis0/q2_rad=") + cure});
    EXPECT_LT(read_axis(CsvLog::parse(text, "x.csv", cured), {}).q2_rad.maxCoeff(), 2.0);
  }
}

TEST(AxisLogGate, OfRowsThatRepeatOnlyTheMeasuredOnesAreUsed) {
  const AxisLog axis = read_axis(CsvLog::parse(text_of({}, 1.0, false, 5), "x.csv"), {});
  EXPECT_EQ(axis.samples(), kRows / 5);
  EXPECT_NEAR(axis.period_s, 5 * kPeriod, 1e-9);
  EXPECT_NE(axis.warnings.back().find("40 Hz"), std::string::npos) << axis.warnings.back();
}

TEST(AxisLogGate, OfTwoRatesTheSlowersRowsAreUsed) {
  const Log log;
  const AxisLog axis = read_axis(CsvLog::parse(text_of(log, 1.0, true), "x.csv"), {});
  EXPECT_EQ(axis.samples(), kRows / 4);
  EXPECT_EQ(axis.q1_rad[10], log.q1[40]);
  ASSERT_FALSE(axis.warnings.empty());
  EXPECT_NE(axis.warnings[0].find("1000 rows of axis0/q2_rad, the slowest"), std::string::npos) << axis.warnings[0];
}

TEST(AxisLogGate, ACellThatIsMissingIsNoOtherRate) {
  const std::string text = text_of({}, 1.0, false);
  std::size_t cell = 0;
  for (int line = 0; line < 12; ++line) {
    cell = text.find('\n', cell) + 1;
  }
  const std::size_t first = text.find(',', cell) + 1;
  const AxisLog axis =
      read_axis(CsvLog::parse(text.substr(0, first) + text.substr(text.find_first_of(",\n", first)), "x.csv"), {});
  EXPECT_EQ(axis.samples(), kRows - 1);
  EXPECT_NE(axis.warnings[0].find("1 row has no number for axis0/q1_rad"), std::string::npos) << axis.warnings[0];
}

/// The joint's angle comes from a camera that has a new picture every so many rows.
auto with_camera(Index rows, Index late = 0) -> Log {
  Log log;
  const VectorXd seen = held_back(log.q2, late);
  for (Index i = 0; i < kRows; ++i) {
    log.q2[i] = seen[i - i % rows];
  }
  return log;
}

TEST(AxisLogGate, OfAJointThatACameraSeesOnlyThePicturesAreUsed) {
  const Log log = with_camera(20);
  const AxisLog axis = read_axis(CsvLog::parse(text_of(log, 1.0), "x.csv"), {});
  EXPECT_NEAR(static_cast<double>(axis.samples()), kRows / 20.0, 2.0);
  EXPECT_NEAR(axis.period_s, 20 * kPeriod, 1e-9);
  for (Index i = 0; i < axis.samples(); ++i) {
    const auto row = static_cast<Index>(std::lround(axis.time_s[i] / kPeriod));
    ASSERT_EQ(row % 20, 0);
    ASSERT_EQ(axis.q1_rad[i], log.q1[row]);
  }
  ASSERT_EQ(axis.warnings.size(), 1U);
  EXPECT_NE(axis.warnings[0].find("axis0/q2_rad has a new value only every 20 samples; only those"), std::string::npos)
      << axis.warnings[0];
}

TEST(AxisLogGate, WhoReplaysALogHasEveryRowOfACamera) {
  AxisRequest all;
  all.every_row = true;
  const AxisLog axis = read_axis(CsvLog::parse(text_of(with_camera(20), 1.0), "x.csv"), all);
  EXPECT_EQ(axis.samples(), kRows);
  ASSERT_EQ(axis.warnings.size(), 1U);
  EXPECT_NE(axis.warnings[0].find("late by half of that"), std::string::npos) << axis.warnings[0];
}

TEST(AxisLogGate, ACameraThatIsLateByItselfIsSaidToBe) {
  const AxisLog axis = read_axis(CsvLog::parse(text_of(with_camera(2, 12), 1.0), "x.csv"), {});
  ASSERT_EQ(axis.warnings.size(), 2U);
  EXPECT_NE(axis.warnings[1].find("axis0/q2_rad is late against the other channels by"), std::string::npos)
      << axis.warnings[1];
}

TEST(AxisLogGate, TooFewPicturesAreNoLogByThemselves) {
  const AxisLog axis = read_axis(CsvLog::parse(text_of(with_camera(40), 1.0), "x.csv"), {});
  EXPECT_EQ(axis.samples(), kRows);
  EXPECT_NE(axis.warnings[0].find("late by half of that"), std::string::npos) << axis.warnings[0];
}

TEST(AxisLogGate, AMotorsHeldTorqueThinsNothing) {
  Log log;
  for (Index i = 0; i < kRows; ++i) {
    log.tau[i] = log.tau[i - i % 10];
  }
  EXPECT_EQ(read_axis(CsvLog::parse(text_of(log, 1.0), "x.csv"), {}).samples(), kRows);
  AxisRequest effort;
  effort.effort = true;
  EXPECT_EQ(read_axis(CsvLog::parse(text_of(log, 1.0), "x.csv"), effort).samples(), kRows);
}

TEST(FrameRows, AreWhereAValueIsNewAndAtRestWhereOneIsDue) {
  const VectorXd held{{0, 0, 0, 1, 1, 1, 2, 2, 2, 2, 2, 2, 2, 2, 2, 5, 5, 5, 5, 6, 6}};  // at rest from row 6 to 14
  EXPECT_EQ(frame_rows(held, 3.0), (std::vector<Index>{3, 6, 9, 12, 15, 19}));
}

TEST(FrameRows, HaveNoOldValueWhereAPictureWasLost) {
  const VectorXd held{{0, 0, 0, 1, 1, 1, 2, 2, 2, 2, 2, 2, 5, 5, 5, 6, 6}};  // one lost at row 9
  EXPECT_EQ(frame_rows(held, 3.0), (std::vector<Index>{3, 6, 12, 15}));
}

}  // namespace
}  // namespace capstan::tools
