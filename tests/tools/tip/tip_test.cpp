// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/tip/tip.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "capstan/tools/support/errors.hpp"

namespace capstan::tools {
namespace {

constexpr double kQuarter = 0.5 * std::numbers::pi;

auto wrist() -> WristInLog {
  WristInLog in_log;
  in_log.links.pitch_to_jaw_m = 0.009;
  in_log.links.jaw_m = 0.01;
  in_log.links.offset_m = 0.002;
  return in_log;
}

/// Rows of pitch, right and left: estimated, then measured.
auto log_of(const std::vector<std::array<double, 6>>& rows) -> CsvLog {
  std::string text =
      "time_s,axis0/q2_est_rad,axis1/q2_est_rad,axis2/q2_est_rad,axis0/q2_rad,axis1/q2_rad,axis2/q2_rad\n";
  for (std::size_t i = 0; i < rows.size(); ++i) {
    text += std::to_string(0.01 * static_cast<double>(i));
    for (const double angle : rows[i]) {
      char cell[32];
      std::snprintf(cell, sizeof(cell), ",%.9f", angle);
      text += cell;
    }
    text += "\n";
  }
  return CsvLog::parse(text, "wrist.csv");
}

TEST(Tip, StandsWhereTheLinksOfTheWristPutIt) {
  // Straight on; pitched by a quarter turn; the right jaw bent by one, the left the other way.
  const TipTrack track = tips_of(
      log_of({{0, 0, 0, 0, 0, 0}, {kQuarter, 0, 0, kQuarter, 0, 0}, {0, kQuarter, -kQuarter, 0, kQuarter, -kQuarter}}),
      wrist());
  const auto at = [&](const std::string& name, Eigen::Index row) {
    const auto found = std::find(track.names.begin(), track.names.end(), name);
    EXPECT_NE(found, track.names.end()) << name;
    return track.columns[static_cast<std::size_t>(found - track.names.begin())][row];
  };
  EXPECT_NEAR(at("tip_right/x_m", 0), 0.019, 1e-9);
  EXPECT_NEAR(at("tip_right/y_m", 0), 0.002, 1e-9);
  EXPECT_NEAR(at("tip_right/x_m", 1), -0.002, 1e-9);
  EXPECT_NEAR(at("tip_right/y_m", 1), 0.019, 1e-9);
  EXPECT_NEAR(at("tip_right/x_m", 2), 0.009, 1e-9);
  EXPECT_NEAR(at("tip_right/z_m", 2), -0.01, 1e-9);
  EXPECT_NEAR(at("tip_left/z_m", 2), 0.01, 1e-9);
  EXPECT_NEAR(at("tip_left/measured_z_m", 2), 0.01, 1e-9);
}

TEST(Tip, IsOffByTheChordOfWhatItsJawIsOff) {
  const TipTrack track = tips_of(log_of({{0.3, 0.5, 0.1, 0.3, 0.6, 0.1}, {0.3, 0.5, 0.1, 0.3, 0.5, 0.1}}), wrist());
  ASSERT_TRUE(track.errors[0] && track.errors[1]);
  EXPECT_NEAR(track.errors[0]->largest_m, 2.0 * 0.01 * std::sin(0.05), 1e-9);
  EXPECT_NEAR(track.errors[0]->rms_m, 2.0 * 0.01 * std::sin(0.05) / std::sqrt(2.0), 1e-9);
  EXPECT_NEAR(track.errors[1]->largest_m, 0.0, 1e-12);
}

TEST(Tip, TakesMeasuredAnglesAloneAndNamesTheColumnThatIsMissing) {
  const CsvLog measured =
      CsvLog::parse("time_s,axis0/q2_rad,axis1/q2_rad,axis2/q2_rad\n0,0,0,0\n1,0.1,0.1,0.1\n", "m.csv");
  const TipTrack track = tips_of(measured, wrist());
  EXPECT_EQ(track.names.size(), 6U);
  EXPECT_FALSE(track.errors[0].has_value());
  try {
    (void)tips_of(CsvLog::parse("time_s,axis0/q2_est_rad,axis1/q2_est_rad\n0,0,0\n1,0,0\n", "m.csv"), wrist());
    FAIL();
  } catch (const BadInput& error) {
    EXPECT_NE(std::string(error.what()).find("axis2/q2_est_rad"), std::string::npos) << error.what();
  }
}

/// A row of a quaternion: pitch about z, then the jaw about the axis that was y, as two turns multiplied by hand. The
/// jaw's frame at rest has its finger along x and the jaws' axis along y.
auto quaternion(double pitch, double jaw) -> std::array<double, 4> {
  const auto times = [](const std::array<double, 4>& a, const std::array<double, 4>& b) -> std::array<double, 4> {
    return {
        a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3], a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
        a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1], a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0]};
  };
  const std::array<double, 4> about_z = {std::cos(0.5 * pitch), 0.0, 0.0, std::sin(0.5 * pitch)};
  const std::array<double, 4> about_y = {std::cos(0.5 * jaw), 0.0, std::sin(0.5 * jaw), 0.0};
  const std::array<double, 4> at_rest = {std::sqrt(0.5), -std::sqrt(0.5), 0.0, 0.0};  // y to -z, z to y
  return times(times(about_z, about_y), at_rest);
}

