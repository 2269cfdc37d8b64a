// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "capstan/hal/sim/parameters.hpp"
#include "capstan/hal/sim/random.hpp"

namespace capstan::sim {

/// What the board's inputs hold after a step.
struct Readings {
  std::int32_t encoder_counts = 0;  ///< wraps at 32 bits
  double current_a = 0.0;
  bool encoder_ok = true;
  bool current_ok = true;
};

/// A value as it was `delay_s` ago, on the line between two steps. One call per ms; before the start it was 0.
class Late {
 public:
  explicit Late(double delay_s);
  [[nodiscard]] double sample(double value);

 private:
  double share_ = 0.0;           // of the older of two neighbours
  std::vector<double> history_;  // ring; empty: not late
  std::size_t newest_ = 0;
};

/// Incremental encoder on the input pulley: floor, 32-bit wrap, optional eccentricity and slip on the shaft.
class Encoder {
 public:
  explicit Encoder(const PlantParameters& parameters);
  [[nodiscard]] std::int32_t counts(double q1_rad, double time_s) const;

 private:
  Effects effects_;
  double counts_per_rad_;
  double start_counts_;
};

/// Shunt amplifier and ADC: offset, white noise, full scale, quantisation.
class CurrentSensor {
 public:
  CurrentSensor(const PlantParameters& parameters, std::uint64_t seed);
  [[nodiscard]] double sample(double current_a);

 private:
  double offset_a_, noise_a_, step_a_, full_scale_a_;
  Random random_;
};

/// Camera on the joint, one call per ms. Frames are held in between; exposure happens at the frame, delivery after the
/// delay.
class Camera {
 public:
  Camera(const PlantParameters& parameters, std::uint64_t seed);
  [[nodiscard]] double sample(double q2_rad);

 private:
  double noise_rad_;
  double frame_period_s_;
  double next_frame_s_ = 0.0;
  double clock_s_ = 0.0;
  double held_rad_ = 0.0;
  std::vector<double> late_;  // delay line in steps
  std::size_t cursor_ = 0;
  Random random_;
};

}  // namespace capstan::sim
