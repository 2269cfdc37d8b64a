// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <atomic>
#include <functional>
#include <sstream>
#include <thread>

#include "capstan/firmware/loop/application.hpp"
#include "capstan/hal/cia402_sim/drive_bus.hpp"
#include "capstan/hal/linux/can_joint_io.hpp"
#include "capstan/tests/firmware/support.hpp"

namespace capstan::test {

inline std::atomic<std::uint64_t> time_ms = 1000;

using cia402::Anomaly;
using cia402::Received;
using cia402::Time;

inline auto test_clock() -> Time {
  return std::chrono::milliseconds(time_ms.load());
}

/// Two drives, set up; the firmware on one end of the bus, they on the other, in lock-step: time here is a number.
class CanRig {
 public:
  using Peculiar = std::map<std::uint8_t, drive_sim::Peculiarities>;  // of a node

  explicit CanRig(const std::vector<std::string>& incidents = {},
                  cia402::PdoLayout layout = cia402::PdoLayout::kSeparate, const Peculiar& peculiar = {})
      : CanRig(CanSocket::pair(test_clock), incidents, layout, peculiar) {}

  /// @param before  called before the firmware's tick  @param around  calls the tick it is given
  void cycle(const std::function<void()>& before = {},
             const std::function<void(const std::function<void()>&)>& around = {}) {
    ++time_ms;
    send(drives_.tick(test_clock()));
    if (before) {
      before();
    }
    const std::function<void()> tick = [this] { application_.rt_tick(); };
    around ? around(tick) : tick();
    serve();
  }
  /// A millisecond in which the firmware does not run.
  void silent_cycle() {
    ++time_ms;
    send(drives_.tick(test_clock()));
  }
  void cycles(int count) {
    for (int i = 0; i < count; ++i) {
      cycle();
    }
  }
  void arm() {
    cycles(3);
    application_.post({.kind = Request::Kind::kArm});
    cycles(20);
    ASSERT_EQ(state(), State::kHolding) << info(fault()).name;
    ASSERT_TRUE(drive(0).enabled());
    ASSERT_TRUE(drive(1).enabled());
  }
  void disarm() { application_.post({.kind = Request::Kind::kDisarm}); }
  void send(const std::vector<cia402::Frame>& frames) {
    for (const cia402::Frame& frame : frames) {
      EXPECT_FALSE(far_.rt_send(frame));
    }
  }
  void hang_up() { far_ = CanSocket::pair(test_clock).first; }
  [[nodiscard]] auto state() const -> State { return application_.telemetry().state; }
  [[nodiscard]] auto fault() const -> Fault { return application_.telemetry().first_fault; }
  [[nodiscard]] auto count(Anomaly anomaly) const -> std::uint32_t { return bus_->journal().count(anomaly); }
  auto drive(std::size_t i) -> drive_sim::SimulatedDrive& { return drives_.drives()[i]; }
  auto io() -> CanJointIo<2>& { return io_; }
  /// What the set-up found.
  [[nodiscard]] auto said() const -> std::string { return said_.str(); }
  auto application() -> Application<CanJointIo<2>>& { return application_; }

 private:
  CanRig(std::pair<CanSocket, CanSocket> ends, const std::vector<std::string>& incidents, cia402::PdoLayout layout,
         const Peculiar& peculiar)
      : far_(std::move(ends.second)),
        drives_(kNodes, parsed(incidents), record_, peculiar),
        io_(set_up(std::move(ends.first), layout)) {}

  static auto parsed(const std::vector<std::string>& incidents) -> std::vector<drive_sim::Incident> {
    std::vector<drive_sim::Incident> list;
    for (const std::string& text : incidents) {
      list.push_back(drive_sim::parse_incident(text));
    }
    return list;
  }
  auto set_up(CanSocket near, cia402::PdoLayout layout) -> CanJointIo<2>::Buses {
    std::atomic<bool> done = false;
    std::thread others([&] {
      while (!done) {
        ++time_ms;
        send(drives_.tick(test_clock()));
        far_.wait(std::chrono::milliseconds(1));
        serve();
      }
    });
    CanJointIo<2>::Buses buses;
    const CanSetup setup{.buses = {{"unix:local", {1, 2}}}, .layout = layout};
    std::string problem;
    try {
      buses.push_back(std::make_unique<CanBus>(std::move(near), setup.buses[0], setup, said_));
    } catch (const std::runtime_error& refusal) {
      problem = refusal.what();
    }
    done = true;
    others.join();
    if (!problem.empty()) {
      throw std::runtime_error(problem);
    }
    bus_ = buses[0].get();
    return buses;
  }
  void serve() {
    for (Received received; far_.rt_receive(received);) {
      if (received.kind == Received::Kind::kFrame) {
        send(drives_.receive(received.frame, test_clock()));
      }
    }
  }

  static constexpr std::array<std::uint8_t, 2> kNodes = {1, 2};
  std::ostringstream record_;
  std::ostringstream said_;
  CanSocket far_;
  drive_sim::DriveBus drives_;
  CanBus* bus_ = nullptr;
  CanJointIo<2> io_;
  FlashBanks banks_;
  Application<CanJointIo<2>> application_{io_, banks_};
};

}  // namespace capstan::test
