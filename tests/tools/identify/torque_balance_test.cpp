// SPDX-License-Identifier: Apache-2.0
// What has come to a joint by its motor's torque, on torques written down by hand: every cause alone is told with its
// size, and what is none of them has no name.
#include "capstan/tools/identify/torque_balance.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "capstan/tools/diagnose/torque_gauge.hpp"
#include "capstan/tools/select/deciding_numbers.hpp"
#include "capstan/tools/support/random.hpp"

namespace capstan::tools {
namespace {

constexpr double kHalfWidth = 0.02;  // rad, at the motor
constexpr double kBeta = 0.9;
constexpr double kFriction = 0.015;  // Nm

/// One instant of the joint: what a load may hang on.
struct Instant {
  double q1, dq1, ddq1, q2, ddq2, s, way, time;
};
using Load = std::function<double(const Instant&)>;  // Nm at the motor, beside the healthy joint's torque

/// A minute of two swings at a time, the joint behind a gap, its torque f s + b q1' + m q1'' and the load.
/// @param reach  how far it goes, over 0.55 rad
auto log_with(const Load& load, std::uint64_t seed = 1, double reach = 1.0) -> AxisLog {
  constexpr Eigen::Index kRows = 30000;
  AxisLog log;
  log.name = "made.csv";
  log.period_s = 0.002;
  log.has_torque = true;
  log.time_s = log.q1_rad = log.tau_nm = log.q2_rad = Eigen::VectorXd(kRows);
  Random random(seed);
  double behind = 0.0;
  double turned = 0.0;
  double s = 1.0;
  for (Eigen::Index i = 0; i < kRows; ++i) {
    const double t = log.period_s * static_cast<double>(i);
    const double w[] = {2.0 * std::numbers::pi * 0.23, 2.0 * std::numbers::pi * 0.71};
    Instant now{};
    now.time = t;
    now.q1 = reach * (0.4 * std::sin(w[0] * t) + 0.15 * std::sin(w[1] * t));
    now.dq1 = reach * (0.4 * w[0] * std::cos(w[0] * t) + 0.15 * w[1] * std::cos(w[1] * t));
    now.ddq1 = -reach * (0.4 * w[0] * w[0] * std::sin(w[0] * t) + 0.15 * w[1] * w[1] * std::sin(w[1] * t));
    if ((now.dq1 > 0.0) != (s > 0.0)) {
      s = -s;
      turned = now.q1;
    }
    behind = std::clamp(behind, now.q1 - kHalfWidth, now.q1 + kHalfWidth);
    now.s = s;
    now.q2 = kBeta * behind;
    now.ddq2 = kBeta * now.ddq1;
    now.way = std::abs(now.q1 - turned) - 2.0 * kHalfWidth;
    log.time_s[i] = t;
    log.q1_rad[i] = now.q1;
    log.q2_rad[i] = now.q2 + 0.001 * random.normal();
    log.tau_nm[i] = kFriction * s + 3e-4 * now.dq1 + 2e-5 * now.ddq1 + 4e-4 + load(now) + 3e-4 * random.normal();
  }
  return log;
}

auto samples_of(const AxisLog& log) -> Samples {
  ConditionerShape<double> shape;
  shape.direction_threshold_rad = 1e-4;
  return causal_samples(log, shape);
}

auto none(const Instant& /*now*/) -> double {
  return 0.0;
}

/// @param late_s  by which the joint is known to be shown later than the motor
auto change_in(AxisLog log, double late_s = 0.0) -> TorqueChange {
  const std::vector<AxisLog> before = {log_with(none)};
  const std::vector<AxisLog> after = {std::move(log)};
  const std::vector<Samples> seen[] = {{samples_of(before[0])}, {samples_of(after[0])}};
  const auto healthy = torque_parts({before, seen[0], kHalfWidth, kBeta});
  EXPECT_TRUE(healthy);
  const auto change = torque_change({after, seen[1], kHalfWidth, kBeta, late_s}, *healthy);
  EXPECT_TRUE(change);
  return *change;
}

auto change_by(const Load& load) -> TorqueChange {
  return change_in(log_with(load, 2));
}

auto name_of(const Load& load) -> std::string {
  const auto finding = found_in_torque(change_by(load), kFriction, kBeta);
  return finding ? finding->name : "";
}

TEST(TorqueBalance, PartsAreThoseOfTheJoint) {
  const std::vector<AxisLog> logs = {log_with(none)};
  const std::vector<Samples> samples = {samples_of(logs[0])};
  const auto parts = torque_parts({logs, samples, kHalfWidth, kBeta});
  ASSERT_TRUE(parts);
  const double truth[] = {kFriction, 4e-4, 3e-4, 2e-5, 0.0, 0.0, 0.0, 0.0};
  const double tolerance[] = {1e-4, 1e-4, 3e-5, 4e-6, 5e-4, 2e-3, 5e-4, 2e-3};
  for (std::size_t i = 0; i < TorqueParts::kCount; ++i) {
    EXPECT_NEAR(parts->values[i], truth[i], tolerance[i]) << TorqueParts::kNames[i];
  }
}

TEST(TorqueBalance, ATorqueThatRepeatsWithTheAngleIsToldWithItsAmplitudeAtItsOrderAlone) {
  constexpr double kOrder = 9.0;
  const std::vector<AxisLog> before = {log_with(none)};
  const std::vector<Samples> seen_before = {samples_of(before[0])};
  const auto healthy = torque_parts({before, seen_before, kHalfWidth, kBeta});
  ASSERT_TRUE(healthy);
  const std::vector<AxisLog> after = {log_with(
      [](const Instant& now) { return 0.002 * std::sin(kOrder * now.q1) - 0.001 * std::cos(kOrder * now.q1); }, 2)};
  const std::vector<Samples> seen = {samples_of(after[0])};
  const TorqueLogs now{after, seen, kHalfWidth, kBeta};
  EXPECT_NEAR(periodic_torque(now, *healthy, kOrder), std::hypot(0.002, 0.001), 1e-4);
  EXPECT_LT(periodic_torque(now, *healthy, 3.0 * kOrder), 3e-4);
  const TorqueLogs still{after, seen, 10.0, kBeta};  // never through so wide a loop
  EXPECT_EQ(periodic_torque(still, *healthy, kOrder), 0.0);
}

// Strokes of one speed make drag all but friction; what either leaves tells them apart.
TEST(TorqueBalance, DragIsToldFromFrictionByWhatItLeavesWhereTheSpeedIsAllButTheSame) {
  TorqueChange change;
  change.rms_nm = 0.1 * kFriction;
  change.share[static_cast<std::size_t>(TorqueCause::kFriction)] = 0.9;
  change.share[static_cast<std::size_t>(TorqueCause::kDrag)] = 0.99;
  change.size[static_cast<std::size_t>(TorqueCause::kDrag)] = 1e-3;
  const auto drag = found_in_torque(change, kFriction, kBeta);
  ASSERT_TRUE(drag);
  EXPECT_EQ(drag->name, "transmission_viscous");
  change.share[static_cast<std::size_t>(TorqueCause::kDrag)] = 0.93;
  EXPECT_FALSE(found_in_torque(change, kFriction, kBeta));
}

TEST(TorqueBalance, AWeightIsToldWithItsSizeWhichTautTendonsPassOnOneToOne) {
  const double weight = 0.02;  // Nm at the joint
  const Load load = [&](const Instant& now) { return kBeta * weight * std::sin(now.q2); };
  const auto finding = found_in_torque(change_by(load), kFriction, kBeta);
  ASSERT_TRUE(finding);
  EXPECT_EQ(finding->name, "gravity");
  EXPECT_NEAR(finding->size.value, weight, 0.05 * weight);
  EXPECT_LT((*finding->size.ci95)[0], weight);
  EXPECT_GT((*finding->size.ci95)[1], weight);
}

TEST(TorqueBalance, AWeightThatOneTendonCarriesAloneIsNotTakenForALargerOne) {
  // (2.17): the pulled tendon gives T_in = T_out e^eta against the motion, and T_out e^-eta with it, as soon as that is
  // more than both of them do.
  const double weight = 0.12;
  const double eta = 1.0;
  const Load load = [&](const Instant& now) {
    const double against = now.s * kBeta * weight * std::sin(now.q2);
    const double taut = against + kFriction;
    const double slack = against * (against > 0.0 ? std::exp(eta) : std::exp(-eta));
    return now.s * ((slack > taut ? slack : taut) - kFriction);
  };
  const auto finding = found_in_torque(change_by(load), kFriction, kBeta);
  ASSERT_TRUE(finding);
  EXPECT_EQ(finding->name, "gravity");
  EXPECT_NEAR(finding->size.value, weight, 0.06 * weight);
}

// A motion of 0.9 rad; friction goes with the load, as taut tendons have it.
TEST(TorqueBalance, ATipInContactIsToldFromAWeight) {
  constexpr double kFar = 1.8;
  const double weight = 0.02;  // Nm at the joint
  const auto hanging = change_in(
      log_with([&](const Instant& now) { return kBeta * weight * (1.0 + 0.3 * now.s) * std::sin(now.q2); }, 2, kFar));
  EXPECT_GT(hanging.spring_over_weight, 1.0 / kLoadTold);
  const auto by_weight = found_in_torque(hanging, kFriction, kBeta);
  ASSERT_TRUE(by_weight);
  EXPECT_EQ(by_weight->name, "gravity");
  EXPECT_EQ(by_weight->sentence.find("does not tell them apart"), std::string::npos);
  const double stiffness = 0.03;  // Nm/rad at the joint
  const auto touching = change_in(
      log_with([&](const Instant& now) { return kBeta * stiffness * (1.0 + 0.3 * now.s) * now.q2; }, 2, kFar));
  const auto by_spring = found_in_torque(touching, kFriction, kBeta);
  ASSERT_TRUE(by_spring);
  EXPECT_EQ(by_spring->name, "");
  EXPECT_EQ(by_spring->size.unit, "Nm/rad");
  EXPECT_NEAR(by_spring->size.value, stiffness, 0.03 * stiffness);
  EXPECT_NE(by_spring->sentence.find("contact"), std::string::npos);
  EXPECT_TRUE(contradicted_by_torque("gravity", touching, kFriction));
}

TEST(TorqueBalance, AWeightThatIsNotToldFromASpringSaysSo) {
  TorqueChange change;
  change.rms_nm = kFriction;
  change.share[static_cast<std::size_t>(TorqueCause::kWeight)] = 0.9;
  change.size[static_cast<std::size_t>(TorqueCause::kWeight)] = 0.02 * kBeta;
  change.size_95[static_cast<std::size_t>(TorqueCause::kWeight)] = 0.002 * kBeta;
  const auto either = found_in_torque(change, kFriction, kBeta);
  ASSERT_TRUE(either);
  EXPECT_EQ(either->name, "gravity");
  EXPECT_NE(either->sentence.find("does not tell them apart"), std::string::npos);
  change.size_95[static_cast<std::size_t>(TorqueCause::kWeight)] = 0.012 * kBeta;  // 60 % to either side
  const auto unsure = found_in_torque(change, kFriction, kBeta);
  ASSERT_TRUE(unsure);
  EXPECT_EQ(unsure->name, "");
}

TEST(TorqueBalance, AMassAndDragAreTold) {
  const double mass = 4e-4;  // kg m2
  const auto by_mass =
      found_in_torque(change_by([&](const Instant& now) { return kBeta * mass * now.ddq2; }), kFriction, kBeta);
  ASSERT_TRUE(by_mass);
  EXPECT_EQ(by_mass->name, "load_inertia");
  EXPECT_NEAR(by_mass->size.value, mass, 0.1 * mass);
  EXPECT_EQ(name_of([](const Instant& now) { return 3e-3 * now.dq1; }), "transmission_viscous");
}

// Soft tendons pass a torque from outside on to the motor as they stretch, against the joint's acceleration: as a mass
// would, but the motor's own acceleration makes none.
TEST(TorqueBalance, WhatShakesTheJointFromOutsideIsNoMass) {
  constexpr double kShakeRad = 0.02;
  constexpr double kRate = 2.0 * std::numbers::pi * 3.0;
  AxisLog shaken = log_with(
      [&](const Instant& now) { return -4e-4 * kBeta * kShakeRad * kRate * kRate * std::sin(kRate * now.time); }, 2);
  shaken.q2_rad.array() += kShakeRad * (kRate * shaken.time_s.array()).sin();
  const TorqueChange change = change_in(std::move(shaken));
  EXPECT_GT(change.rms_nm, 0.1 * kFriction);
  EXPECT_FALSE(found_in_torque(change, kFriction, kBeta));
}

/// A mass on its tendons: besides following the motor it swings at 5 Hz after each of its turns, for a second, and the
/// motor carries what accelerates it.
void let_swing(double mass, AxisLog& log) {
  constexpr double kRate = 2.0 * std::numbers::pi * 5.0;  // rad/s
  constexpr double kFades = 3.0;                          // 1/s
  constexpr double kKick = 0.4;                           // rad/s
  double angle = 0.0;
  double rate = 0.0;
  for (Eigen::Index i = 1; i + 1 < log.samples(); ++i) {
    const double came = log.q1_rad[i] - log.q1_rad[i - 1];
    const double goes = log.q1_rad[i + 1] - log.q1_rad[i];
    if ((came > 0.0) != (goes > 0.0)) {
      rate += goes > 0.0 ? kKick : -kKick;
    }
    const double speedup = -kRate * kRate * angle - 2.0 * kFades * rate;
    rate += log.period_s * speedup;
    angle += log.period_s * rate;
    log.q2_rad[i] += angle;
    log.tau_nm[i] += kBeta * mass * speedup;
  }
}

TEST(TorqueBalance, AMassThatSwingsOnItsTendonsIsToldThoughTheMotorDoesNotSwing) {
  const double mass = 1e-3;  // kg m2
  const auto with_mass = [&](double late_s) {
    AxisLog log = log_with([&](const Instant& now) { return kBeta * mass * now.ddq2; }, 2);
    let_swing(mass, log);
    const auto late = static_cast<Eigen::Index>(late_s / log.period_s);
    const Eigen::VectorXd shown = log.q2_rad;
    log.q2_rad.tail(shown.size() - late) = shown.head(shown.size() - late);
    return log;
  };
  const auto told = found_in_torque(change_in(with_mass(0.0)), kFriction, kBeta);
  ASSERT_TRUE(told);
  EXPECT_EQ(told->name, "load_inertia");
  EXPECT_NEAR(told->size.value, mass, 0.15 * mass);
  EXPECT_LT((*told->size.ci95)[0], mass);
  EXPECT_GT((*told->size.ci95)[1], mass);
  EXPECT_FALSE(found_in_torque(change_in(with_mass(0.04)), kFriction, kBeta)) << "shown a fifth of a swing later";
  const auto late = found_in_torque(change_in(with_mass(0.04), 0.04), kFriction, kBeta);
  ASSERT_TRUE(late) << "and known to be so late";
  EXPECT_EQ(late->name, "load_inertia");
  EXPECT_NEAR(late->size.value, mass, 0.15 * mass);
}

TEST(TorqueBalance, WhatTheTorqueDoesNotShowIsContradicted) {
  const TorqueChange nothing = change_by(none);
  EXPECT_TRUE(contradicted_by_torque("gravity", nothing, kFriction));
  EXPECT_TRUE(contradicted_by_torque("load_inertia", nothing, kFriction));
  EXPECT_FALSE(contradicted_by_torque("angle_periodic", nothing, kFriction));
  EXPECT_FALSE(contradicted_by_torque("play", nothing, kFriction));
  EXPECT_FALSE(friction_has_changed(nothing, kFriction));
  const TorqueChange tighter = change_by([](const Instant& now) { return 0.2 * kFriction * now.s; });
  EXPECT_FALSE(contradicted_by_torque("pretension_offset", tighter, kFriction));
  EXPECT_TRUE(contradicted_by_torque("angle_periodic", tighter, kFriction));
  EXPECT_TRUE(contradicted_by_torque("transmission_viscous", tighter, kFriction));
  EXPECT_TRUE(friction_has_changed(tighter, kFriction));
  const TorqueChange bent = change_by([](const Instant& now) { return kFriction * now.s * std::fabs(now.q2); });
  EXPECT_TRUE(contradicted_by_torque("pretension_offset", bent, kFriction)) << "friction of a place";
  EXPECT_TRUE(contradicted_by_torque("viscoelastic_creep", bent, kFriction)) << "creep lets tension go";
  const TorqueChange hardly_bent =
      change_by([](const Instant& now) { return 0.07 * kFriction * now.s * std::fabs(now.q2); });
  EXPECT_GT(hardly_bent.rms_nm, 0.015 * kFriction);
  EXPECT_LT(hardly_bent.share[static_cast<std::size_t>(TorqueCause::kFriction)], 0.9);
  EXPECT_FALSE(contradicted_by_torque("stiffness_hardening", hardly_bent, kFriction)) << "what is left counts as none";
  const TorqueChange crept = change_by([](const Instant& now) { return -0.1 * kFriction * now.s; });
  EXPECT_FALSE(contradicted_by_torque("viscoelastic_creep", crept, kFriction));
  const TorqueChange dragged = change_by([](const Instant& now) { return 3e-3 * now.dq1; });
  EXPECT_FALSE(contradicted_by_torque("transmission_viscous", dragged, kFriction));
}

TEST(TorqueBalance, FrictionThatBendsFirstIsPresliding) {
  EXPECT_EQ(name_of([](const Instant& now) {
              const double bent = std::clamp(-1.0 + 2.0 * now.way / 0.06, -1.0, 1.0);
              return 0.008 * now.s * bent;
            }),
            "presliding");
}

TEST(TorqueBalance, ABendThatIsShortBesideTheStrokeIsPreslidingWithTheSizeItSlidesAt) {
  const double friction = 0.008;  // Nm at the motor
  const Load load = [&](const Instant& now) {
    return friction * now.s * std::clamp(-1.0 + 2.0 * now.way / 0.03, -1.0, 1.0);
  };
  const auto change = change_by(load);
  const auto plain = change.share[static_cast<std::size_t>(TorqueCause::kFriction)];
  EXPECT_GT(plain, 0.85) << "friction that is the same everywhere takes away most, too";
  const auto finding = found_in_torque(change, kFriction, kBeta);
  ASSERT_TRUE(finding);
  EXPECT_EQ(finding->name, "presliding");
  EXPECT_NEAR(finding->size.value, friction / kBeta, 0.05 * friction / kBeta);
  ASSERT_TRUE(finding->size.ci95);
  EXPECT_LT((*finding->size.ci95)[0], friction / kBeta);
  EXPECT_GT((*finding->size.ci95)[1], friction / kBeta);
}

TEST(TorqueBalance, WhatIsNoneOfThemHasNoName) {
  EXPECT_EQ(name_of(none), "") << "healthy";
  EXPECT_EQ(name_of([](const Instant& now) { return 0.006 * now.s; }), "") << "friction, as of more pretension";
  EXPECT_EQ(name_of([](const Instant& now) { return 0.006 * now.s * std::exp(-std::pow((now.q2 - 0.2) / 0.05, 2.0)); }),
            "")
      << "friction at one place";
  EXPECT_EQ(name_of([](const Instant& now) { return 0.005 * std::sin(35.0 * now.q1); }), "") << "cogging";
  EXPECT_EQ(name_of([](const Instant& now) { return 0.01 * now.s * std::abs(now.q2); }), "")
      << "friction that grows with the angle";
  EXPECT_EQ(name_of([](const Instant& now) { return 0.005 * std::sin(2.0 * std::numbers::pi * 3.0 * now.time); }), "")
      << "a tremor";
  EXPECT_EQ(name_of([](const Instant& /*now*/) { return 0.01; }), "") << "a constant";
}

TEST(TorqueBalance, AMotionWithinTheLoopTellsNothing) {
  const std::vector<AxisLog> logs = {log_with(none)};
  const std::vector<Samples> samples = {samples_of(logs[0])};
  EXPECT_FALSE(torque_parts({logs, samples, 0.6, kBeta}));
}

}  // namespace
}  // namespace capstan::tools
