// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/log/axis_log.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "capstan/tools/support/errors.hpp"

namespace capstan::tools {
namespace {

auto text_with(const std::string& header, int rows, const std::string& (*line)(int)) -> std::string {
  std::string text = header + "\n";
  for (int i = 0; i < rows; ++i) {
    text += line(i);
  }
  return text;
}

auto moving_line(int i) -> const std::string& {
  static std::string line;
  line = std::to_string(0.01 * i) + "," + std::to_string(0.1 * (i % 7)) + "," + std::to_string(0.05 * (i % 7)) + "\n";
  return line;
}

TEST(AxisLog, TorqueIsZeroWhereItIsNotLogged) {
  const CsvLog csv = CsvLog::parse(text_with("time_s,axis0/q1_rad,axis0/q2_rad", 50, moving_line), "x.csv");
  const AxisLog axis = read_axis(csv, {});
  EXPECT_FALSE(axis.has_torque);
  EXPECT_EQ(axis.tau_nm.cwiseAbs().maxCoeff(), 0.0);
  EXPECT_NEAR(axis.period_s, 0.01, 1e-9);
  EXPECT_THROW(read_axis(csv, {.axis = 0, .target = {}, .needs_target = true, .needs_torque = true}), BadInput);
}

TEST(AxisLog, ATorqueThatNeverChangesIsNone) {
  const auto read = [](const std::string& torque, bool needed) {
    std::string text = "time_s,axis0/q1_rad,axis0/q2_rad,axis0/tau_Nm\n";
    for (int i = 0; i < 50; ++i) {
      std::string line = moving_line(i);
      line.pop_back();
      text += line + "," + (i == 20 ? torque : "0.25") + "\n";
    }
    AxisRequest request;
    request.needs_torque = needed;
    return read_axis(CsvLog::parse(text, "x.csv"), request);
  };
  const AxisLog dead = read("0.25", false);
  EXPECT_FALSE(dead.has_torque);
  EXPECT_EQ(dead.tau_nm.cwiseAbs().maxCoeff(), 0.0);
  ASSERT_FALSE(dead.warnings.empty());
  EXPECT_NE(dead.warnings.front().find("axis0/tau_Nm never changes"), std::string::npos) << dead.warnings.front();
  EXPECT_TRUE(read("0.26", false).has_torque);
  EXPECT_TRUE(read("0.25", true).has_torque) << "who asks for a law with torque is told what that law lacks";
}

TEST(AxisLog, AnotherAxisAndTargetCanBeAskedFor) {
  const CsvLog csv = CsvLog::parse(text_with("time_s,axis3/q1_rad,camera", 50, moving_line), "x.csv");
  const AxisLog axis = read_axis(csv, {.axis = 3, .target = "camera", .needs_target = true, .needs_torque = false});
  EXPECT_EQ(axis.target, "camera");
  EXPECT_THROW(read_axis(csv, {}), BadInput);
}

TEST(AxisLog, AJointCountedAgainstItsMotorIsToldWithTheCure) {
  const auto warnings = [](double ratio, bool every_row) {
    std::string text = "time_s,axis0/q1_rad,axis0/q2_rad\n";
    for (int i = 0; i < 200; ++i) {
      const double motor = std::sin(0.1 * i);
      text += std::to_string(0.01 * i) + "," + std::to_string(motor) + "," + std::to_string(ratio * motor) + "\n";
    }
    return read_axis(CsvLog::parse(text, "x.csv"), {.every_row = every_row}).warnings;
  };
  EXPECT_TRUE(warnings(0.5, false).empty());
  ASSERT_EQ(warnings(-0.5, false).size(), 1U);
  EXPECT_NE(warnings(-0.5, false)[0].find("axis0/q2_rad falls while the motor's angle rises"), std::string::npos);
  EXPECT_NE(warnings(-0.5, false)[0].find("(--map \"axis0/q2_rad=COLUMN*-1\")"), std::string::npos);
  EXPECT_TRUE(warnings(-0.5, true).empty()) << "who replays a law has one that says so";
}

TEST(AxisLog, AJointThatNeverMovesIsRefusedWithFileLinesAndCure) {
  const CsvLog csv = CsvLog::parse("time_s,axis0/q1_rad,axis0/q2_rad\n0,1,1\n0.1,1,2\n0.2,1,3\n0.3,1,4\n", "x.csv");
  try {
    read_axis(csv, {});
    FAIL();
  } catch (const BadInput& error) {
    const std::string message = error.what();
    EXPECT_NE(message.find("x.csv:2: axis0/q1_rad stands at 1 from here to line 5"), std::string::npos) << message;
    EXPECT_NE(message.find("; record the joint while it moves"), std::string::npos) << message;
  }
}

TEST(AxisLog, ALogOfOneRowIsSaidToBeTooShort) {
  const CsvLog csv = CsvLog::parse("time_s,axis0/q1_rad,axis0/q2_rad\n0,1,1\n", "x.csv");
  try {
    read_axis(csv, {});
    FAIL();
  } catch (const BadInput& error) {
    EXPECT_NE(std::string(error.what()).find("only 1 row; record"), std::string::npos) << error.what();
  }
}

TEST(AxisLog, SmallJitterIsQuietLargeJitterAndGapsAreTold) {
  auto log_with = [](double shake, double gap) {
    std::string text = "time_s,axis0/q1_rad,axis0/q2_rad\n";
    double time = 0.0;
    for (int i = 0; i < 200; ++i) {
      const std::string angle = std::to_string(std::sin(0.1 * i));
      text += std::to_string(time) + "," + angle + "," + angle + "\n";
      time += 0.01 * (1.0 + (i % 2 == 0 ? shake : -shake)) + (i == 100 ? gap : 0.0);
    }
    return read_axis(CsvLog::parse(text, "x.csv"), {}).warnings;
  };
  EXPECT_TRUE(log_with(0.02, 0.0).empty());
  EXPECT_EQ(log_with(0.4, 0.0).size(), 1U);
  const auto gaps = log_with(0.0, 0.5);
  ASSERT_EQ(gaps.size(), 1U);
  EXPECT_NE(gaps[0].find("x.csv:103:"), std::string::npos) << gaps[0];
}

TEST(AxisLog, AJointSensorSlowerThanTheLogIsTold) {
  auto log_held_for = [](int samples) {
    std::string text = "time_s,axis0/q1_rad,axis0/q2_rad\n";
    for (int i = 0; i < 400; ++i) {
      text += std::to_string(0.01 * i) + "," + std::to_string(std::sin(0.07 * i)) + "," +
              std::to_string(std::sin(0.07 * (i / samples * samples))) + "\n";
    }
    return read_axis(CsvLog::parse(text, "x.csv"), {}).warnings;
  };
  EXPECT_TRUE(log_held_for(1).empty());
  const auto warnings = log_held_for(5);
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_NE(warnings[0].find("only every 5 samples"), std::string::npos) << warnings[0];
}

TEST(AxisLog, MotionOfOtherAxesIsKeptAsASideSignal) {
  const CsvLog csv = CsvLog::parse(
      "time_s,axis0/q1_rad,axis0/q2_rad,axis1/q1_rad,axis2/q1_rad\n0,1,1,5,0\n0.1,2,2,6,0\n0.2,3,3,7,0\n", "x.csv");
  const AxisLog axis = read_axis(csv, {});
  ASSERT_EQ(axis.side.size(), 2U) << "where an axis rests counts in a law of two joints";
  EXPECT_EQ(axis.side[0].name, "axis1/q1_rad");
  EXPECT_EQ(axis.side[1].name, "axis2/q1_rad");
  ASSERT_EQ(axis.others.size(), 1U);  // axis 2 rests
  EXPECT_EQ(axis.others[0].number, 1);
}

TEST(AxisLog, AnAxisThatMovesInAnotherLogTakesItsSlotHereToo) {
  const CsvLog csv = CsvLog::parse(
      "time_s,axis0/q1_rad,axis0/q2_rad,axis1/q1_rad,axis2/q1_rad,axis3/q1_rad\n"
      "0,1,1,5,0,1\n0.1,2,2,5,1,2\n0.2,3,3,5,2,3\n",
      "x.csv");
  EXPECT_EQ(moving_axes(csv, 0), (std::vector<int>{2, 3}));
  AxisRequest request;
  request.moving_axes = {1, 2};
  const AxisLog axis = read_axis(csv, request);
  ASSERT_EQ(axis.others.size(), 2U) << "axis 3 moves in this log alone, and takes no part";
  EXPECT_EQ(axis.others[0].number, 1);
  EXPECT_EQ(axis.others[0].q1_rad[2], 5.0);
  EXPECT_EQ(axis.others[1].number, 2);
  request.other_axes = {2};
  EXPECT_EQ(read_axis(csv, request).others[0].number, 2) << "what is asked for stays first";
  EXPECT_EQ(read_axis(csv, request).others.size(), 2U);
  request.moving_axes = {4};
  try {
    read_axis(csv, request);
    FAIL();
  } catch (const BadInput& error) {
    EXPECT_NE(std::string(error.what())
                  .find("x.csv:1: axis 4 moves in another of the logs, and the log has no "
                        "axis4/q1_rad; record that axis with it"),
              std::string::npos)
        << error.what();
  }
}

TEST(AxisLog, MovingAxesAreSeenThroughGapsAndWhereTheyAreSlides) {
  const CsvLog csv = CsvLog::parse(
      "time_s,axis0/q1_rad,axis0/q2_rad,axis1/q1_m,axis2/q1_rad\n"
      "0,1,1,0.1,7\n0.1,2,2,,\n0.2,3,3,0.3,7\n0.3,4,4,,\n0.4,5,5,0.5,7\n",
      "x.csv");
  EXPECT_EQ(moving_axes(csv, 0), (std::vector<int>{1}));
  const AxisLog axis = read_axis(csv, {});
  ASSERT_EQ(axis.side.size(), 2U);
  EXPECT_EQ(axis.side[0].name, "axis1/q1_m");
  EXPECT_DOUBLE_EQ(axis.side[0].values[1], 0.2) << "on a straight line over a cell without a value";
}

TEST(AxisLog, TheAxisThatPullsIsTheFirstThatMovesOrTheOneAskedFor) {
  std::string text = "time_s,axis0/q1_rad,axis0/q2_rad,axis1/q1_rad,axis2/q1_rad,axis4/q1_rad\n";
  for (int i = 0; i < 50; ++i) {
    const std::string angle = std::to_string(0.1 * (i % 7));
    text += std::to_string(0.01 * i) + "," + angle + "," + angle + ",0.3," + std::to_string(i % 5) + "," +
            std::to_string(i % 3) + "\n";
  }
  const CsvLog csv = CsvLog::parse(text, "x.csv");
  EXPECT_EQ(read_axis(csv, {}).others.front().number, 2);
  AxisRequest request;
  request.other_axes = {4};
  EXPECT_EQ(read_axis(csv, request).others.front().number, 4);
  request.other_axes = {4, 2};
  EXPECT_EQ(read_axis(csv, request).others.at(1).number, 2) << "slots are in the order asked for";
  request.other_axes = {7};
  try {
    read_axis(csv, request);
    FAIL() << "accepted";
  } catch (const BadInput& error) {
    EXPECT_NE(std::string(error.what()).find("coupled to axis 7, and the log has no axis7/q1_rad; record that axis"),
              std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace capstan::tools
