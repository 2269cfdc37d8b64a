// SPDX-License-Identifier: Apache-2.0
#include "capstan/hal/cia402_sim/simulated_drive.hpp"

#include <gtest/gtest.h>

#include "capstan/tests/hal/cia402/support.hpp"

namespace capstan::drive_sim {
namespace {

using cia402::frame;
using cia402::ms;

// The simulator, too, is held against messages written by hand, so that both ends can not be wrong alike.
struct Rig {
  SimulatedDrive drive{2, sim::PlantParameters{}, 1};
  Time now = ms(10);
  std::vector<Frame> out;

  auto send(const Frame& message) -> std::vector<Frame> {
    out.clear();
    drive.receive(message, now, out);
    return out;
  }
  auto tick(std::int64_t after = 1) -> std::vector<Frame> {
    now += ms(after);
    out.clear();
    drive.tick(now, out);
    return out;
  }
  void configure(bool safe) {
    static_cast<void>(tick());
    const auto write = [this](std::initializer_list<int> bytes) {
      EXPECT_EQ(send(frame(0x602, bytes)).at(0).data[0], 0x60);
    };
    if (safe) {
      write({0x2B, 0x07, 0x60, 0x00, 0x01, 0x00, 0x00, 0x00});  // 6007 = fault
    }
    write({0x23, 0x16, 0x10, 0x01, 0x64, 0x00, 0x7F, 0x00});  // node 127 within 100 ms
    write({0x2B, 0x17, 0x10, 0x00, 0x32, 0x00, 0x00, 0x00});  // heartbeat every 50 ms
    write({0x2F, 0x60, 0x60, 0x00, 0x0A, 0x00, 0x00, 0x00});
    write({0x23, 0x00, 0x16, 0x01, 0x10, 0x00, 0x40, 0x60});  // controlword
    write({0x23, 0x00, 0x16, 0x02, 0x10, 0x00, 0x71, 0x60});  // torque
    write({0x2F, 0x00, 0x16, 0x00, 0x02, 0x00, 0x00, 0x00});
    write({0x2F, 0x00, 0x14, 0x02, 0x01, 0x00, 0x00, 0x00});
    write({0x23, 0x00, 0x14, 0x01, 0x02, 0x02, 0x00, 0x00});
    write({0x23, 0x00, 0x1A, 0x01, 0x10, 0x00, 0x41, 0x60});  // statusword
    write({0x2F, 0x00, 0x1A, 0x00, 0x01, 0x00, 0x00, 0x00});
    write({0x2F, 0x00, 0x18, 0x02, 0x01, 0x00, 0x00, 0x00});
    write({0x23, 0x00, 0x18, 0x01, 0x82, 0x01, 0x00, 0x40});
    static_cast<void>(send(frame(0x000, {1, 2})));
  }
  /// Controlword and torque, then SYNC. @returns the statusword that SYNC brings
  auto cycle(int controlword, int torque = 0) -> int {
    static_cast<void>(send(frame(0x202, {controlword, 0, torque & 0xFF, torque >> 8 & 0xFF})));
    const std::vector<Frame> status = send(frame(0x080, {}));
    return status.size() == 1 && status[0].id == 0x182 ? status[0].data[0] | status[0].data[1] << 8 : -1;
  }
  void enable() {
    EXPECT_EQ(cycle(0x06) & 0x6F, 0x21);
    EXPECT_EQ(cycle(0x07) & 0x6F, 0x23);
    EXPECT_EQ(cycle(0x0F) & 0x6F, 0x27);
  }
};

TEST(SimulatedDrive, BootsUpIntoPreOperational) {
  Rig rig;
  EXPECT_EQ(rig.tick(), std::vector<Frame>{frame(0x702, {0})});
  EXPECT_FALSE(rig.drive.operational());
  EXPECT_EQ(rig.send(frame(0x602, {0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0})),
            (std::vector<Frame>{frame(0x582, {0x43, 0x00, 0x10, 0x00, 0x92, 0x01, 0x02, 0x00})}));
}

TEST(SimulatedDrive, RefusesWhatTheStandardDoesNotAllow) {
  Rig rig;
  rig.configure(true);
  const auto aborted = [&rig](std::initializer_list<int> request, std::initializer_list<int> code) {
    const std::vector<Frame> answer = rig.send(frame(0x602, request));
    ASSERT_EQ(answer.size(), 1U);
    EXPECT_EQ(answer[0].data[0], 0x80);
    EXPECT_TRUE(std::equal(code.begin(), code.end(), answer[0].data.begin() + 4));
  };
  aborted({0x40, 0x34, 0x12, 0x00, 0, 0, 0, 0}, {0x00, 0x00, 0x02, 0x06});           // no such object
  aborted({0x2B, 0x41, 0x60, 0x00, 0, 0, 0, 0}, {0x02, 0x00, 0x01, 0x06});           // read only
  aborted({0x2F, 0x40, 0x60, 0x00, 0, 0, 0, 0}, {0x10, 0x00, 0x07, 0x06});           // wrong length
  aborted({0x23, 0x00, 0x16, 0x01, 0x10, 0, 0x71, 0x60}, {0x22, 0x00, 0x00, 0x08});  // the PDO is valid
  aborted({0x23, 0x01, 0x16, 0x01, 0x10, 0, 0x34, 0x12}, {0x41, 0x00, 0x04, 0x06});  // can not be mapped
  aborted({0x2F, 0x60, 0x60, 0x00, 0x07, 0, 0, 0}, {0x30, 0x00, 0x09, 0x06});        // no such mode
}

TEST(SimulatedDrive, GoesThroughTheStatesOneAtATime) {
  Rig rig;
  rig.configure(true);
  EXPECT_EQ(rig.cycle(0x0F) & 0x4F, 0x40) << "not from switch on disabled";
  rig.enable();
  EXPECT_TRUE(rig.drive.enabled());
  EXPECT_EQ(rig.cycle(0x00) & 0x4F, 0x40);
  EXPECT_FALSE(rig.drive.enabled());
}

TEST(SimulatedDrive, TorqueTakesEffectAtTheNextSyncAndMovesTheMotor) {
  Rig rig;
  rig.configure(true);
  rig.enable();
  static_cast<void>(rig.send(frame(0x202, {0x0F, 0, 0xF4, 0x01})));
  EXPECT_EQ(rig.drive.current_a(), 0.0);
  static_cast<void>(rig.send(frame(0x080, {})));
  EXPECT_NEAR(rig.drive.current_a(), 0.75, 1e-9) << "500 permille of 1.5 A";
  for (int i = 0; i < 50; ++i) {
    static_cast<void>(rig.cycle(0x0F, 500));
  }
  EXPECT_GT(rig.drive.truth().q1_rad, 0.01);
}

TEST(SimulatedDrive, ASetValueOfTheWrongLengthIsAnEmergency) {
  Rig rig;
  rig.configure(true);
  EXPECT_EQ(rig.send(frame(0x202, {0x06, 0})), (std::vector<Frame>{frame(0x082, {0x10, 0x82, 0x11, 0, 0, 0, 0, 0})}));
}

TEST(SimulatedDrive, AMissedMasterIsAFaultWithTorqueOff) {
  Rig rig;
  rig.configure(true);
  rig.enable();
  static_cast<void>(rig.send(frame(0x77F, {5})));
  for (int i = 0; i < 100; ++i) {
    static_cast<void>(rig.tick());
    EXPECT_TRUE(rig.drive.enabled());
  }
  const std::vector<Frame> out = rig.tick();
  EXPECT_EQ(out.back(), frame(0x082, {0x30, 0x81, 0x11, 0, 0, 0, 0, 0}));
  EXPECT_TRUE(rig.drive.faulted());
  EXPECT_FALSE(rig.drive.operational());
}

TEST(SimulatedDrive, FromTheFactoryItGoesOnWithoutItsMaster) {
  Rig rig;
  rig.configure(false);
  rig.enable();
  static_cast<void>(rig.send(frame(0x77F, {5})));
  static_cast<void>(rig.tick(101));
  EXPECT_TRUE(rig.drive.enabled()) << "6007 is 0 there, which is why the firmware writes it and reads it back";
}

TEST(SimulatedDrive, AFaultNeedsARisingEdge) {
  Rig rig;
  rig.configure(true);
  rig.enable();
  std::vector<Frame> out;
  rig.drive.fail(0x2310, out);
  EXPECT_EQ(out, (std::vector<Frame>{frame(0x082, {0x10, 0x23, 0x01, 0, 0, 0, 0, 0})}));
  EXPECT_EQ(rig.cycle(0x0F) & 0x4F, 0x08);
  EXPECT_EQ(rig.cycle(0x80) & 0x4F, 0x40);
  rig.drive.fail(0x2310, out);
  EXPECT_EQ(rig.cycle(0x80) & 0x4F, 0x08) << "bit 7 was already up";
}

TEST(SimulatedDrive, HeartbeatsComeAtTheirPeriod) {
  Rig rig;
  rig.configure(true);
  int count = 0;
  for (int i = 0; i < 500; ++i) {
    for (const Frame& message : rig.tick()) {
      count += message == frame(0x702, {5}) ? 1 : 0;
    }
  }
  EXPECT_EQ(count, 10);
}

}  // namespace
}  // namespace capstan::drive_sim
