// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <utility>

#include "capstan/hal/joint_io.hpp"

namespace capstan {

/// Joint I/O with what the board adds to any backend: the real-time loop's missed edges, which a backend cannot know,
/// and the lines for emergency stop, enable, brake and watchdog.
template <JointIo Io, typename Lines>
class LinedIo {
 public:
  static constexpr std::size_t kAxes = Io::kAxes;

  /// @param io  outlives this object
  LinedIo(Io& io, Lines lines) : io_(io), lines_(std::move(lines)) {}

  /// Since start; call it before the cycle reads.
  void rt_set_overruns(std::uint32_t overruns) { overruns_ = overruns; }

  auto read(Sensed<kAxes>& sensed) noexcept -> Status {
    const Status status = io_.read(sensed);
    sensed.overruns = overruns_;
    sensed.estop |= lines_.rt_estop();
    return status;
  }
  auto write(const Drive<kAxes>& drive) noexcept -> Status {
    const bool energised =
        std::any_of(drive.axis.begin(), drive.axis.end(), [](const AxisDrive& axis) { return axis.enabled; });
    const bool lined = lines_.rt_drive(energised);
    const Status status = io_.write(drive);
    return lined ? status : Status::kFailed;
  }
  void release() noexcept {
    lines_.rt_off();
    io_.release();
  }

  [[nodiscard]] auto lines() const -> const Lines& { return lines_; }

 private:
  Io& io_;
  Lines lines_;
  std::uint32_t overruns_ = 0;
};

}  // namespace capstan
