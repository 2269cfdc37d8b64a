// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "capstan/hal/sim/plant.hpp"

namespace capstan::sim::test {

/// The micro-forceps with sensors that show what is there.
inline PlantParameters quiet() {
  PlantParameters p;
  p.camera_noise_rad = 0.0;
  p.current_noise_a = 0.0;
  p.current_offset_a = 0.0;
  p.current_adc_step_a = 0.0;
  p.tip_force_noise_n = 0.0;
  p.thermometer_noise_k = 0.0;
  return p;
}

/// An instrument whose input pulley is turned by hand.
class Bench {
 public:
  explicit Bench(const PlantParameters& parameters) : plant_(parameters, 1) {}

  /// On to `target` in steps of 0.2 mrad; returns the truth of each.
  std::vector<Truth> go(double target) {
    const double start = at_;
    const int steps = std::max(1, static_cast<int>(std::lround(std::fabs(target - start) / 2.0e-4)));
    std::vector<Truth> record;
    for (int i = 1; i <= steps; ++i) {
      at_ = start + (target - start) * static_cast<double>(i) / static_cast<double>(steps);
      plant_.step_kinematic(at_);
      record.push_back(plant_.truth());
    }
    return record;
  }

  [[nodiscard]] const Plant& plant() const { return plant_; }

 private:
  Plant plant_;
  double at_ = 0.0;
};

}  // namespace capstan::sim::test
