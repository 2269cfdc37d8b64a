// SPDX-License-Identifier: Apache-2.0
#include "hal/sim/sim_io.hpp"

#include <cmath>
#include <exception>

namespace capstan {

auto SimIo::read(Sensed<kAxes>& sensed) noexcept -> Status {
  const sim::Readings readings = plant_.readings();
  AxisSensed& axis = sensed.axis[0];
  axis.encoder_counts = readings.encoder_counts;
  axis.encoder = readings.encoder_ok ? Quality::kOk : Quality::kMissing;
  if (std::isfinite(readings.current_a)) {
    axis.current_a = Q24::from_double(readings.current_a);
    axis.current = readings.current_ok ? Quality::kOk : Quality::kMissing;
  } else {
    axis.current = Quality::kInvalid;
  }
  return Status::kOk;
}

auto SimIo::write(const Drive<kAxes>& drive) noexcept -> Status {
  if (!failure_.empty()) {
    return Status::kFailed;
  }
  try {
    plant_.step(drive.axis[0].current_a.to_double(), drive.axis[0].enabled);
    return Status::kOk;
  } catch (const std::exception& problem) {
    failure_ = problem.what();
    return Status::kFailed;
  }
}

}  // namespace capstan
