// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "capstan/hal/joint_io.hpp"
#include "capstan/hal/plant_link/frames.hpp"

namespace capstan::plant_link {

/// The plant's end of the line: hands drive frames to a joint I/O whose write() advances it by one cycle, such as the
/// simulator's, and answers with what it then reads.
template <JointIo Io>
class PlantServer {
 public:
  static constexpr std::size_t kAxes = Io::kAxes;
  using Answer = Wire<kSensedSize<kAxes>>;

  explicit PlantServer(Io& io) noexcept : io_(io) {}

  /// Takes one byte from the board. True: `answer` is to be sent. A frame that asks for nothing, or a damaged one, has
  /// no answer: the board then sees a missing sensor.
  [[nodiscard]] auto take(std::uint8_t byte, Answer& answer) noexcept -> bool {
    DriveFrame<kAxes> frame;
    if (!reader_.take(byte) || !decode(reader_.packet(), frame)) {
      return false;
    }
    if (frame.kind == DriveKind::kRelease) {
      io_.release();
      return false;
    }
    if (frame.kind == DriveKind::kStep) {
      ++steps_;
      if (io_.write(frame.drive) != Status::kOk) {
        return false;
      }
    }
    Sensed<kAxes> sensed;
    if (io_.read(sensed) == Status::kFailed) {
      return false;
    }
    answer = encode(SensedFrame<kAxes>{.sequence = frame.sequence, .estop = sensed.estop, .axis = sensed.axis});
    return true;
  }

  /// Cycles the plant was asked to advance.
  [[nodiscard]] auto steps() const noexcept -> std::uint64_t { return steps_; }

 private:
  Io& io_;
  FrameReader<kDriveSize<kAxes>> reader_;
  std::uint64_t steps_ = 0;
};

}  // namespace capstan::plant_link
