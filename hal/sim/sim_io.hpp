// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "hal/joint_io.hpp"
#include "hal/sim/plant.hpp"

namespace capstan {

/// Joint I/O of the simulated plant, in lock-step: writing the drive advances the plant by one cycle.
class SimIo {
 public:
  static constexpr std::size_t kAxes = 1;

  /// @param plant  outlives this object
  explicit SimIo(sim::Plant& plant) : plant_(plant) {}

  auto read(Sensed<kAxes>& sensed) noexcept -> Status;
  /// kFailed once the plant has diverged; `failure` then says why.
  auto write(const Drive<kAxes>& drive) noexcept -> Status;
  void release() noexcept {}  // a plant that failed stands still, and without a write no current flows

  /// Empty while all is well.
  [[nodiscard]] auto failure() const -> const std::string& { return failure_; }

 private:
  sim::Plant& plant_;
  std::string failure_;
};
static_assert(JointIo<SimIo>);

}  // namespace capstan
