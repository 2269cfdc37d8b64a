// SPDX-License-Identifier: Apache-2.0
// The tied law of a wrist, (6.14) to (6.16), from formulas and from the simulated wrist.
#include "capstan/tools/identify/wrist_fit.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <sstream>

#include "capstan/boards/common/file_banks.hpp"
#include "capstan/tools/identify/law_fit.hpp"
#include "capstan/tools/run/run.hpp"
#include "capstan/tools/support/random.hpp"
#include "capstan/tools/support/statistics.hpp"

namespace capstan::tools {
namespace {

using Logs = std::array<std::vector<AxisLog>, kWristAxes>;

auto logs_of(const CsvLog& csv) -> Logs {
  Logs logs;
  for (std::size_t i = 0; i < kWristAxes; ++i) {
    AxisRequest request;
    request.axis = static_cast<int>(i);
    request.needs_torque = true;
    request.other_axes = i == 0 ? std::vector<int>{} : std::vector<int>{0};
    logs[i] = {read_axis(csv, request)};
  }
  return logs;
}

auto number(const WristFit& fit, std::size_t joint, const char* term, std::size_t which = 0) -> double {
  return fit.joints[joint].parameters.coefficients[catalogue_term(term).first_coefficient + which];
}

/// Table 6.1's numbers in the formulas themselves, motions without a common tone, noise of 0.1 mrad.
auto wrist_by_formula(std::uint64_t seed) -> CsvLog {
  constexpr std::array<double, 3> kBeta = {0.996, 1.109, 1.138};
  constexpr std::array<double, 3> kTop = {-0.424, -1.907, -1.047};
  constexpr std::array<double, 3> kBottom = {-2.828, -1.054, -0.541};
  constexpr std::array<double, 3> kFollow = {0.0, 0.674, 0.664};
  constexpr std::array<double, 3> kTone = {0.31, 0.47, 0.59};
  Random random(seed);
  std::ostringstream text;
  text << "time_s,axis0/q1_rad,axis0/tau_Nm,axis0/q2_rad,axis1/q1_rad,axis1/tau_Nm,axis1/q2_rad,axis2/q1_rad,"
          "axis2/tau_Nm,axis2/q2_rad\n";
  text.precision(10);
  for (int row = 0; row < 12000; ++row) {
    const double t = 0.005 * row;
    text << t;
    double of_pitch = 0.0;
    for (std::size_t i = 0; i < kWristAxes; ++i) {
      const double phase = 2.0 * std::numbers::pi * kTone[i] * t;
      const double q1 = 0.5 * std::sin(phase);
      const bool forward = std::cos(phase) > 0.0;
      const double tau = (forward ? 0.02 : -0.02) + 0.01 * std::sin(1.7 * phase);
      const double own = kBeta[i] * q1 + (forward ? kTop[i] : kBottom[i]) * tau;
      of_pitch = i == 0 ? own : of_pitch;
      text << "," << q1 << "," << tau << "," << own + kFollow[i] * of_pitch + 0.05 + 1e-4 * random.normal();
    }
    text << "\n";
  }
  return CsvLog::parse(text.str(), "formula");
}

TEST(WristFit, GivesTheNumbersOfTheFormulasBack) {
  const WristFit fit = fit_wrist(logs_of(wrist_by_formula(81)));
  EXPECT_TRUE(fit.undetermined.empty());
  EXPECT_NEAR(fit.follow[1], 0.674, 0.002);
  EXPECT_NEAR(fit.follow[2], 0.664, 0.002);
  for (std::size_t i = 1; i < kWristAxes; ++i) {
    EXPECT_GT(fit.follow_half[i], 0.0);
    EXPECT_LT(fit.follow_half[i], 0.01);
    // The rows that a board gets are tied: (6.14), (6.16).
    EXPECT_NEAR(number(fit, i, "axis_coupling"), fit.follow[i] * number(fit, 0, "motor_angle"), 1e-12);
    EXPECT_NEAR(number(fit, i, "axis_coupling", 1), fit.follow[i] * number(fit, 0, "tendon_elongation"), 1e-12);
    EXPECT_NEAR(number(fit, i, "axis_coupling", 2), fit.follow[i] * number(fit, 0, "tendon_elongation", 1), 1e-12);
    EXPECT_EQ(fit.joints[i].coupled_to, std::vector<int>{0});
  }
  // The causal switch is late after a turn, and takes some rows for the other tendon's.
  EXPECT_NEAR(number(fit, 0, "tendon_elongation", 1), -2.828, 0.03 * 2.828);
  EXPECT_NEAR(number(fit, 1, "tendon_elongation"), -1.907, 0.03 * 1.907);
  EXPECT_NEAR(number(fit, 2, "motor_angle"), 1.138, 0.002);
}

auto wrist_on_plant(std::uint64_t seed, double faster) -> CsvLog {
  std::string text = "seed = " + std::to_string(seed) + "\ninstrument = \"da_vinci_wrist\"\n";
  const auto motion = [&](const std::string& section, double hz) {
    return "[[" + section + ".segments]]\nkind = \"multisine\"\nduration_s = 20.0\namplitude_rad = 0.4\n" +
           "frequencies_hz = [" + std::to_string(faster * hz) + ", " + std::to_string(faster * (hz + 0.15)) + "]\n";
  };
  text += "[motion]\n" + motion("motion", 0.05);
  text += "[[axes]]\naxis = \"right_jaw\"\n[axes.motion]\n" + motion("axes.motion", 0.1);
  text += "[[axes]]\naxis = \"left_jaw\"\n[axes.motion]\n" + motion("axes.motion", 0.15);
  std::ostringstream log;
  FileBanks banks = FileBanks::temporary();
  const RunSummary run = run_scenario(sim::parse_scenario(text, "wrist.toml"), {}, banks, &log);
  EXPECT_EQ(run.fault, "");
  return CsvLog::parse(log.str(), "wrist");
}

TEST(WristFit, FollowsThePlantByTheRatiosOfItsRadiiAndForetellsAnotherRun) {
  const WristFit fit = fit_wrist(logs_of(wrist_on_plant(82, 1.0)));
  EXPECT_NEAR(std::abs(fit.follow[1]), 0.674, 0.03);
  EXPECT_NEAR(std::abs(fit.follow[2]), 0.664, 0.03);
  const Logs other = logs_of(wrist_on_plant(83, 1.3));
  for (std::size_t i = 0; i < kWristAxes; ++i) {
    const Eigen::VectorXd estimate = simulate(other[i], motion_parameters(fit.joints[i]));
    const double error = rms_about_mean(other[i].front().q2_rad - estimate);
    std::printf("axis %zu: own run tied %.2f, untied %.2f; another run %.2f mrad\n", i, 1e3 * fit.joints[i].fit->rmse,
                1e3 * fit.untied_rmse_rad[i], 1e3 * error);
    EXPECT_LT(fit.joints[i].fit->rmse, 1.1 * fit.untied_rmse_rad[i]);
    EXPECT_LT(error, 1.5 * fit.joints[i].fit->rmse);
  }
}

}  // namespace
}  // namespace capstan::tools
