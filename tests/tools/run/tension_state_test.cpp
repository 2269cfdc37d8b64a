// SPDX-License-Identifier: Apache-2.0
// Free tip, locked tip and everything between: the tension state beside the laws that are made for either end, each
// fitted to the very environment it is tried in; the tension state is identified once, with the tip locked.
#include "capstan/model/tension_state.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "capstan/tests/model/support.hpp"
#include "capstan/tests/tools/run/by_hand.hpp"
#include "capstan/tools/support/statistics.hpp"

namespace capstan::tools {
namespace {

using test::triangle;
using test::turn_by_hand;

auto plant_against(double stiffness) -> sim::PlantParameters {
  sim::PlantParameters plant;
  if (std::isinf(stiffness)) {
    plant.environment.kind = sim::EnvironmentKind::kLocked;
  } else if (stiffness > 0.0) {
    plant.environment = {.kind = sim::EnvironmentKind::kSpring, .stiffness = stiffness};
  }
  return plant;
}

auto identified() -> TensionStateParameters<double> {
  const PullPushFit fit =
      fit_pull_push({turn_by_hand(plant_against(std::numeric_limits<double>::infinity()), 60.0, triangle(0.25, 0.05))});
  const auto value = [&](const char* name) {
    return std::find_if(fit.parameters.begin(), fit.parameters.end(), [&](const auto& p) { return p.name == name; })
        ->value;
  };
  return {fit.law.eta_top,
          fit.law.eta_bottom,
          fit.law.pretension_nm,
          1.0 / value("stiffness_top"),
          1.0 / value("stiffness_bottom"),
          1.0 / fit.law.ratio};
}

/// Regressors of (5.28), the direction by the conditioner.
auto pseudo_kinematic_columns(const AxisLog& log) -> Eigen::MatrixXd {
  SampleConditioner<double> conditioner(SamplePeriod<double>(0.001), ConditionerShape<double>{});
  Eigen::MatrixXd columns(log.samples(), 4);
  for (Eigen::Index i = 0; i < log.samples(); ++i) {
    const bool forward = conditioner.update(log.q1_rad[i], log.tau_nm[i]).forward;
    columns.row(i) << (forward ? log.tau_nm[i] : 0.0), (forward ? 0.0 : log.tau_nm[i]), log.q1_rad[i], 1.0;
  }
  return columns;
}

struct Errors {
  double angle = 0.0, torque = 0.0;  ///< rms, rad and share of the largest joint torque
  double angle_kinematic = 0.0, torque_preisach = 0.0;
};
auto errors_against(double stiffness, const TensionStateParameters<double>& parameters) -> Errors {
  const auto plant = plant_against(stiffness);
  const capstan::test::RandomMultisine motion(14, 1.0, 0.03, 0.4);
  const auto wander = [&](double t) { return 0.25 * std::tanh(3.0 * motion(t) + std::sin(0.5 * t)); };
  Eigen::VectorXd learned_angle, angle;
  const AxisLog learned = turn_by_hand(
      plant, 100.0, [](double t) { return triangle(0.28 - 0.0025 * std::min(t, 100.0), 0.1)(t); }, &learned_angle);
  const AxisLog log = turn_by_hand(plant, 60.0, wander, &angle);
  const PreisachFit preisach = fit_preisach({learned});
  const Eigen::VectorXd theta = pseudo_kinematic_columns(learned).householderQr().solve(learned_angle);
  Preisach<double, kMostPreisachLevels> force_law(preisach.table, StartState::kDemagnetised, 1e-9);
  TensionState<double> state(parameters);
  SampleConditioner<double> conditioner(SamplePeriod<double>(0.001), ConditionerShape<double>{});
  Eigen::VectorXd angle_error(log.samples()), torque_error(log.samples()), preisach_error(log.samples());
  for (Eigen::Index i = 0; i < log.samples(); ++i) {
    const bool forward = conditioner.update(log.q1_rad[i], log.tau_nm[i]).forward;
    const auto estimate = state.update(log.q1_rad[i], log.tau_nm[i], forward);
    angle_error[i] = estimate.q2 - angle[i];
    torque_error[i] = estimate.joint_torque - log.effort[i];
    preisach_error[i] = force_law.update(log.tau_nm[i]).force - log.effort[i];
  }
  const Eigen::Index tail = log.samples() - 10000;  // the first seconds are needed to learn the past
  const double largest = log.effort.cwiseAbs().maxCoeff();
  const Eigen::VectorXd kinematic_error = pseudo_kinematic_columns(log) * theta - angle;
  return {rms(angle_error.tail(tail)), rms(torque_error.tail(tail)) / largest, rms(kinematic_error.tail(tail)),
          rms(preisach_error.tail(tail)) / largest};
}

TEST(TensionStateOnThePlant, GivesAngleAndTorqueTogetherFromFreeToLocked) {
  const auto parameters = identified();
  std::printf(
      "| K_env, N m/rad | angle, mrad: tension state | pseudo-kinematic | torque, %%: tension state | Preisach |\n");
  for (const double stiffness : {0.0, 0.02, 0.1, 0.5, 2.0, std::numeric_limits<double>::infinity()}) {
    const Errors errors = errors_against(stiffness, parameters);
    std::printf("| %g | %.2f | %.2f | %.2f | %.2f |\n", stiffness, 1e3 * errors.angle, 1e3 * errors.angle_kinematic,
                100.0 * errors.torque, 100.0 * errors.torque_preisach);
    EXPECT_LT(errors.angle, 2.5e-3) << stiffness;
    EXPECT_LT(errors.torque, 0.08) << stiffness;
    if (!std::isinf(stiffness)) {  // a joint that stands still is no test of an angle's law that was fitted to it
      EXPECT_LT(errors.angle, 0.2 * errors.angle_kinematic) << stiffness;
    } else {
      EXPECT_LT(errors.torque, 0.01);
      EXPECT_LT(errors.torque, errors.torque_preisach);
    }
  }
}

}  // namespace
}  // namespace capstan::tools
