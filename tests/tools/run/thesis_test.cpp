// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/thesis/thesis.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "capstan/tools/thesis/laws.hpp"
#include "capstan/tools/thesis/rig.hpp"

namespace capstan::tools {
namespace {

auto value(const ThesisTable& table, std::size_t row, const std::string& group, const std::string& key) -> double {
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    if (table.columns[i].group == group && table.columns[i].key == key) {
      return table.rows.at(row).values.at(i);
    }
  }
  ADD_FAILURE() << group << " " << key;
  return std::nan("");
}

TEST(Thesis, SlackInstantsGiveTheConstantThatThePlantHasAndThePrintedSize) {
  const ThesisTable table = table_2_1_and_2_2();
  ASSERT_EQ(table.rows.size(), 5U);
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_NEAR(value(table, i, "simulated", "I"), 27.6984, 0.02 * 27.6984);
    // The plateau's eta holds the motor's friction (3 mN m of 0.15), and 2 % by the choice of the instant.
    EXPECT_NEAR(value(table, i, "simulated", "eta"), 1.141, 0.05 * 1.141);
    EXPECT_NEAR(value(table, i, "simulated", "tau_in"), value(table, i, "printed", "tau_in"), 0.015);
  }
}

TEST(Thesis, MultisineOfTable52IsAsPrinted) {
  const ThesisTable table = table_5_2();
  ASSERT_EQ(table.rows.size(), 4U);
  EXPECT_NEAR(value(table, 3, "simulated", "km"), 2.2743, 0.1 * 2.2743);
  EXPECT_NEAR(value(table, 3, "simulated", "less"), 62.2, 5.0);
  for (std::size_t i = 0; i < 4; ++i) {
    // At least the printed reduction of the fastest sine, from a law whose every number is identified on other motions.
    EXPECT_GT(value(table, i, "simulated", "less"), 50.0);
    EXPECT_LT(value(table, i, "simulated", "law"), value(table, i, "simulated", "pm"));
  }
  EXPECT_GT(value(table, 2, "late camera", "km"), value(table, 0, "late camera", "km"));
}

TEST(Thesis, FirmwareTracksFortyPercentAndMoreBelowThePrintedControlOnEverySignalOfTable53) {
  const ThesisTable table = table_5_3();
  ASSERT_EQ(table.rows.size(), 6U);
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    const double ours = value(table, i, "capstan", "control");
    std::printf("%-24s control printed %.3f, firmware %.3f deg\n", table.rows[i].name.c_str(),
                value(table, i, "printed", "control"), ours);
    EXPECT_LT(ours, 0.6 * value(table, i, "printed", "control")) << table.rows[i].name;
    EXPECT_LT(ours, 0.6 * value(table, i, "printed", "pm")) << "not even the estimate of PM was better";
  }
}

TEST(Thesis, TextAndJsonHoldTheSameTable) {
  const ThesisTable table{
      "9.9", "a title", {"a condition"}, {{"printed", "km", "KM", "deg", 2}}, {{"x", {1.5}, "why so."}}};
  const std::string text = table_text(table);
  for (const char* part : {"Table 9.9  a title", "printed", "KM", "1.50", "a condition", "x: why so."}) {
    EXPECT_NE(text.find(part), std::string::npos) << part;
  }
  const nlohmann::json json = table_json(table);
  EXPECT_EQ(json["rows"][0]["printed"]["km"], 1.5);
  EXPECT_EQ(json["units"]["km"], "deg");
  EXPECT_EQ(json["rows"][0]["why"], "why so.");
}

TEST(ThesisSignals, MultisineHasTheRootMeanSquareThatIsAskedForAndItsTones) {
  const sim::Motion motion = multisine(5.0, {0.1, 0.2}, 20.0);
  // Projection on each tone over whole periods, from 10 s on, where the start has faded out: equal shares of the power.
  double power = 0.0;
  for (const double f : {0.1, 0.2, 0.3}) {
    double c = 0.0;
    double s = 0.0;
    for (int i = 0; i < 10000; ++i) {
      const double t = 10.0 + 0.001 * i;
      c += 2e-4 * motion.reference_rad(t) * std::cos(2.0 * M_PI * f * t);
      s += 2e-4 * motion.reference_rad(t) * std::sin(2.0 * M_PI * f * t);
    }
    const double amplitude = std::hypot(c, s) * 180.0 / M_PI;
    EXPECT_NEAR(amplitude, f < 0.25 ? 5.0 : 0.0, 0.1) << f;
    power += 0.5 * amplitude * amplitude;
  }
  EXPECT_NEAR(std::sqrt(power), 5.0, 0.1);
}

TEST(ThesisRig, RecordsWhatSensorsShowWhileTheServoFollowsAndTheOtherMotorsHold) {
  const auto wrist = sim::parse_instrument(sim::built_in_instrument("da_vinci_wrist"), "wrist").axes;
  const Experiment run = run_experiment(wrist, 1, sine(10.0, 0.5, 4.0), stiff_gains(), 1);
  EXPECT_EQ(run.log.samples(), 450);
  EXPECT_NEAR(run.log.time_s[449], 4.49, 1e-12);
  // 20 A/rad at 0.1 N m/A against 0.09 N m of friction: at most 0.045 rad, 2.6 deg.
  EXPECT_LT(rms_deg(run.log.q1_rad - run.wanted_rad), 2.6);
  // Sliding tendons alone take I eta r1 / 1 = 0.082 N m; motor and joint add a little.
  EXPECT_NEAR(run.log.tau_nm.maxCoeff(), 0.09, 0.03);
  EXPECT_GT(rms_deg(run.log.q2_rad), 4.0);
}

}  // namespace
}  // namespace capstan::tools
