// SPDX-License-Identifier: Apache-2.0
#include "capstan/boards/stm32f405/startup.hpp"

#include <array>
#include <cstddef>

#include "capstan/boards/stm32f405/image_check.hpp"
#include "capstan/hal/stm32f4/memory_map.hpp"
#include "capstan/hal/stm32f4/nvic.hpp"

// Symbols of the linker script, of which only the addresses mean anything, and the functions its vectors start in.
// NOLINTBEGIN(readability-identifier-naming): the linker's names.
extern "C" {
extern std::uint32_t capstan_stack_bottom[];
extern std::uint32_t capstan_stack_top[];
extern std::uint32_t capstan_data_start[];
extern std::uint32_t capstan_data_end[];
extern const std::uint32_t capstan_data_image[];
extern std::uint32_t capstan_bss_start[];
extern std::uint32_t capstan_bss_end[];
extern void (*const capstan_init_start[])();
extern void (*const capstan_init_end[])();
// NOLINTEND(readability-identifier-naming)

[[noreturn]] void capstan_reset();
[[noreturn]] void capstan_start();
[[noreturn]] void capstan_fault_entry();
[[noreturn]] void capstan_fault(const std::uint32_t* frame);
}

// An image that does not use one of these has an interrupt there that is as stray as any other. The alias promises less
// than its target ("never returns"), which is what it is for.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wmissing-attributes"
extern "C" [[gnu::weak, gnu::alias("capstan_fault_entry")]] void rt_usart2_isr();
extern "C" [[gnu::weak, gnu::alias("capstan_fault_entry")]] void rt_can_receive0_isr();
extern "C" [[gnu::weak, gnu::alias("capstan_fault_entry")]] void rt_can_receive1_isr();
extern "C" [[gnu::weak, gnu::alias("capstan_fault_entry")]] void rt_encoder_index_isr();
#pragma GCC diagnostic pop

namespace {

using capstan::stm32f4::Interrupt;
using capstan::stm32f405::FaultRecord;

constexpr std::uint32_t kFaultMagic = 0xCA95'FA17;

/// Constructor-free on purpose: nothing may touch it between a fault and the next start.
struct StoredFault {
  std::uint32_t magic;
  std::uint32_t exception, program_counter, link_register, fault_status, hard_fault_status, address;
};
[[gnu::section(".noinit")]] StoredFault stored_fault;

using Handler = void (*)();
constexpr std::size_t kCoreHandlers = 15;

struct VectorTable {
  const std::uint32_t* initial_stack;
  std::array<Handler, kCoreHandlers> core;
  std::array<Handler, capstan::stm32f4::kInterruptCount> chip;
};

/// An interrupt nobody asked for is a fault: it means that a register was written that should not have been.
constexpr auto make_chip_vectors() -> std::array<Handler, capstan::stm32f4::kInterruptCount> {
  std::array<Handler, capstan::stm32f4::kInterruptCount> table{};
  table.fill(capstan_fault_entry);
  table[static_cast<std::size_t>(Interrupt::kUsart1)] = rt_usart1_isr;
  table[static_cast<std::size_t>(Interrupt::kUsart2)] = rt_usart2_isr;
  table[static_cast<std::size_t>(Interrupt::kCan1Receive0)] = rt_can_receive0_isr;
  table[static_cast<std::size_t>(Interrupt::kCan1Receive1)] = rt_can_receive1_isr;
  table[static_cast<std::size_t>(Interrupt::kExti15To10)] = rt_encoder_index_isr;
  return table;
}

constexpr auto make_core_vectors() -> std::array<Handler, kCoreHandlers> {
  std::array<Handler, kCoreHandlers> table{};
  table.fill(capstan_fault_entry);
  table[0] = capstan_reset;
  table[13] = rt_cycle_isr;    // PendSV, exception 14
  table[14] = rt_systick_isr;  // SysTick, exception 15
  return table;
}

[[gnu::section(".vectors"), gnu::used]] constinit const VectorTable kVectors{
    .initial_stack = capstan_stack_top, .core = make_core_vectors(), .chip = make_chip_vectors()};

}  // namespace

/// First instruction after reset. Paints the stack before anything is on it: a naked function, since a compiled one
/// could use the very memory it paints. Then looks whether the image is whole, while only code of this sector has run.
[[gnu::naked, gnu::section(".sector0"), gnu::used]] void capstan_reset() {
  asm volatile(
      "ldr r0, =capstan_stack_bottom \n"
      "ldr r1, =capstan_stack_top    \n"
      "mov sp, r1                    \n"
      "ldr r2, =0xC0FFEE5A           \n"
      "1: str r2, [r0], #4           \n"
      "cmp r0, r1                    \n"
      "blo 1b                        \n"
      "bl capstan_check_image        \n"
      "b capstan_start               \n"
      ".ltorg                        \n");
}

