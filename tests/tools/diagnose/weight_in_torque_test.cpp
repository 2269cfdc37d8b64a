// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/diagnose/weight_in_torque.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "capstan/tools/support/random.hpp"

namespace capstan::tools {
namespace {

constexpr double kElongation = -0.17;  // rad/Nm
constexpr double kWave = 0.012;        // rad per sin q2

/// A belt whose joint moves by a wave over its own angle. A weight's torque is in the motor's, a pulley's is not.
auto belt_log(double share_in_torque) -> AxisLog {
  constexpr Eigen::Index kRows = 4000;
  AxisLog log;
  log.name = "belt.csv";
  log.target = "axis0/q2_rad";
  log.period_s = 0.01;
  log.has_torque = true;
  log.time_s = Eigen::VectorXd::LinSpaced(kRows, 0.0, log.period_s * static_cast<double>(kRows - 1));
  log.q1_rad = log.tau_nm = log.q2_rad = Eigen::VectorXd::Zero(kRows);
  Random random(0xBE17);
  for (Eigen::Index i = 0; i < kRows; ++i) {
    const double phase = 2.0 * std::numbers::pi * log.time_s[i] / 10.0;
    const double q1 = 5.0 * std::sin(phase) + 1.5 * std::sin(3.0 * phase + 0.4);
    const double rate = 5.0 * std::cos(phase) + 4.5 * std::cos(3.0 * phase + 0.4);
    const double friction = (rate > 0.0 ? 0.08 : -0.08) + 0.004 * rate;
    const double wave = kWave * std::sin(0.5 * q1);
    log.q1_rad[i] = q1;
    log.tau_nm[i] = friction + share_in_torque * wave / kElongation + 0.002 * random.normal();
    log.q2_rad[i] = 0.5 * q1 + kElongation * friction + wave + 0.0005 * random.normal();
  }
  return log;
}

auto is_warned_of_the_pulley(const Diagnosis& d) -> bool {
  return std::any_of(d.warnings.begin(), d.warnings.end(),
                     [](const auto& warning) { return warning.find("off its centre") != std::string::npos; });
}

TEST(WeightInTorque, APulleyOffItsCentreIsSaidBesideTheNameOfAWeight) {
  const Diagnosis pulley = diagnose({belt_log(0.0)}, {});
  const bool called_weight = std::any_of(pulley.effects.begin(), pulley.effects.end(),
                                         [](const auto& effect) { return effect.name == "gravity"; });
  EXPECT_TRUE(called_weight) << "this test shows nothing: " << pulley.reason;
  EXPECT_TRUE(is_warned_of_the_pulley(pulley)) << pulley.reason;
  EXPECT_FALSE(is_warned_of_the_pulley(diagnose({belt_log(1.0)}, {})));
}

TEST(WeightInTorque, TheShareIsThatOfTheWeightThatTheTorqueHolds) {
  for (const double share : {0.0, 1.0}) {
    LawForm form;
    form.terms = {"motor_angle", "joint_offset", "tendon_elongation", "gravity"};
    JointFile law;
    law.terms = form.terms;
    law.parameters.coefficients[law.catalogue->term("tendon_elongation").first_coefficient] = kElongation;
    law.parameters.coefficients[law.catalogue->term("tendon_elongation").first_coefficient + 1] = kElongation;
    law.parameters.coefficients[law.catalogue->term("gravity").first_coefficient] = kWave;
    const auto weight = weight_in_torque(prepare({belt_log(share)}, form), law);
    ASSERT_TRUE(weight);
    EXPECT_NEAR(weight->share, share, 0.1);
    EXPECT_LT(weight->share_at_most, share + 0.3);
    EXPECT_NEAR(weight->needed_nm, kWave / 0.17, 1e-9);
  }
}

}  // namespace
}  // namespace capstan::tools
