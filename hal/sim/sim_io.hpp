// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <exception>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>

#include "capstan/hal/joint_io.hpp"
#include "capstan/hal/sim/plant.hpp"

namespace capstan {

namespace sim {
class MultiPlant;
}

/// What the firmware sees of a plant's readings.
[[nodiscard]] inline auto sensed_of(const sim::Readings& readings) -> AxisSensed {
  AxisSensed axis;
  axis.encoder_counts = readings.encoder_counts;
  axis.encoder = readings.encoder_ok ? Quality::kOk : Quality::kMissing;
  if (std::isfinite(readings.current_a)) {
    axis.current_a = Q24::from_double(readings.current_a);
    axis.current = readings.current_ok ? Quality::kOk : Quality::kMissing;
  } else {
    axis.current = Quality::kInvalid;
  }
  return axis;
}

/// Joint I/O of a simulated plant, in lock-step: writing the drive advances the plant by one cycle. A board may have
/// more axes than the instrument: their sensors are missing.
template <std::size_t Axes, class PlantType>
class PlantIo {
 public:
  static constexpr std::size_t kAxes = Axes;
  using Commands = std::array<sim::MotorCommand, Axes>;

  /// @param plant  outlives this object. Throws std::invalid_argument if it has more axes than the board.
  explicit PlantIo(PlantType& plant) : plant_(plant) {
    if (plant.axis_count() > Axes)
      throw std::invalid_argument("the instrument has more axes than the board; choose another instrument");
  }

  auto read(Sensed<Axes>& sensed) noexcept -> Status {
    for (std::size_t i = 0; i < Axes; ++i) {
      sensed.axis[i] = i < plant_.axis_count() ? sensed_of(plant_.readings(i)) : AxisSensed{};
      if (i < plant_.axis_count())
        read_rare(i, sensed);
    }
    return Status::kOk;
  }

  /// kFailed once the plant has diverged; `failure` then says why.
  auto write(const Drive<Axes>& drive) noexcept -> Status {
    if (!failure_.empty())
      return Status::kFailed;
    try {
      Commands commands;
      for (std::size_t i = 0; i < Axes; ++i)
        commands[i] = {drive.axis[i].current_a.to_double(), drive.axis[i].enabled};
      plant_.step(std::span<const sim::MotorCommand>(bench_.value_or(commands)).first(plant_.axis_count()));
      return Status::kOk;
    } catch (const std::exception& problem) {
      failure_ = problem.what();
      return Status::kFailed;
    }
  }

  void release() noexcept {}  // a plant that failed stands still, and without a write no current flows

  /// The motors hang on supplies of the bench that give these currents from now on, and the board only watches.
  void put_on_bench(const Commands& commands) { bench_ = commands; }
  void take_off_bench() { bench_.reset(); }

  /// Empty while all is well.
  [[nodiscard]] auto failure() const -> const std::string& { return failure_; }

 private:
  /// What not every instrument has: a thermometer, a joint sensor.
  void read_rare(std::size_t axis, Sensed<Axes>& sensed) noexcept {
    const sim::PlantParameters& parameters = plant_.parameters(axis);
    const sim::Truth& truth = plant_.truth(axis);
    if (parameters.warming_k > 0.0) {
      sensed.temperature_c = Q24::from_double(truth.temperature_c);
      sensed.temperature = Quality::kOk;
    }
    if (parameters.joint_sensor > 0.5 && std::isfinite(truth.q2_camera_rad)) {
      sensed.axis[axis].joint_rad = Q24::from_double(truth.q2_camera_rad);
      sensed.axis[axis].joint = Quality::kOk;
    }
  }

  PlantType& plant_;
  std::optional<Commands> bench_;
  std::string failure_;
};

using SimIo = PlantIo<1, sim::Plant>;
template <std::size_t Axes>
using MultiSimIo = PlantIo<Axes, sim::MultiPlant>;
static_assert(JointIo<SimIo>);
static_assert(JointIo<MultiSimIo<1>>);
static_assert(JointIo<MultiSimIo<4>>);

}  // namespace capstan
