// SPDX-License-Identifier: Apache-2.0
// The board's emulated twin: everything as on the motor board but its joint, which is a simulated plant at the end of
// USART2, and its parameter banks, since the emulator has no flash controller.
#include "capstan/boards/stm32f405/board.hpp"
#include "capstan/boards/stm32f405/host_file_banks.hpp"
#include "capstan/boards/stm32f405/own_image.hpp"
#include "capstan/boards/stm32f405/runtime.hpp"
#include "capstan/hal/plant_link/plant_link_io.hpp"
#include "capstan/hal/stm32f4/memory_map.hpp"

namespace {

using namespace capstan;
constexpr const char* kBoardName = "stm32f405-emulated";
[[gnu::section(".image"), gnu::used]] constinit const stm32f405::ImageHeader kImage = stm32f405::own_header(kBoardName);

using stm32f4::MemoryRegister;
using stm32f405::BoardTick;
using stm32f405::SerialPort;

/// Counts the looks at the line while the link waits.
class LookCounter {
 public:
  [[nodiscard]] auto now() const noexcept -> std::uint32_t { return ++looks_; }

 private:
  mutable std::uint32_t looks_ = 0;
};
using PlantLink = plant_link::PlantLinkIo<SerialPort, LookCounter, stm32f405::kAxes>;

/// Lock-step with a plant that is a program on another machine, as slow as that may be: while the board waits for it,
/// the board's time stands still. So a run is the same whatever the load of that machine.
class PlantIo {
 public:
  static constexpr std::size_t kAxes = stm32f405::kAxes;
  static constexpr bool kSimulated = true;
  PlantIo(PlantLink& link, BoardTick& tick) noexcept : link_(link), tick_(tick) {}

  [[nodiscard]] auto read(Sensed<kAxes>& in) noexcept -> Status {
    tick_.pause();
    const Status status = link_.read(in);
    tick_.resume();
    return status;
  }
  [[nodiscard]] auto write(const Drive<kAxes>& out) noexcept -> Status { return link_.write(out); }
  void release() noexcept { link_.release(); }
  void set_overruns(std::uint32_t overruns) noexcept { link_.set_overruns(overruns); }

 private:
  PlantLink& link_;
  BoardTick& tick_;
};
static_assert(JointIo<PlantIo>);

/// Looks for one answer, about two seconds on a machine of today: a plant answers within a millisecond unless its
/// machine is busy, or it is gone.
constexpr std::uint32_t kPlantPatience = 20'000'000;

SerialPort console{stm32f4::usart1_registers(), stm32f4::nvic_registers(), stm32f4::Interrupt::kUsart1};
SerialPort plant{stm32f4::usart2_registers(), stm32f4::nvic_registers(), stm32f4::Interrupt::kUsart2};
BoardTick tick{stm32f4::systick_registers()};
stm32f4::Watchdog<MemoryRegister> watchdog{stm32f4::watchdog_registers()};
stm32f405::CanPort can{stm32f4::can1_registers()};
stm32f405::HostFileBanks banks;
LookCounter looks;
PlantLink link{plant, looks, kPlantPatience};
PlantIo io{link, tick};
using BoardRuntime = stm32f405::Runtime<PlantIo>;
[[gnu::section(".noinit")]] BoardRuntime::FaultMemory fault_memory;
BoardRuntime runtime{io, {console, tick, watchdog, banks, can}, fault_memory, kBoardName};

/// "Bridges off", ready to send: encoded by the compiler, so the fault handler needs no working memory for it.
constexpr auto kReleaseFrame =
    plant_link::encode(plant_link::DriveFrame<stm32f405::kAxes>{.kind = plant_link::DriveKind::kRelease});

}  // namespace

extern "C" {

void rt_release_outputs() {
  auto& port = stm32f4::usart2_registers();
  constexpr std::uint32_t kPolls = 10'000;
  for (std::size_t i = 0; i < kReleaseFrame.size; ++i) {
    static_cast<void>(
        stm32f4::wait_for(port.sr, stm32f4::usart::kSrTransmitEmpty, stm32f4::usart::kSrTransmitEmpty, kPolls));
    port.dr.write(kReleaseFrame.bytes[i]);
  }
}

void rt_usart2_isr() {
  plant.rt_isr();
}

}  // extern "C"

#include "capstan/boards/stm32f405/board_isrs.inc"

int main() {
  using namespace capstan;
  stm32f405::StartReport report = stm32f405::start_core();
  stm32f4::set_bits(stm32f4::rcc_registers().apb1enr, stm32f4::rcc::kApb1Usart2);
  stm32f405::start_pins(stm32f405::kPlantPins);
  console.start(report.clock.apb2_hz, stm32f405::kConsoleBaud);
  plant.start(report.clock.apb1_hz, stm32f405::kPlantBaud);
  runtime.start_can(report.clock);
  report.watchdog_set = watchdog.start(stm32f4::kCycleWatchdog);
  link.start();
  if (!tick.start(report.clock.core_hz, kCycleRateHz)) {
    rt_release_outputs();
    stm32f405::reset_core();
  }
  runtime.run(report);
}
