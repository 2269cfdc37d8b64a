// SPDX-License-Identifier: Apache-2.0
// The firmware's whole cycle against simulated drives over a local bus, in lock-step: time here is a number.
#include "hal/linux/can_joint_io.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <functional>
#include <sstream>
#include <thread>

#include "firmware/application.hpp"
#include "hal/cia402_sim/drive_bus.hpp"
#include "tests/firmware/support.hpp"

namespace {
std::atomic<std::uint64_t> time_ms = 1000;
}

namespace capstan {
namespace {

using cia402::Anomaly;
using cia402::Received;
using cia402::Time;

auto test_clock() -> Time {
  return std::chrono::milliseconds(time_ms.load());
}

/// Two drives, set up; the firmware on one end of the bus, they on the other.
class Rig {
 public:
  explicit Rig(const std::vector<std::string>& incidents = {}, cia402::PdoLayout layout = cia402::PdoLayout::kSeparate)
      : Rig(CanSocket::pair(test_clock), incidents, layout) {}

  void cycle(const std::function<void()>& before_firmware = {}) {
    ++time_ms;
    send(drives_.tick(test_clock()));
    if (before_firmware) {
      before_firmware();
    }
    application_.rt_tick();
    serve();
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
  auto application() -> Application<CanJointIo<2>>& { return application_; }

 private:
  Rig(std::pair<CanSocket, CanSocket> ends, const std::vector<std::string>& incidents, cia402::PdoLayout layout)
      : far_(std::move(ends.second)),
        drives_(kNodes, parsed(incidents), record_),
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
    const CanSetup setup{.buses = {{"local", {1, 2}}}, .layout = layout};
    buses.push_back(std::make_unique<CanBus>(std::move(near), setup.buses[0], setup));
    done = true;
    others.join();
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
  CanSocket far_;
  drive_sim::DriveBus drives_;
  CanBus* bus_ = nullptr;
  CanJointIo<2> io_;
  test::FlashBanks banks_;
  Application<CanJointIo<2>> application_{io_, banks_};
};

TEST(CanJointIo, MovesAJointAndTheOtherStands) {
  Rig rig;
  rig.arm();
  rig.application().post({.kind = Request::Kind::kMove,
                          .axis = 0,
                          .position_rad = Q24::from_double(0.4),
                          .speed_rad_s = Q24::from_int(1)});
  rig.cycles(1500);
  EXPECT_EQ(rig.state(), State::kHolding);
  EXPECT_NEAR(rig.drive(0).truth().q1_rad, rig.application().axis_telemetry(0).q1_rad.to_double(), 2e-3)
      << "what the firmware sees is where the motor is";
  EXPECT_NEAR(rig.drive(0).truth().q2_rad, 0.4, 0.1);
  EXPECT_NEAR(rig.drive(1).truth().q2_rad, 0.0, 0.02);
  for (std::size_t i = 0; i < cia402::kAnomalies; ++i) {
    EXPECT_EQ(rig.count(static_cast<Anomaly>(i)), 0U) << cia402::info(static_cast<Anomaly>(i)).name;
  }
}

TEST(CanJointIo, PackedSetValuesMoveTheRightJointToo) {
  Rig rig({}, cia402::PdoLayout::kPacked);
  rig.arm();
  rig.application().post({.kind = Request::Kind::kMove,
                          .axis = 1,
                          .position_rad = Q24::from_double(-0.3),
                          .speed_rad_s = Q24::from_int(1)});
  rig.cycles(1500);
  EXPECT_EQ(rig.state(), State::kHolding);
  EXPECT_NEAR(rig.drive(1).truth().q2_rad, -0.3, 0.1);
  EXPECT_NEAR(rig.drive(0).truth().q2_rad, 0.0, 0.02);
}

TEST(CanJointIo, DisarmingTakesTheTorqueWithinTwoCycles) {
  Rig rig;
  rig.arm();
  rig.disarm();
  rig.cycles(2);
  EXPECT_FALSE(rig.drive(0).enabled());
  EXPECT_FALSE(rig.drive(1).enabled());
}

struct Case {
  const char* incident;
  std::vector<Fault> faults;
  Anomaly anomaly;
};

/// Every incident ends with both drives without torque, in the cycle after it is seen, and is counted.
class Incidents : public testing::TestWithParam<Case> {};

TEST_P(Incidents, EndWithoutTorqueOnAnyDrive) {
  Rig rig({std::string("0.1:") + GetParam().incident});
  rig.arm();
  int cycles = 0;
  while (rig.state() != State::kFaulted && cycles < 400) {
    rig.cycle();
    ++cycles;
  }
  ASSERT_EQ(rig.state(), State::kFaulted);
  rig.cycle();
  EXPECT_FALSE(rig.drive(0).enabled() && std::string(GetParam().incident) != "silence:1");
  EXPECT_FALSE(rig.drive(1).enabled()) << "one cycle after the fault the sound one is off too";
  EXPECT_NE(std::find(GetParam().faults.begin(), GetParam().faults.end(), rig.fault()), GetParam().faults.end())
      << info(rig.fault()).name;
  EXPECT_GT(rig.count(GetParam().anomaly), 0U);
}

INSTANTIATE_TEST_SUITE_P(
    All, Incidents,
    testing::Values(Case{"silence:1", {Fault::kSensorMissing}, Anomaly::kStatusMissing},
                    Case{"no-heartbeat:1", {Fault::kDriveFailed}, Anomaly::kHeartbeatLost},
                    Case{"short-status:1", {Fault::kSensorMissing}, Anomaly::kStatusLength},
                    Case{"double-status:1", {Fault::kSensorInvalid}, Anomaly::kStatusContradicts},
                    Case{"bad-status:1", {Fault::kDriveFailed}, Anomaly::kStatusUnknown},
                    Case{"fault:1", {Fault::kDriveFailed}, Anomaly::kEmergency},
                    Case{"restart:1", {Fault::kDriveFailed, Fault::kSensorMissing}, Anomaly::kRestarted},
                    Case{"short-heartbeat:1", {Fault::kDriveFailed}, Anomaly::kHeartbeatLength},
                    Case{"bad-heartbeat:1", {Fault::kDriveFailed}, Anomaly::kHeartbeatState},
                    Case{"foreign-sync:1",
                         {Fault::kDriveFailed, Fault::kSensorInvalid, Fault::kSensorMissing},
                         Anomaly::kForeignSync},
                    Case{"flood:1", {Fault::kSensorInvalid}, Anomaly::kStatusContradicts}),
    [](const testing::TestParamInfo<Case>& test) {
      std::string name = test.param.incident;
      std::replace_if(
          name.begin(), name.end(), [](char c) { return c == '-' || c == ':'; }, '_');
      return name;
    });

TEST(CanJointIo, ADriveInFaultIsResetAndCanBeArmedAgainOneThatRestartedCanNot) {
  for (const auto& [incident, again] : {std::pair{"0.1:fault:1", true}, {"0.1:restart:1", false}}) {
    Rig rig({incident});
    rig.arm();
    rig.cycles(200);
    ASSERT_EQ(rig.state(), State::kFaulted);
    rig.disarm();
    rig.cycles(600);
    rig.application().post({.kind = Request::Kind::kArm});
    rig.cycles(20);
    EXPECT_EQ(rig.state() == State::kHolding, again) << incident;
    EXPECT_EQ(rig.drive(0).enabled(), again) << incident;
  }
}

TEST(CanJointIo, WhatWaitedInTheSocketIsNotReplayed) {
  Rig rig;
  rig.arm();
  // The program stands still for 50 ms; what the drives said meanwhile is of the past.
  const cia402::Frame old{.id = 0x181, .size = 8, .data = {0x37, 0x12, 0xFF, 0xFF, 0xFF, 0x7F}};
  rig.cycle([&] { rig.send(std::vector<cia402::Frame>(50, old)); });
  EXPECT_EQ(rig.state(), State::kFaulted);
  EXPECT_EQ(rig.fault(), Fault::kSensorInvalid);
  EXPECT_EQ(rig.count(Anomaly::kFlood), 1U);
  EXPECT_LT(std::abs(rig.application().axis_telemetry(0).q1_rad.to_double()), 0.1) << "it never became a position";
}

TEST(CanJointIo, ABusThatIsGoneIsAFailedDrive) {
  Rig rig;
  rig.arm();
  rig.hang_up();
  ++time_ms;
  rig.application().rt_tick();
  rig.application().rt_tick();
  EXPECT_EQ(rig.state(), State::kFaulted);
  EXPECT_EQ(rig.count(Anomaly::kLinkDown), 1U);
}

}  // namespace
}  // namespace capstan
