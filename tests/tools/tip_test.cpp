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
  in_log.geometry.pitch_to_jaw_m = 0.009;
  in_log.geometry.jaw_m = 0.01;
  in_log.geometry.offset_m = 0.002;
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

}  // namespace
}  // namespace capstan::tools
