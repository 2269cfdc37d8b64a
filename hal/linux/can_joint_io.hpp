// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <memory>
#include <vector>

#include "capstan/hal/linux/can_bus.hpp"

namespace capstan {

/// Joint I/O of CiA 402 drives on one or two buses: axes in the order of the buses and of the drives on each.
template <std::size_t Axes>
class CanJointIo {
 public:
  static constexpr std::size_t kAxes = Axes;
  using Buses = std::vector<std::unique_ptr<CanBus>>;

  /// @param buses  with `Axes` drives in all
  explicit CanJointIo(Buses buses) : buses_(std::move(buses)) {}

  /// kTimeout: a drive's values are missing or doubtful, and marked so.
  auto read(Sensed<Axes>& sensed) noexcept -> Status {
    std::span<AxisSensed> axes = sensed.axis;
    for (const auto& bus : buses_) {
      bus->rt_receive(axes.first(bus->master().drives()));
      axes = axes.subspan(bus->master().drives());
    }
    const bool complete = std::all_of(sensed.axis.begin(), sensed.axis.end(), [](const AxisSensed& axis) {
      return axis.encoder == Quality::kOk && axis.current == Quality::kOk;
    });
    return complete ? Status::kOk : Status::kTimeout;
  }

  /// kFailed: a drive or a bus is not sound; in this same call the voltage was taken from all that can be reached.
  auto write(const Drive<Axes>& drive) noexcept -> Status {
    std::span<const AxisDrive> axes = drive.axis;
    bool sound = true;
    for (const auto& bus : buses_) {
      bus->rt_decide(axes.first(bus->master().drives()));
      axes = axes.subspan(bus->master().drives());
      sound &= bus->rt_sound();
    }
    bool sent = true;
    for (const auto& bus : buses_) {
      sent &= bus->rt_send(sound);
    }
    quiet_ = sent && !sound;
    return sent && sound ? Status::kOk : Status::kFailed;
  }

  void release() noexcept {
    if (quiet_) {
      return;  // the last write has done it; a second SYNC in a cycle would bring a second answer
    }
    quiet_ = true;
    for (const auto& bus : buses_) {
      quiet_ &= bus->rt_send(false);
    }
  }

  [[nodiscard]] auto buses() const -> const Buses& { return buses_; }

 private:
  Buses buses_;
  bool quiet_ = false;
};
static_assert(JointIo<CanJointIo<1>>);
static_assert(JointIo<CanJointIo<4>>);

}  // namespace capstan
