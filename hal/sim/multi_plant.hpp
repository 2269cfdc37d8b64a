// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "capstan/hal/sim/coupled_drivetrain.hpp"
#include "capstan/hal/sim/plant.hpp"
#include "capstan/hal/sim/scenario.hpp"

namespace capstan::sim {

/// An instrument of several axes, coupled as CoupledDrivetrain says; each has amplifier, sensors, faults and effects of
/// its own, as a Plant has. Advances in steps of 1 ms, bit-reproducible for a seed.
class MultiPlant {
 public:
  /// Throws std::invalid_argument on impossible parameters, no axes, or axes that disagree about the sub-steps.
  MultiPlant(const std::vector<InstrumentAxis>& axes, std::uint64_t seed);

  /// The scenario's axes, seed and faults.
  explicit MultiPlant(const Scenario& scenario);

  /// One millisecond; one command per axis. Throws std::runtime_error as Plant::step does, std::invalid_argument if
  /// their number is wrong.
  void step(std::span<const MotorCommand> commands);

  /// One millisecond with the input pulleys moved by hand.
  void step_kinematic(std::span<const double> q1_rad);

  [[nodiscard]] std::size_t axis_count() const { return peripheries_.size(); }
  [[nodiscard]] const Readings& readings(std::size_t axis) const { return peripheries_[axis].readings(); }
  [[nodiscard]] const Truth& truth(std::size_t axis) const { return peripheries_[axis].truth(); }
  [[nodiscard]] const PlantParameters& parameters(std::size_t axis) const { return peripheries_[axis].parameters(); }
  [[nodiscard]] const CoupledDrivetrain& drivetrain() const { return drivetrain_; }

  /// Adds a fault to its axis' schedule. Throws std::invalid_argument if there is no such axis or as
  /// FaultSchedule::add does. What all share, the bus and the supply, fails on the axis named only.
  void schedule(const Fault& fault);

 private:
  void begin(std::span<const MotorCommand> commands);
  void observe();

  std::vector<Periphery> peripheries_;
  CoupledDrivetrain drivetrain_;
  Divergence divergence_;
  std::vector<Loads> loads_;
  std::vector<double> targets_, starts_;
};

}  // namespace capstan::sim
