// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "capstan/tests/firmware/support.hpp"

namespace capstan::test {

/// The cycle alone, on the fake motor. What the sensors say may be changed on the way.
template <std::size_t Axes = 1>
struct CycleRig {
  using Disturbance = std::function<void(Sensed<Axes>&)>;

  explicit CycleRig(const Config<Axes>& config = {}) : state(config) { tick(); }

  auto tick(const Command<Axes>& command = {}) -> const Drive<Axes>& {
    static_cast<void>(io.read(sensed));
    if (disturb) {
      disturb(sensed);
    }
    drive = cycle(state, sensed, command);
    static_cast<void>(io.write(drive));
    return drive;
  }
  void ticks(int count, const Command<Axes>& command = {}) {
    for (int i = 0; i < count; ++i) {
      tick(command);
    }
  }
  void arm() {
    tick({.arm = true});
    tick();  // taken over
  }
  void move(double target_rad, double speed_rad_s = 2.0) {
    Command<Axes> command;
    command.axis[0] = {.kind = Request::Kind::kMove,
                       .position_rad = Q24::from_double(target_rad),
                       .speed_rad_s = Q24::from_double(speed_rad_s)};
    tick(command);
  }
  void follow(double reference_rad) {
    Command<Axes> command;
    command.axis[0] = {.kind = Request::Kind::kFollow, .position_rad = Q24::from_double(reference_rad)};
    tick(command);
  }
  [[nodiscard]] auto now() const -> State { return state.telemetry.state; }
  [[nodiscard]] auto has(Fault fault) const -> bool { return (state.telemetry.conditions & bit(fault)) != 0; }
  [[nodiscard]] auto torque_off() const -> bool {
    return std::all_of(drive.axis.begin(), drive.axis.end(),
                       [](const AxisDrive& axis) { return !axis.enabled && axis.current_a == Q24{}; });
  }
  [[nodiscard]] auto joint(std::size_t axis = 0) const -> const AxisTelemetry& { return state.axis[axis].telemetry(); }

  FakeIo<Axes> io;
  CycleState<Axes> state;
  Sensed<Axes> sensed{};
  Drive<Axes> drive{};
  Disturbance disturb;
};

}  // namespace capstan::test
