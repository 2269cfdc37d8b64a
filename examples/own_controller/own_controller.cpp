// SPDX-License-Identifier: Apache-2.0
// A controller of one's own around Capstan's law: the joint is to swing, the inverse of the law says where the motor
// has to stand for that, across the gap and ahead of what the tendons stretch, and the law says where the joint then
// is. Prints how far that is from what was wanted, and how far without the inverse.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string_view>

#include "capstan/model/motion_law.hpp"

namespace {

/// Sets a coefficient of a law by the names of its catalogue, as a joint.toml has them.
void set(capstan::LawParameters<double>& law, std::string_view term, std::string_view coefficient, double value) {
  std::size_t next = 0;
  capstan::SumTerms::for_each<double>([&]<typename Term>() {
    for (const auto& info : Term::kInfo.coefficients) {
      if (term == Term::kInfo.name && coefficient == info.name) {
        law.coefficients[next] = value;
      }
      ++next;
    }
  });
}

/// The same for a shape of a term.
void set_shape(capstan::LawParameters<double>& law, std::string_view term, std::string_view shape, double value) {
  std::size_t next = capstan::InputTerms::kShapes;
  capstan::SumTerms::for_each<double>([&]<typename Term>() {
    for (const auto& info : Term::kInfo.shapes) {
      if (term == Term::kInfo.name && shape == info.name) {
        law.shapes[next] = value;
      }
      ++next;
    }
  });
}

}  // namespace

int main() {
  constexpr double kBeta = 1.08;  // joint radians per motor radian
  constexpr double kFriction_nm = 0.05;
  constexpr int kGapCrossed = 100;  // cycles; before, nobody knows where in its gap the joint stands
  capstan::LawParameters<double> parameters;
  set(parameters, "motor_angle", "beta", kBeta);
  set(parameters, "tendon_elongation", "top", -0.4);  // rad/Nm
  set(parameters, "tendon_elongation", "bottom", -0.3);
  set(parameters, "play", "gain", kBeta);
  set_shape(parameters, "play", "half_width", 0.02);             // rad at the motor
  parameters.conditioner = {.direction_threshold_rad = 0.0005};  // a return by less is noise
  const capstan::SamplePeriod<double> period(0.001);
  capstan::MotionLaw<double> law(period, parameters);
  capstan::MotionLaw<double> without(period, parameters);

  double worst_rad = 0.0;
  double worst_without_rad = 0.0;
  double motor_rad = 0.0;
  for (int i = 0; i < 5000; ++i) {
    const double wanted_rad = 0.5 * std::sin(0.002 * i);
    const bool forward = std::cos(0.002 * i) >= 0.0;
    const double torque_nm = forward ? kFriction_nm : -kFriction_nm;
    motor_rad = law.invert(wanted_rad, {.q1 = motor_rad, .tau = torque_nm, .forward = forward});
    const double joint_rad = law.update(motor_rad, torque_nm).q2;
    const double joint_without_rad = without.update(wanted_rad / kBeta, torque_nm).q2;
    if (i > kGapCrossed) {
      worst_rad = std::max(worst_rad, std::fabs(joint_rad - wanted_rad));
      worst_without_rad = std::max(worst_without_rad, std::fabs(joint_without_rad - wanted_rad));
    }
  }
  std::printf("worst error of the joint: %.2e rad, %.3f rad without the inverse\n", worst_rad, worst_without_rad);
  return worst_rad < 1e-12 && worst_without_rad > 0.03 ? 0 : 1;
}
