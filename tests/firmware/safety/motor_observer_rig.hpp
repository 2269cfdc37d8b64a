// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <cmath>

#include "capstan/firmware/safety/motor_observer.hpp"

namespace capstan::observer_rig {

// A motor of 0.02 g m2 with 0.1 Nm/A and 40960 counts a turn, whose friction holds 3 mNm.
inline auto commissioned_config() -> AxisConfig {
  AxisConfig config;
  config.observer = {.inertia_gm2 = Q24::from_double(0.02),
                     .coulomb_nm = Q24::from_double(0.003),
                     .against_nm = Q24::from_double(0.01),
                     .noise_a = Q24::from_double(0.003)};
  return config;
}

/// The observer fed with counts and currents as they come.
struct Rig {
  explicit Rig(const AxisConfig& config = commissioned_config()) : observer(config) {
    observer.rt_arm();
    while (observer.rt_look() != Q24{}) {  // over
    }
    MotorState motor;
    motor.counts = counts;
    static_cast<void>(observer.rt_step(motor, Q24{}, false));  // before there was torque
    step(0, 0.0);
  }
  /// @param measured_a  unless given what was wanted
  auto step(int moved, double wanted_a, double measured_a = NAN) -> FaultSet {
    counts += moved;
    MotorState motor;
    motor.counts = counts;
    motor.current_a = Q24::from_double(std::isnan(measured_a) ? wanted_a : measured_a);
    return observer.rt_step(motor, Q24::from_double(wanted_a), true);
  }
  auto steps(int cycles, int moved, double wanted_a) -> FaultSet {
    FaultSet faults = 0;
    for (int i = 0; i < cycles; ++i) {
      faults |= step(moved, wanted_a);
    }
    return faults;
  }
  /// As a motor does whose torque rises no more: by a count a cycle.
  auto slow_down(int from, int to, double wanted_a) -> FaultSet {
    FaultSet faults = 0;
    for (int v = from - 1; v > to; --v) {
      faults |= step(v, wanted_a);
    }
    return faults;
  }
  /// Gets to a steady speed with little torque, so that the envelope of the torque is narrow again.
  void run_at(int counts_per_cycle) {
    for (int v = 0; v <= counts_per_cycle; ++v) {
      static_cast<void>(step(v, 0.05));
    }
    EXPECT_EQ(steps(200, counts_per_cycle, 0.05), 0U);
  }
  MotorObserver observer;
  std::int64_t counts = 1000;
};

}  // namespace capstan::observer_rig
