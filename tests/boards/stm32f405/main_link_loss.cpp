// SPDX-License-Identifier: Apache-2.0
// Test image for the emulator, which has no CAN controller: setpoints come as frames of a bus in every cycle, then no
// more. Prints the longest time by the core's own timer from the last frame to the torque going, and exits with 0 if
// that is at most 100 ms and its reason the lost link.
#include <array>
#include <atomic>

#include "capstan/boards/stm32f405/banks.hpp"
#include "capstan/boards/stm32f405/board.hpp"
#include "capstan/boards/stm32f405/can_setpoints.hpp"
#include "capstan/boards/stm32f405/host_sink.hpp"
#include "capstan/boards/stm32f405/startup.hpp"
#include "capstan/firmware/loop/application.hpp"
#include "capstan/hal/stm32f4/memory_map.hpp"
#include "capstan/hal/stm32f4/nvic.hpp"
#include "capstan/hal/stm32f4/semihosting.hpp"
#include "capstan/hal/stm32f4/tick.hpp"

namespace {

using namespace capstan;
using stm32f405::kAxes;
namespace semihosting = stm32f4::semihosting;

constexpr std::uint32_t kCoreHz = 168'000'000;  // at which the emulator's timer counts
constexpr std::uint32_t kCyclesPerMs = kCoreHz / 1000;
constexpr std::uint32_t kMostMs = 100;
constexpr std::uint32_t kStreamMs = 300;
constexpr std::uint32_t kPatienceMs = 1000;

/// Joints that stand where they are, with sensors that work.
class StandingJoints {
 public:
  static constexpr std::size_t kAxes = stm32f405::kAxes;
  auto read(Sensed<kAxes>& in) noexcept -> Status {
    in = {};
    for (AxisSensed& axis : in.axis) {
      axis.encoder = axis.current = Quality::kOk;
    }
    return Status::kOk;
  }
  auto write(const Drive<kAxes>& out) noexcept -> Status {
    torque = false;
    for (const AxisDrive& axis : out.axis) {
      torque = torque || axis.enabled;
    }
    return Status::kOk;
  }
  void release() noexcept { torque = false; }
  bool torque = false;
};
static_assert(JointIo<StandingJoints>);

stm32f4::Tick<stm32f4::MemoryRegister> tick{stm32f4::systick_registers()};
StandingJoints joints;
stm32f405::RamBanks banks;
Application<StandingJoints> application{joints, banks};
stm32f405::CanTroubleCounters troubles;
stm32f405::CanSetpoints<kAxes> setpoints{stm32f405::kCanNode, troubles};

std::atomic<bool> streaming = false;
std::atomic<std::uint32_t> last_frame = 0;  // core cycles
std::atomic<std::uint32_t> torque_off = 0;  // the same; 0: it is on, or was never
std::uint8_t sequence = 0;

auto frame_of(std::size_t axis) -> stm32f4::CanFrame {
  stm32f4::CanFrame frame{.id = stm32f405::identifier(stm32f405::kCanSetpoint, stm32f405::kCanNode, axis), .size = 8};
  frame.data[0] = sequence;
  frame.data[1] = stm32f405::kFollowAngle;  // 0 rad, where the joint stands
  const std::uint16_t crc = stm32f405::setpoint_checksum(frame);
  frame.data[6] = static_cast<std::uint8_t>(crc);
  frame.data[7] = static_cast<std::uint8_t>(crc >> 8U);
  return frame;
}

void rt_cycle() {
  setpoints.rt_begin_cycle();
  if (streaming) {
    ++sequence;
    for (std::size_t axis = 0; axis < kAxes; ++axis) {
      setpoints.rt_take(frame_of(axis));
    }
    last_frame = tick.core_cycles();
  }
  const bool before = joints.torque;
  application.rt_tick(setpoints.rt_streamed());
  if (before && !joints.torque) {
    torque_off = tick.core_cycles();
  }
}

void wait(std::uint32_t ms, auto&& until) {
  for (const std::uint32_t start = tick.count(); tick.count() - start < ms && !until();) {
  }
}

}  // namespace

extern "C" {

void rt_release_outputs() {
  semihosting::exit(20);
}
void rt_systick_isr() {
  tick.rt_isr();
  stm32f4::pend_cycle(stm32f4::scb_registers());
}
void rt_cycle_isr() {
  rt_cycle();
}
void rt_usart1_isr() {}

}  // extern "C"

int main() {
  stm32f405::HostSink sink;
  Print out(sink);
  stm32f4::set_core_priorities(stm32f4::scb_registers(), stm32f4::Priority::kCycle, stm32f4::Priority::kTick);
  if (!tick.start(kCoreHz, kCycleRateHz)) {
    semihosting::exit(21);
  }
  wait(10, [] { return false; });
  static_cast<void>(application.post({.kind = Request::Kind::kArm}));
  wait(kPatienceMs, [] { return joints.torque; });
  streaming = true;
  wait(kStreamMs, [] { return false; });
  const bool held = joints.torque;
  streaming = false;
  wait(kPatienceMs, [] { return torque_off != 0; });
  const Fault reason = application.telemetry().first_fault;
  // The frame may have waited since the cycle before had looked. Tenths of a ms, rounded up.
  const std::uint32_t took = (torque_off - last_frame + kCyclesPerMs + kCyclesPerMs / 10 - 1) / (kCyclesPerMs / 10);
  out << "torque off after the last setpoint came over the bus: " << took / 10 << '.' << took % 10 << " ms (at most "
      << kMostMs << "), " << info(reason).name << "\n";
  semihosting::exit(held && torque_off != 0 && took <= 10 * kMostMs && reason == Fault::kLinkLost ? 0 : 1);
}