auto poses(const std::vector<std::array<double, 3>>& joints, const std::string& more_header = "",
           const std::string& more = "") -> CsvLog {
  std::string text =
      "time_s,tip_right/qw,tip_right/qx,tip_right/qy,tip_right/qz,tip_left/qw,tip_left/qx,tip_left/qy,"
      "tip_left/qz" +
      more_header + "\n";
  double time_s = 0.0;
  for (const auto& [pitch, right, left] : joints) {
    text += std::to_string(time_s += 0.01);
    for (const double jaw : {right, left}) {
      for (const double part : quaternion(pitch, jaw)) {
        char cell[32];
        std::snprintf(cell, sizeof(cell), ",%.12f", 1.7 * part);
        text += cell;
      }
    }
    text += more + "\n";
  }
  return CsvLog::parse(text, "poses.csv");
}

TEST(Tip, TurnsPosesOfTheJawsIntoJointAngles) {
  const std::vector<std::array<double, 3>> joints = {{0.3, 0.5, -0.4}, {-1.0, 0.2, 1.1}, {0.0, 0.0, 0.0}};
  const TipTrack track = tips_of(poses(joints), wrist());
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto found = std::find(track.names.begin(), track.names.end(), "axis" + std::to_string(axis) + "/q2_rad");
    ASSERT_NE(found, track.names.end());
    const Eigen::VectorXd& angle = track.columns[static_cast<std::size_t>(found - track.names.begin())];
    for (std::size_t row = 0; row < joints.size(); ++row) {
      EXPECT_NEAR(angle[static_cast<Eigen::Index>(row)], joints[row][axis], 1e-9) << axis << ", " << row;
    }
  }
}

TEST(Tip, RefusesPosesThatAreNoneOrStandBesideMeasuredAngles) {
  const auto refusal = [](const CsvLog& log) -> std::string {
    try {
      (void)tips_of(log, wrist());
      return "taken";
    } catch (const BadInput& error) {
      return error.what();
    }
  };
  EXPECT_NE(refusal(poses({{0.1, 0.2, 0.3}}, ",axis0/q2_rad", ",0.1")).find("leave one of them out"),
            std::string::npos);
  const CsvLog zeros =
      CsvLog::parse("time_s,tip_right/qw,tip_right/qx,tip_right/qy,tip_right/qz\n0,1,0,0,0\n1,0,0,0,0\n", "poses.csv");
  EXPECT_NE(refusal(zeros).find("poses.csv:3: tip_right/qw to qz are all zero"), std::string::npos) << refusal(zeros);
}

}  // namespace
}  // namespace capstan::tools
