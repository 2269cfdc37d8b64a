// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/tests/firmware/support.hpp"

namespace capstan::test {

/// An application on the fake motor, without a shell.
struct ApplicationRig {
  explicit ApplicationRig(const FlashBanks& stored = {}) : banks(stored) { application.rt_tick(); }
  auto request(const Request& wanted) -> bool {
    const bool posted = application.post(wanted);
    application.rt_tick();
    return posted;
  }
  auto arm() -> bool {
    const bool posted = request({.kind = Request::Kind::kArm});
    ticks(1);  // taken over
    return posted;
  }
  auto move(double target_rad) -> bool {
    return request(
        {.kind = Request::Kind::kMove, .position_rad = Q24::from_double(target_rad), .speed_rad_s = Q24::from_int(2)});
  }
  void ticks(int count) {
    for (int i = 0; i < count; ++i) {
      application.rt_tick();
    }
  }
  /// Opens the emergency stop for a cycle.
  void touch_estop() {
    io.estop = true;
    ticks(1);
    io.estop = false;
  }
  [[nodiscard]] auto state() const -> State { return application.telemetry().state; }
  [[nodiscard]] auto fault() const -> Fault { return application.telemetry().first_fault; }

  FlashBanks banks;
  FakeIo<1> io;
  Application<FakeIo<1>> application{io, banks};
};

}  // namespace capstan::test
