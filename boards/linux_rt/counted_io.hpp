// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hal/joint_io.hpp"

namespace capstan {

/// Joint I/O that also reports the real-time loop's missed edges, which the backend below cannot know.
template <JointIo Io>
class CountedIo {
 public:
  static constexpr std::size_t kAxes = Io::kAxes;

  /// @param io  outlives this object
  explicit CountedIo(Io& io) : io_(io) {}

  /// Since start; call it before the cycle reads.
  void rt_set_overruns(std::uint32_t overruns) { overruns_ = overruns; }

  auto read(Sensed<kAxes>& sensed) noexcept -> Status {
    const Status status = io_.read(sensed);
    sensed.overruns = overruns_;
    return status;
  }
  auto write(const Drive<kAxes>& drive) noexcept -> Status { return io_.write(drive); }
  void release() noexcept { io_.release(); }

 private:
  Io& io_;
  std::uint32_t overruns_ = 0;
};

}  // namespace capstan
