// SPDX-License-Identifier: Apache-2.0
// A position loop of one's own around Capstan's estimate: the motor swings, the joint is estimated from motor angle and
// torque, and the motor is asked for what the inverse law says. Prints the worst error of the inverse.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "capstan/model/motion_law.hpp"

int main() {
  capstan::LawParameters<double> parameters;
  parameters.coefficients[0] = 1.08;  // beta of the first term, motor_angle: joint radians per motor radian
  const capstan::SamplePeriod<double> period(0.001);
  capstan::MotionLaw<double> law(period, parameters);

  double worst_rad = 0.0;
  for (int i = 0; i < 5000; ++i) {
    const double motor_rad = 0.5 * std::sin(0.002 * i);
    capstan::Measured<double> now;
    now.q1 = motor_rad;
    const double joint_rad = law.update(now).q2;
    worst_rad = std::max(worst_rad, std::fabs(joint_rad / 1.08 - motor_rad));
  }
  std::printf("worst error of the inverse: %.2e rad\n", worst_rad);
  return worst_rad < 1e-12 ? 0 : 1;
}