void capstan_start() {
  const std::uint32_t* image = capstan_data_image;
  for (std::uint32_t* word = capstan_data_start; word < capstan_data_end; ++word) {
    *word = *image++;
  }
  for (std::uint32_t* word = capstan_bss_start; word < capstan_bss_end; ++word) {
    *word = 0;
  }
  auto& scb = capstan::stm32f4::scb_registers();
  scb.vtor.write(reinterpret_cast<std::uintptr_t>(&kVectors));
  capstan::stm32f4::set_bits(scb.ccr, capstan::stm32f4::scb::kCcrTrapDivideByZero);
  capstan::stm32f4::set_bits(scb.shcsr, capstan::stm32f4::scb::kShcsrFaultsOn);
  for (auto init = capstan_init_start; init < capstan_init_end; ++init) {
    (*init)();
  }
  main();
  rt_release_outputs();
  capstan::stm32f405::reset_core();
}

/// Every fault and every stray interrupt comes here: finds the stack frame of what was interrupted, and goes on below
/// it, or at the top of the stack when less than 512 bytes are left (an overflow: nothing on it is worth keeping then).
/// Sits in sector 0, away from the code it reports on.
[[gnu::naked, gnu::section(".sector0"), gnu::used]] void capstan_fault_entry() {
  asm volatile(
      "cpsid i                        \n"
      "tst lr, #4                     \n"
      "ite eq                         \n"
      "mrseq r0, msp                  \n"
      "mrsne r0, psp                  \n"
      "ldr r1, =capstan_stack_bottom  \n"
      "add r1, r1, #512               \n"
      "mov r2, sp                     \n"
      "cmp r2, r1                     \n"
      "bhs 1f                         \n"
      "ldr r1, =capstan_stack_top     \n"
      "mov sp, r1                     \n"
      "1: b capstan_fault             \n"
      ".ltorg                         \n");
}

[[gnu::section(".sector0"), gnu::used]] void capstan_fault(const std::uint32_t* frame) {
  rt_release_outputs();
  std::uint32_t exception = 0;
  asm volatile("mrs %0, ipsr" : "=r"(exception));
  auto& scb = capstan::stm32f4::scb_registers();
  // The core stacked r0-r3, r12, lr, pc, psr; a frame below the stack was never written (that was the fault).
  const bool readable = frame >= capstan_stack_bottom && frame + 8 <= capstan_stack_top;
  stored_fault = {.magic = kFaultMagic,
                  .exception = exception,
                  .program_counter = readable ? frame[6] : 0,
                  .link_register = readable ? frame[5] : 0,
                  .fault_status = scb.cfsr.read(),
                  .hard_fault_status = scb.hfsr.read(),
                  .address = scb.bfar.read()};
  capstan::stm32f405::reset_core();
}

namespace capstan::stm32f405 {

auto take_fault_record(FaultRecord& record) noexcept -> bool {
  if (stored_fault.magic != kFaultMagic) {
    return false;  // after power-on this memory holds anything
  }
  stored_fault.magic = 0;
  record = {.exception = stored_fault.exception,
            .program_counter = stored_fault.program_counter,
            .link_register = stored_fault.link_register,
            .fault_status = stored_fault.fault_status,
            .hard_fault_status = stored_fault.hard_fault_status,
            .address = stored_fault.address};
  return true;
}

auto fault_name(const FaultRecord& record) noexcept -> const char* {
  switch (record.exception) {
    case 2:
      return "non-maskable interrupt (the crystal stopped)";
    case 3:
      return "hard fault";
    case 4:
      return "memory fault";
    case 5:
      return "bus fault";
    case 6:
      return "usage fault";
    default:
      return "stray interrupt";
  }
}

void reset_core() noexcept {
  // The barrier lets the last writes (outputs off, the record) reach memory before the core restarts.
  asm volatile("dsb" ::: "memory");
  stm32f4::scb_registers().aircr.write(stm32f4::scb::kAircrReset);
  for (;;) {
    asm volatile("dsb");
  }
}

auto stack_size_bytes() noexcept -> std::uint32_t {
  return static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(capstan_stack_top) -
                                    reinterpret_cast<std::uintptr_t>(capstan_stack_bottom));
}

auto stack_unused_bytes() noexcept -> std::uint32_t {
  constexpr std::uint32_t kPaint = 0xC0FF'EE5A;  // as in capstan_reset
  const volatile std::uint32_t* word = capstan_stack_bottom;
  while (word < capstan_stack_top && *word == kPaint) {
    ++word;
  }
  return static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(word) -
                                    reinterpret_cast<std::uintptr_t>(capstan_stack_bottom));
}

}  // namespace capstan::stm32f405

// The compiler refers to these from virtual tables. Without a heap and with every object living for ever neither can be
// called in a correct program, so being called is a fault like any other.
// NOLINTNEXTLINE(readability-identifier-naming): the compiler's name.
extern "C" [[noreturn]] void __cxa_pure_virtual() {
  capstan_fault_entry();
}
void operator delete(void*) noexcept {
  capstan_fault_entry();
}
void operator delete(void*, std::size_t) noexcept {
  capstan_fault_entry();
}
