// SPDX-License-Identifier: Apache-2.0
#include "capstan/tests/tools/machines/drawn_machines.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>

#include "capstan/tests/tools/machines/machine_joint.hpp"
#include "capstan/tests/tools/machines/plain_fits.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/statistics.hpp"

namespace capstan::tools::machines {
namespace {

TEST(DrawnMachines, AreLogsByTheContractAndTheSameForASeed) {
  const auto machines = drawn_machines(5);
  const auto again = drawn_machines(5);
  ASSERT_EQ(machines.size(), 29U);
  for (std::size_t i = 0; i < machines.size(); ++i) {
    const DrawnMachine& machine = machines[i];
    EXPECT_EQ(machine.columns[0], "time_s");
    EXPECT_EQ(machine.columns[1], "axis0/q1_rad");
    ASSERT_EQ(static_cast<std::size_t>(machine.rows.cols()), machine.columns.size());
    EXPECT_GT(machine.rows.rows(), 590) << machine.name;
    EXPECT_TRUE(machine.rows.allFinite()) << machine.name;
    EXPECT_EQ(machine.rows, again[i].rows);
  }
  EXPECT_NE(machines.front().rows(1, 1), drawn_machines(6).front().rows(1, 1));
}

/// Machines of a seed, by the names they have, as they are read.
auto drawn(std::uint64_t seed, const std::vector<std::string>& names) -> std::vector<Joint> {
  const std::string folder = testing::TempDir() + "capstan_drawn_" + std::to_string(seed);
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  write_machines(folder, drawn_machines(seed));
  std::vector<Joint> joints = joints_in(folder);
  EXPECT_EQ(joints.size(), 29U);  // another motor beside a joint is none of its own
  std::erase_if(joints,
                [&](const Joint& joint) { return std::find(names.begin(), names.end(), joint.name) == names.end(); });
  EXPECT_EQ(joints.size(), names.size());
  std::filesystem::remove_all(folder);
  return joints;
}

TEST(Machines, AFolderWithoutALogToScoreIsRefused) {
  const std::string folder = testing::TempDir() + "capstan_no_machines";
  std::filesystem::create_directories(folder);
  std::ofstream(folder + "/times.csv") << "time_s\n0\n0.01\n0.02\n";
  std::ofstream(folder + "/README.md") << "no log\n";
  try {
    joints_in(folder);
    ADD_FAILURE() << "a scoreboard of nothing";
  } catch (const BadInput& refusal) {
    EXPECT_NE(std::string(refusal.what()).find("holds no log to score"), std::string::npos) << refusal.what();
  }
  std::filesystem::remove_all(folder);
}

/// Error of the delivered law over that of the plain fit, on the last 40 % of the rows.
auto ratio_of(const Joint& joint) -> double {
  const Eigen::Index end = joint.log.samples();
  const Eigen::Index rows = 6 * end / 10;
  const PlainResult plain = plain_result(joint, rows, end);
  return error_of(diagnosis_of(joint, rows), joint, rows, end, plain.plainest) / plain.simple;
}

// Each left more than the plain fit while a name kept its law without being asked, while a motor counted as standing
// below a fixed speed, and while its friction took a fixed time to let go.
TEST(DrawnMachines, DeliveredLawsErrLessThanPlainFits) {
  for (const Joint& joint : drawn(12, {"power_reaches_12", "squared_chirp_12"})) {
    EXPECT_LT(ratio_of(joint), 1.0) << joint.name;
  }
  for (const Joint& joint : drawn(16, {"coupled_decay_16"})) {
    EXPECT_LT(ratio_of(joint), 0.6) << joint.name;
  }
}

// A pendulum whose law was grown from inertia and friction alone, which let go of the inertia before its weight came:
// 4.4 and 6.1 times what the plain fit leaves.
TEST(DrawnMachines, AWeightIsFoundBesideTheInertiaThatHidesIt) {
  for (const Joint& joint : drawn(54, {"servo_growing_54", "servo_updown_54"})) {
    EXPECT_LT(ratio_of(joint), 1.1) << joint.name;
  }
}

/// Sines at 200 Hz; what an axis asks for, or what a gear makes of the motor's torque.
auto moving_log() -> AxisLog {
  constexpr Eigen::Index kRows = 4000;
  AxisLog log;
  log.period_s = 0.005;
  log.time_s = Eigen::VectorXd::LinSpaced(kRows, 0.0, log.period_s * (kRows - 1));
  log.q1_rad = (1.3 * log.time_s.array()).sin() + 0.4 * (3.1 * log.time_s.array()).sin();
  return log;
}
auto speed(const AxisLog& log) -> Eigen::ArrayXd {
  return 1.3 * (1.3 * log.time_s.array()).cos() + 1.24 * (3.1 * log.time_s.array()).cos();
}
auto noise(Eigen::Index rows, double spread) -> Eigen::ArrayXd {
  std::mt19937 engine(3);
  std::normal_distribution<double> normal(0.0, spread);
  return Eigen::ArrayXd::NullaryExpr(rows, [&](Eigen::Index) { return normal(engine); });
}
auto left_by(const std::string& name, const std::vector<PlainFit>& fits, const Eigen::VectorXd& target) -> double {
  const auto fit = std::find_if(fits.begin(), fits.end(), [&](const PlainFit& one) { return one.name == name; });
  EXPECT_NE(fit, fits.end()) << name;
  return rms((target - fit->estimate(target.size() / 2)).tail(target.size() / 2));
}

TEST(PlainFits, OfAnEffortFindWhatItIsMadeOf) {
  AxisLog log = moving_log();
  const Eigen::ArrayXd rigid = 0.3 * speed(log) + 0.2;
  log.effort = rigid + 2.0 * log.q1_rad.array().sin() + noise(log.samples(), 0.01);
  const auto fits = plain_effort_fits(log);
  EXPECT_LT(left_by("+gravity", fits, log.effort), 0.012);
  EXPECT_GT(left_by("+asymmetry", fits, log.effort), 0.5);
  log.effort = rigid + 2.0 * log.q1_rad.array() + noise(log.samples(), 0.01);
  EXPECT_LT(left_by("+spring", plain_effort_fits(log), log.effort), 0.012);
}

TEST(PlainFits, OfAGearFindALateTorqueAndFrictionWithTheLoad) {
  AxisLog log = moving_log();
  log.has_torque = true;
  log.tau_nm = 0.5 * (7.0 * log.time_s.array()).sin();
  const auto rows = log.samples();
  Eigen::ArrayXd late = log.tau_nm;
  late.tail(rows - 2) = log.tau_nm.head(rows - 2);
  log.effort = 9.0 * late + noise(rows, 0.01);
  EXPECT_LT(left_by("gain+skew", plain_gear_fits(log), log.effort), 0.012);
  EXPECT_GT(left_by("gain", plain_gear_fits(log), log.effort), 0.05);
  log.effort = 9.0 * late - 0.8 * speed(log).sign() * late.abs() + noise(rows, 0.01);
  EXPECT_LT(left_by("+load friction", plain_gear_fits(log), log.effort),
            0.3 * left_by("+Coulomb", plain_gear_fits(log), log.effort));
}

}  // namespace
}  // namespace capstan::tools::machines
