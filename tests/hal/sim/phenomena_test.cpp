// SPDX-License-Identifier: Apache-2.0
// What a tendon-driven joint does without being told to: loops, minor loops, four force phases. Quasi-static unless
// said otherwise: the input pulley is moved by hand, the joint is free or held.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "capstan/hal/sim/motion.hpp"
#include "capstan/hal/sim/plant.hpp"
#include "capstan/tests/hal/sim/support.hpp"

namespace capstan::sim {
namespace {

using test::Bench;
using test::quiet;

constexpr double kDegree = std::numbers::pi / 180.0;

std::vector<Truth> sweep(const PlantParameters& parameters, double amplitude_rad, double frequency_hz, double cycles) {
  Plant plant(parameters, 1);
  std::vector<Truth> record;
  const auto steps = static_cast<int>(cycles / frequency_hz / Plant::kStepS);
  for (int i = 1; i <= steps; ++i) {
    const double turns = frequency_hz * Plant::kStepS * static_cast<double>(i);
    plant.step_kinematic(amplitude_rad * std::sin(2.0 * std::numbers::pi * turns));
    record.push_back(plant.truth());
  }
  return record;
}

double lag(const PlantParameters& p, const Truth& t) {
  return t.q1_rad * p.input_radius_m / p.output_radius_m - t.q2_rad;
}

// The last of 1.25 cycles: the first quarter leaves the state of rest.
std::size_t settled(const std::vector<Truth>& record) {
  return record.size() / 5;
}

// Half the width of the q1-q2 loop, slow enough that speed plays no part.
double half_width_rad(const PlantParameters& p) {
  const std::vector<Truth> record = sweep(p, 0.5, 0.2, 1.25);
  double high = -1.0;
  double low = 1.0;
  for (std::size_t i = settled(record); i < record.size(); ++i) {
    high = std::max(high, lag(p, record[i]));
    low = std::min(low, lag(p, record[i]));
  }
  return 0.5 * (high - low);
}

double loop_area(const PlantParameters& p, double frequency_hz) {
  const std::vector<Truth> record = sweep(p, 0.5, frequency_hz, 1.25);
  double area = 0.0;
  for (std::size_t i = settled(record); i < record.size(); ++i) {
    area += 0.5 * (record[i].q2_rad + record[i - 1].q2_rad) * (record[i].q1_rad - record[i - 1].q1_rad);
  }
  return -area;
}

double peak_torque(const PlantParameters& p) {
  double peak = 0.0;
  for (const Truth& t : sweep(p, 0.5, 0.2, 0.5))
    peak = std::max(peak, std::fabs(t.tau_in_nm));
  return peak;
}

TEST(Phenomena, TheLoopConvergesAsTheFrequencyFalls) {
  const PlantParameters p = quiet();
  const double slowest = loop_area(p, 0.01);
  EXPECT_NEAR(loop_area(p, 0.05), slowest, 0.02 * slowest);
}

TEST(Phenomena, DragWidensTheLoopWithFrequency) {
  PlantParameters p = quiet();
  p.effects.transmission_viscous_forward_ns_per_m = 1500.0;
  p.effects.transmission_viscous_backward_ns_per_m = 1500.0;
  const double at_rest = loop_area(quiet(), 0.05);
  const double slow = loop_area(p, 0.05);
  const double middle = loop_area(p, 0.2);
  const double fast = loop_area(p, 1.0);
  EXPECT_NEAR(slow, at_rest, 0.06 * at_rest);
  EXPECT_GT(middle, 1.1 * at_rest);
  EXPECT_GT(fast, 1.5 * middle);
}

TEST(Phenomena, TheFreeLoopHasTheWidthOfTheClosedForm) {
  // Both tendons slide, no torque at the output: Ttr = Tbr = T with T (e^eta - e^-eta) / eta = I. The difference of
  // their elongations turns the joint back by T (e^eta + e^-eta - 2) / (2 eta Kn r2) on average of the two directions.
  PlantParameters p = quiet();
  p.joint_coulomb_nm = 0.0;
  p.joint_viscous_nms_per_rad = 0.0;
  p.element_count = 32;
  const double eta = 0.5 * (p.eta_top + p.eta_bottom);
  const double stiffness = 0.5 * (p.stiffness_top_n_per_m + p.stiffness_bottom_n_per_m);
  const double tension = p.pretension_n * eta / (std::exp(eta) - std::exp(-eta));
  const double expected =
      tension * (std::exp(eta) + std::exp(-eta) - 2.0) / (2.0 * eta * stiffness * p.output_radius_m);
  EXPECT_NEAR(half_width_rad(p), expected, 0.005 * expected);
  const double torque = tension * (std::exp(eta) - std::exp(-eta)) * p.input_radius_m;
  EXPECT_NEAR(peak_torque(p), torque, 0.005 * torque);
}

TEST(Phenomena, MinorLoopsClose) {
  const PlantParameters p = quiet();
  Bench bench(p);
  bench.go(0.5);
  bench.go(-0.5);
  const Truth before = bench.go(0.2).back();
  bench.go(0.05);
  bench.go(0.15);
  bench.go(0.08);
  const Truth after = bench.go(0.2).back();
  EXPECT_NEAR(after.q2_rad, before.q2_rad, 2.0e-5);
  EXPECT_NEAR(after.tau_in_nm, before.tau_in_nm, 1.0e-5);
}

TEST(Phenomena, TheLoopWidensWithTendonFriction) {
  double before = 0.0;
  for (const double eta : {0.2, 0.5, 0.8, 1.1, 1.5}) {
    PlantParameters p = quiet();
    p.eta_top = p.eta_bottom = eta;
    const double width = half_width_rad(p);
    EXPECT_GT(width, before + 0.2 * kDegree) << eta;
    before = width;
  }
}

TEST(Phenomena, PretensionNarrowsTheLoopOfALoadedJoint) {
  // Joint friction of 0.03 N m empties the pushed tendon; the more pretension, the more it helps. The motor torque
  // stays.
  double width_before = 1.0;
  PlantParameters p = quiet();
  p.joint_coulomb_nm = 0.03;
  p.pretension_n = 1.0;
  const double torque = peak_torque(p);
  for (const double pretension : {1.0, 4.0, 7.0, 10.0, 14.0, 20.0}) {
    p.pretension_n = pretension;
    const double width = half_width_rad(p);
    EXPECT_LT(width, width_before - 0.2 * kDegree) << pretension;
    EXPECT_NEAR(peak_torque(p), torque, 0.01 * torque) << pretension;
    width_before = width;
  }
}

TEST(Phenomena, PretensionWidensTheLoopOfAJointWithoutLoad) {
  // Without a load, all friction comes from the pretension itself: width and torque are proportional to it.
  PlantParameters p = quiet();
  p.joint_coulomb_nm = 0.0;
  p.joint_viscous_nms_per_rad = 0.0;
  p.pretension_n = 10.0;
  const double narrow = half_width_rad(p);
  p.pretension_n = 40.0;
  EXPECT_NEAR(half_width_rad(p), 4.0 * narrow, 0.02 * 4.0 * narrow);
}

TEST(Phenomena, DoublingTheElementsChangesTheJointAngleByLessThanAFiftiethOfADegree) {
  PlantParameters coarse = quiet();
  PlantParameters fine = quiet();
  fine.element_count = 2 * coarse.element_count;
  const std::vector<Truth> a = sweep(coarse, 0.5, 0.2, 1.25);
  const std::vector<Truth> b = sweep(fine, 0.5, 0.2, 1.25);
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i)
    sum += std::pow(a[i].q2_rad - b[i].q2_rad, 2);
  EXPECT_LT(std::sqrt(sum / static_cast<double>(a.size())), 0.02 * kDegree);
}

// A locked tip, pulled forth and back far enough that tendons go slack. Enough elements for slopes to be smooth.
class LockedTip : public ::testing::Test {
 protected:
  LockedTip() : parameters_(quiet()) {
    parameters_.environment.kind = EnvironmentKind::kLocked;
    parameters_.element_count = 48;
  }

