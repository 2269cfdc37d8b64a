// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <complex>
#include <functional>
#include <numbers>
#include <random>

#include "capstan/tools/response/response.hpp"

namespace capstan::tools::test {

/// A discrete motor in a discrete loop, whose response is known in closed form: two poles, a delay, and proportional
/// feedback with a filtered rate. Nothing of it is the product's.
struct KnownLoop {
  double pole1 = 0.999, pole2 = 0.985;    // a slow one and a viscous one
  double gain = 2e-4;                     // rad per Nm and ms^2
  int delay = 2;                          // rows
  double stiffness = 0.5, damping = 3.0;  // feedback of the angle, and of its difference per row
  double noise_nm = 0.0;                  // load, white
  double sensor_rad = 0.0;                // encoder, white
  double cubic = 0.0, square = 0.0;       // of the torque, relative at 10 mNm

  [[nodiscard]] auto plant(double hz) const -> Complex {
    const Complex back = std::polar(1.0, -2e-3 * std::numbers::pi * hz);
    return gain * std::pow(back, delay) / ((1.0 - pole1 * back) * (1.0 - pole2 * back));
  }
  [[nodiscard]] auto loop(double hz) const -> Complex {
    const Complex back = std::polar(1.0, -2e-3 * std::numbers::pi * hz);
    return plant(hz) * (stiffness + damping * (1.0 - back));
  }

  /// What the board would log. `shaken`: N m at row i.
  [[nodiscard]] auto run(const std::function<double(long)>& shaken, long rows, unsigned seed) const -> ResponseLog {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    ResponseLog log{.name = "known"};
    for (Eigen::VectorXd* column :
         {&log.time_s, &log.q1_rad, &log.torque_nm, &log.q2_rad, &log.reference_rad, &log.excitation_nm}) {
      column->setZero(rows);
    }
    double angle = 0.0;
    double angle1 = 0.0;
    double seen1 = 0.0;
    std::vector<double> past(static_cast<std::size_t>(delay), 0.0);  // torques on their way
    for (long i = 0; i < rows; ++i) {
      const double seen = angle + sensor_rad * normal(random);
      const double torque = shaken(i) - stiffness * seen - damping * (seen - seen1);
      seen1 = seen;
      log.time_s[i] = 1e-3 * static_cast<double>(i);
      log.q1_rad[i] = seen;
      log.q2_rad[i] = 1.1 * seen;
      log.torque_nm[i] = torque;
      log.excitation_nm[i] = shaken(i);
      const double x = torque / 0.01;
      past.push_back(torque + 0.01 * (cubic * x * x * x + square * x * x) + noise_nm * normal(random));
      const double next =
          (pole1 + pole2) * angle - pole1 * pole2 * angle1 + gain * past[past.size() - static_cast<std::size_t>(delay)];
      angle1 = angle;
      angle = next;
    }
    return log;
  }
};

/// Odd lines of 2048 ms with random phases; every fourth odd one and all even ones stay empty.
inline auto random_multisine(unsigned seed, double peak, long rows) -> std::function<double(long)> {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> turn(0.0, 2.0 * std::numbers::pi);
  std::vector<double> period(2048, 0.0);
  for (int h : {3, 7, 9, 15, 23, 31, 41, 55, 71, 95, 127, 167, 223, 297, 399}) {
    const double phase = turn(random);
    for (std::size_t i = 0; i < period.size(); ++i) {
      period[i] += std::cos(2.0 * std::numbers::pi * h * static_cast<double>(i) / 2048.0 + phase);
    }
  }
  double most = 0.0;
  for (const double value : period) {
    most = std::max(most, std::fabs(value));
  }
  return [period, most, peak, rows](long i) {
    const double ramp = std::min({1.0, static_cast<double>(i) / 256.0, static_cast<double>(rows - 1 - i) / 256.0});
    return ramp * peak / most * period[static_cast<std::size_t>(i % 2048)];
  };
}

}  // namespace capstan::tools::test
