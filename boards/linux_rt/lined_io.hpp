// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
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
    for (std::size_t i = 0; i < kAxes; ++i) {
      follows_[i] = sensed.axis[i].follows;
    }
    return status;
  }
  auto write(const Drive<kAxes>& drive) noexcept -> Status {
    // Drives need the enable line to get ready, and until all of them give torque the brake holds the joints.
    bool enabled = false;
    bool held = true;
    for (std::size_t i = 0; i < kAxes; ++i) {
      enabled |= drive.axis[i].enabled;
      held &= !drive.axis[i].enabled || follows_[i];
    }
    const bool lined = lines_.rt_drive(enabled, enabled && held);
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
  std::array<bool, kAxes> follows_{};  // of the last read
};

}  // namespace capstan