  // Triangle of the input pulley, two cycles; keeps the second rise (from -peak to +peak) step by step.
  void run(double peak) {
    Plant plant(parameters_, 1);
    const auto go = [&](double from, double to, bool keep) {
      constexpr int kSteps = 4000;
      for (int i = 1; i <= kSteps; ++i) {
        plant.step_kinematic(from + (to - from) * static_cast<double>(i) / kSteps);
        if (keep)
          rise_.push_back(plant.truth());
        if (keep)
          top_slack_.push_back(plant.drivetrain().top().elongation() <= 0.0);
        if (keep)
          bottom_slack_.push_back(plant.drivetrain().bottom().elongation() <= 0.0);
      }
    };
    go(0.0, peak, false);
    go(peak, -peak, false);
    go(-peak, peak, true);
  }

  [[nodiscard]] double slope(std::size_t i) const {
    return (rise_[i + 10].tau_in_nm - rise_[i].tau_in_nm) / (rise_[i + 10].q1_rad - rise_[i].q1_rad);
  }

  // First step of the rise at which the bottom tendon has gone slack.
  [[nodiscard]] std::size_t slack_instant() const {
    return static_cast<std::size_t>(std::find(bottom_slack_.begin(), bottom_slack_.end(), true) -
                                    bottom_slack_.begin());
  }

