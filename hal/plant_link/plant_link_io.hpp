// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>

#include "capstan/hal/joint_io.hpp"
#include "capstan/hal/plant_link/frames.hpp"

namespace capstan::plant_link {

/// A serial line: every call returns at once.
template <typename T>
concept BytePort = requires(T port, std::uint8_t& byte, std::span<const std::uint8_t> bytes) {
  { port.read(byte) }
  noexcept->std::same_as<bool>;
  { port.write_free() }
  noexcept->std::same_as<std::size_t>;
  { port.write(bytes) }
  noexcept->std::same_as<std::size_t>;
};

/// Something that advances while read() waits: core cycles, or merely the number of looks. Differences modulo 2^32
/// count.
template <typename T>
concept WaitCounter = requires(const T& counter) {
  { counter.now() }
  noexcept->std::same_as<std::uint32_t>;
};

/// What the link has seen since start. Counters wrap.
struct LinkCounters {
  std::uint32_t answered = 0;  ///< cycles whose sensed frame came in time
  std::uint32_t missed = 0;    ///< cycles without one
  std::uint32_t stale = 0;     ///< whole frames with another cycle's sequence number: never used
  std::uint32_t damaged = 0;   ///< frames with a wrong length, tag, version or checksum
  std::uint32_t refused = 0;   ///< drive frames the line had no room for
};

/// Joint input and output over a serial line to a simulated plant, in lock-step: see frames.hpp. A value is either that
/// of this very cycle or missing.
///
/// The link is up from the first answer until kMissedBeforeDown cycles in a row had none. While it is up, read() waits
/// for the plant; while it is down it does not, so a board without a plant stays quick, and write() asks instead of
/// advancing the plant.
template <BytePort Port, WaitCounter Counter, std::size_t Axes>
class PlantLinkIo {
 public:
  static constexpr std::size_t kAxes = Axes;
  static constexpr std::uint32_t kMissedBeforeDown = 3;

  /// `patience` bounds the wait in read(), in counts of `counter`.
  PlantLinkIo(Port& port, const Counter& counter, std::uint32_t patience) noexcept
      : port_(port), counter_(counter), patience_(patience) {}

  /// Asks for the plant's first snapshot; the plant does not move for it.
  void start() noexcept { static_cast<void>(send(DriveKind::kQuery, {})); }

  [[nodiscard]] auto read(Sensed<Axes>& in) noexcept -> Status {
    in = {};
    in.overruns = overruns_;
    const std::uint32_t begin = counter_.now();
    do {
      if (drain()) {
        ++counters_.answered;
        silent_ = 0;
        up_ = true;
        in.axis = frame_.axis;
        in.estop = frame_.estop;
        return Status::kOk;
      }
    } while (up_ && counter_.now() - begin < patience_);
    ++counters_.missed;
    if (up_ && ++silent_ >= kMissedBeforeDown) {
      up_ = false;
      release();
    }
    return Status::kTimeout;
  }

  /// kFailed: an axis was to be driven, and there is no plant to drive or no room on the line.
  [[nodiscard]] auto write(const Drive<Axes>& out) noexcept -> Status {
    if (up_) {
      ++sequence_;
      return send(DriveKind::kStep, out);
    }
    bool wanted = false;
    for (const AxisDrive& axis : out.axis) {
      wanted = wanted || axis.enabled;
    }
    const Status asked = send(DriveKind::kQuery, {});
    return wanted ? Status::kFailed : asked;
  }

  void release() noexcept { static_cast<void>(send(DriveKind::kRelease, {})); }

  /// Cycles the board skipped or began late since start: handed on in every snapshot.
  void set_overruns(std::uint32_t overruns) noexcept { overruns_ = overruns; }
  [[nodiscard]] auto counters() const noexcept -> LinkCounters {
    LinkCounters result = counters_;
    result.damaged += reader_.damaged();
    return result;
  }
  [[nodiscard]] auto is_up() const noexcept -> bool { return up_; }

 private:
  /// Takes what has come in; true when this cycle's frame was among it. Bounded: the port's buffer is, and so is each
  /// call.
  [[nodiscard]] auto drain() noexcept -> bool {
    constexpr std::size_t kMost = 4 * (cobs_max_size(kSensedSize<Axes>) + 1);
    std::uint8_t byte = 0;
    for (std::size_t i = 0; i < kMost && port_.read(byte); ++i) {
      if (!reader_.take(byte)) {
        continue;
      }
      if (!decode(reader_.packet(), frame_)) {
        ++counters_.damaged;
        continue;
      }
      if (frame_.sequence == sequence_) {
        return true;
      }
      ++counters_.stale;
    }
    return false;
  }

  [[nodiscard]] auto send(DriveKind kind, const Drive<Axes>& drive) noexcept -> Status {
    const auto wire = encode(DriveFrame<Axes>{.sequence = sequence_, .kind = kind, .drive = drive});
    if (port_.write_free() < wire.size) {
      ++counters_.refused;  // half a frame would spoil the next one too
      return Status::kFailed;
    }
    return port_.write(wire.view()) == wire.size ? Status::kOk : Status::kFailed;
  }

  Port& port_;
  const Counter& counter_;
  std::uint32_t patience_;
  FrameReader<kSensedSize<Axes>> reader_;
  SensedFrame<Axes> frame_;
  LinkCounters counters_;
  std::uint32_t sequence_ = 0;
  std::uint32_t silent_ = 0;
  std::uint32_t overruns_ = 0;
  bool up_ = false;
};

}  // namespace capstan::plant_link
