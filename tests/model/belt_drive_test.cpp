// SPDX-License-Identifier: Apache-2.0
#include "capstan/model/belt_drive.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <numbers>
#include <vector>

namespace capstan {
namespace {

constexpr double kQuarter = 0.5 * std::numbers::pi;

/// (5.5) without load, bisected for T2 < T1 = 1.
auto balance_on_bearing(const Idler& idler) -> double {
  const auto surplus = [&](double t2) {
    const double joint = std::sqrt(1.0 + t2 * t2 - 2.0 * t2 * std::cos(idler.wrap_rad));
    return (1.0 - t2) - idler.joint_friction * idler.radius_ratio * joint;
  };
  double low = 0.0;
  double high = 1.0;
  for (int i = 0; i < 200; ++i) {
    const double middle = 0.5 * (low + high);
    (surplus(middle) > 0.0 ? low : high) = middle;
  }
  return low;
}

TEST(IdlerRatio, BalancesTheBearingUnlessTheTendonSlidesOverTheRim) {
  for (const double wrap : {0.05, 0.7, kQuarter, 3.0}) {
    for (const double friction : {1e-4, 0.05, 0.3, 0.9}) {
      const Idler rolls = {wrap, 0.5, friction, 10.0};
      EXPECT_NEAR(idler_ratio(rolls), balance_on_bearing(rolls), 1e-9) << wrap << ", " << friction;
      EXPECT_NEAR(std::exp(-10.0 * slip_arc(rolls)), idler_ratio(rolls), 1e-12) << "(5.1)";
      const Idler slides = {wrap, 0.5, friction, 1e-3};
      EXPECT_NEAR(idler_ratio(slides), std::fmax(std::exp(-1e-3 * wrap), balance_on_bearing(slides)), 1e-9);
      EXPECT_LE(slip_arc(slides), wrap * (1.0 + 1e-12));
    }
  }
  EXPECT_EQ(idler_ratio({kQuarter, 1.0, 1.5, 0.2}), std::exp(-0.2 * kQuarter)) << "a seized bearing";
  EXPECT_EQ(idler_ratio({kQuarter, 0.5, 0.0, 0.2}), 1.0);
}

/// A run of n equal idlers, spread evenly or crowded at the input.
struct EvenRun {
  EvenRun(std::size_t n, const Idler& idler, double length, bool crowded = false) : idlers(n, idler), spans(n + 1) {
    const double count = static_cast<double>(n);
    for (std::size_t i = 0; i <= n; ++i) {
      const bool end = i == 0 || i == n;
      spans[i] = crowded ? (i == n ? 0.9 * length : 0.1 * length / count) : (end ? 0.5 : 1.0) * length / count;
    }
  }
  [[nodiscard]] auto view() const -> BeltRun { return {idlers, spans}; }
  std::vector<Idler> idlers;
  std::vector<double> spans;
};

auto drive(const EvenRun& top, const EvenRun& bottom) -> BeltDrive {
  return {0.0026, 0.0024, 2.5e4, 14.0, top.view(), bottom.view()};
}

/// All span tensions from (5.5) per idler, (2.11) and (5.6) as one dense system, by elimination with pivots.
auto dense_torque_out(const BeltDrive& drive, double torque_in, double s) -> double {
  const std::size_t top = drive.top.spans_m.size();
  const std::size_t all = top + drive.bottom.spans_m.size();
  std::vector<std::vector<double>> rows;
  double total = 0.0;
  std::vector<double> lengths(all + 1, 0.0);
  const auto add_run = [&](const BeltRun& run, std::size_t first, double direction) {
    for (std::size_t i = 0; i < run.spans_m.size(); ++i) {
      lengths[first + i] = run.spans_m[i];
      total += run.spans_m[i] * drive.preset_n;
      if (i > 0) {
        std::vector<double> row(all + 1, 0.0);
        const double rho = balance_on_bearing(run.idlers[i - 1]);
        row[first + i] = direction > 0.0 ? 1.0 : rho;
        row[first + i - 1] = direction > 0.0 ? -rho : -1.0;
        rows.push_back(row);
      }
    }
  };
  add_run(drive.top, 0, s);
  add_run(drive.bottom, top, -s);
  lengths[all] = total;
  rows.push_back(lengths);
  std::vector<double> input(all + 1, 0.0);
  input[0] = 1.0;
  input[top] = -1.0;
  input[all] = torque_in / drive.r1;
  rows.push_back(input);
  for (std::size_t k = 0; k < all; ++k) {
    std::size_t pivot = k;
    for (std::size_t i = k; i < all; ++i) {
      pivot = std::fabs(rows[i][k]) > std::fabs(rows[pivot][k]) ? i : pivot;
    }
    std::swap(rows[k], rows[pivot]);
    for (std::size_t i = 0; i < all; ++i) {
      const double share = i == k ? 0.0 : rows[i][k] / rows[k][k];
      for (std::size_t j = k; share != 0.0 && j <= all; ++j) {
        rows[i][j] -= share * rows[k][j];
      }
    }
  }
  const auto tension = [&](std::size_t i) { return rows[i][all] / rows[i][i]; };
  return (tension(top - 1) - tension(all - 1)) * drive.r2;
}

TEST(BeltDrive, IsAllItsEquationsSolvedAtOnce) {
  const EvenRun top(5, {0.8, 0.5, 0.25, 5.0}, 0.4);
  const EvenRun bottom(3, {1.3, 0.6, 0.15, 5.0}, 0.37, true);
  const BeltDrive belt = drive(top, bottom);
  for (const double s : {1.0, -1.0}) {
    for (const double torque : {-0.02, 0.0, 0.01, 0.03}) {
      const auto state = solve_exactly(belt, torque, s);
      ASSERT_FALSE(state.one_slack);
      EXPECT_NEAR(state.torque_out_nm, dense_torque_out(belt, torque, s), 1e-9 * 0.03) << s << ", " << torque;
      EXPECT_NEAR((state.top_in_n - state.bottom_in_n) * belt.r1, torque, 1e-12);
    }
  }
}

TEST(BeltDrive, SlackRunCarriesNothingAndTheJointHangsOnTheOther) {
  const EvenRun top(4, {0.8, 0.5, 0.2, 5.0}, 0.4);
  const BeltDrive belt = drive(top, top);
  const auto state = solve_exactly(belt, 0.2, 1.0);
  EXPECT_TRUE(state.one_slack);
  EXPECT_EQ(state.bottom_in_n, 0.0);
  const double rho = balance_on_bearing(top.idlers[0]);
  EXPECT_NEAR(state.torque_out_nm, 0.2 * std::pow(rho, 4.0) * belt.r2 / belt.r1, 1e-9);
  const auto mirrored = solve_exactly(belt, -0.2, -1.0);
  EXPECT_NEAR(mirrored.joint_shift_rad, -state.joint_shift_rad, 1e-15);
}

struct Shortcut {
  double eta, torque, angle;
};
/// Largest errors of the one-surface shortcut over torques up to slackness, as shares of the largest value.
auto shortcut_error(const EvenRun& run) -> Shortcut {
  const BeltDrive belt = drive(run, run);
  Shortcut error = {equivalent_eta(run.view()), 0.0, 0.0};
  double torque_scale = 0.0;
  double angle_scale = 0.0;
  for (double torque = -0.06; torque <= 0.06; torque += 0.002) {
    const auto exact = solve_exactly(belt, torque, 1.0);
    const auto surface = solve_as_surfaces(belt, torque, 1.0);
    error.torque = std::fmax(error.torque, std::fabs(surface.torque_out_nm - exact.torque_out_nm));
    error.angle = std::fmax(error.angle, std::fabs(surface.joint_shift_rad - exact.joint_shift_rad));
    torque_scale = std::fmax(torque_scale, std::fabs(exact.torque_out_nm));
    angle_scale = std::fmax(angle_scale, std::fabs(exact.joint_shift_rad));
  }
  return {error.eta, error.torque / torque_scale, error.angle / angle_scale};
}

TEST(BeltDrive, OneSurfaceIsRightForManyEvenPulleysAndItsErrorFallsWithTheSquareOfTheirNumber) {
  std::printf("idlers of a quarter turn, bore half the pulley; error of one surface, %% of largest torque / angle\n");
  std::printf("| mu_J | eta of 8 | n = 1 | 2 | 4 | 8 | 16 | 8, crowded at the input |\n");
  for (const double friction : {0.05, 0.1, 0.2, 0.4}) {
    const Idler idler = {kQuarter, 0.5, friction, 2.0};
    std::printf("| %.2f | %.2f |", friction, equivalent_eta(EvenRun(8, idler, 0.4).view()));
    for (const std::size_t n : {1U, 2U, 4U, 8U, 16U}) {
      const Shortcut error = shortcut_error(EvenRun(n, idler, 0.4));
      std::printf(" %.2f / %.2f |", 100.0 * error.torque, 100.0 * error.angle);
    }
    const Shortcut crowded = shortcut_error(EvenRun(8, idler, 0.4, true));
    std::printf(" %.1f / %.1f |\n", 100.0 * crowded.torque, 100.0 * crowded.angle);
    EXPECT_GT(crowded.torque, 5.0 * shortcut_error(EvenRun(8, idler, 0.4)).torque);
  }
  // The same friction number in all, on more and more pulleys: the run is the trapezoid rule of the surface.
  for (const double eta : {0.3, 1.14, 2.0}) {
    std::printf("eta %.2f in all, torque error %%:", eta);
    std::vector<double> errors;
    for (const std::size_t n : {1U, 2U, 4U, 8U, 16U, 32U}) {
      const Idler seized = {eta / static_cast<double>(n), 1.0, 2.0, 1.0};
      errors.push_back(shortcut_error(EvenRun(n, seized, 0.4)).torque);
      std::printf(" %zu: %.3f", n, 100.0 * errors.back());
    }
    std::printf("\n");
    EXPECT_NEAR(errors[3] / errors[4], 4.0, 0.3);
    EXPECT_NEAR(errors[4] / errors[5], 4.0, 0.3);
  }
}

}  // namespace
}  // namespace capstan