  PlantParameters parameters_;
  std::vector<Truth> rise_;
  std::vector<bool> top_slack_, bottom_slack_;
};

TEST_F(LockedTip, AReversalShowsFourPhases) {
  run(0.4);
  const double r1 = parameters_.input_radius_m;
  const double k = parameters_.stiffness_top_n_per_m;
  const double eta = parameters_.eta_top;
  const double pulled = k * eta / (1.0 - std::exp(-eta));
  const double pushed =
      parameters_.stiffness_bottom_n_per_m * parameters_.eta_bottom / (std::exp(parameters_.eta_bottom) - 1.0);
  // The rise begins with the top tendon slack (phase IV of the fall). The bottom tendon is let go: its tension at the
  // output does not follow at first (phase I), although the motor torque changes.
  EXPECT_TRUE(top_slack_.front());
  EXPECT_NEAR(rise_[60].tau_out_nm, rise_[0].tau_out_nm, 1.0e-9);
  EXPECT_GT(rise_[60].tau_in_nm, rise_[0].tau_in_nm + 0.01);
  // Phase III: both tendons slide, just before the bottom one goes slack; phase IV: only the top one is left.
  const std::size_t slack = slack_instant();
  ASSERT_LT(slack, rise_.size() - 200);
  EXPECT_NEAR(slope(slack - 60), r1 * r1 * (pulled + pushed), 0.01 * r1 * r1 * pulled);
  EXPECT_NEAR(slope(slack + 60), r1 * r1 * pulled, 0.01 * r1 * r1 * pulled);
}

TEST_F(LockedTip, FrictionNumberReadOffThePlateauIsThePlants) {
  run(0.4);
  const Truth& last = rise_.back();
  ASSERT_TRUE(bottom_slack_.back());
  const double eta = -std::log(last.tau_out_nm * parameters_.input_radius_m /
                               (last.tau_in_nm * parameters_.output_radius_m));  // (2.22)
  EXPECT_NEAR(eta, parameters_.eta_top, 0.02 * parameters_.eta_top);
}

TEST_F(LockedTip, FrictionNumberReadOffTheSlackInstantIsThePlants) {
  run(0.4);
  const Truth& instant = rise_[slack_instant()];
  const double eta =
      -std::log(instant.tau_out_nm * parameters_.input_radius_m / (instant.tau_in_nm * parameters_.output_radius_m));
  EXPECT_NEAR(eta, parameters_.eta_top, 0.02 * parameters_.eta_top);
}

TEST_F(LockedTip, PretensionReadOffTheSlackInstantIsThePlants) {
  run(0.4);
  const Truth& instant = rise_[slack_instant()];
  const double eta = parameters_.eta_top;
  // From (2.18): when the bottom tendon becomes empty, the top one alone has all of I, and it slides.
  const double pretension = instant.tau_in_nm / parameters_.input_radius_m * (1.0 - std::exp(-eta)) / eta;
  EXPECT_NEAR(pretension, parameters_.pretension_n, 0.02 * parameters_.pretension_n);
  // The thesis measured 0.111 to 0.130 N m at these instants (table 2.1).
  EXPECT_GT(instant.tau_in_nm, 0.111);
  EXPECT_LT(instant.tau_in_nm, 0.130);
}

}  // namespace
}  // namespace capstan::sim
