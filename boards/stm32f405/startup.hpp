// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace capstan::stm32f405 {

/// What the core knew when it last failed. Kept in RAM that start-up leaves alone, so that it outlives the reset.
struct FaultRecord {
  std::uint32_t exception = 0;  ///< number of the exception (2 NMI, 3 hard, 4 memory, 5 bus, 6 usage, above: stray)
  std::uint32_t program_counter = 0;    ///< 0: the stack was not readable any more
  std::uint32_t link_register = 0;      ///< 0: as above
  std::uint32_t fault_status = 0;       ///< CFSR, ARMv7-M B3.2.15
  std::uint32_t hard_fault_status = 0;  ///< HFSR
  std::uint32_t address = 0;            ///< BFAR; meaningful when bit 15 of fault_status is set
};

/// True once after a reset that a fault handler caused; `record` is filled and the memory of it removed.
[[nodiscard]] auto take_fault_record(FaultRecord& record) noexcept -> bool;

/// Short name of the exception in a record.
[[nodiscard]] auto fault_name(const FaultRecord& record) noexcept -> const char*;

/// Restarts the chip; does not return.
[[noreturn]] void reset_core() noexcept;

/// Bytes of the stack that were never used since start, and its size. Start-up paints the stack; this looks for the
/// first word that lost its paint, so it is a search and not for interrupts.
[[nodiscard]] auto stack_unused_bytes() noexcept -> std::uint32_t;
[[nodiscard]] auto stack_size_bytes() noexcept -> std::uint32_t;

}  // namespace capstan::stm32f405

// What the start-up code calls in the image. The image defines every one of them but the last
// four, which it may leave out.
extern "C" {
int main();
/// De-energises the outputs by register writes alone. Runs first in every fault handler, on a fresh stack, with no
/// other promise about the state of memory.
void rt_release_outputs();
void rt_systick_isr();
void rt_cycle_isr();
void rt_usart1_isr();
void rt_usart2_isr();
void rt_can_receive0_isr();
void rt_can_receive1_isr();
void rt_encoder_index_isr();
}
