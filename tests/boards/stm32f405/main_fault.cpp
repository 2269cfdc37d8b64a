// SPDX-License-Identifier: Apache-2.0
// Test image for the emulator: fails in the way its command line asks for, and prints what the next start remembers of
// it.
#include <array>
#include <string_view>

#include "capstan/boards/stm32f405/host_sink.hpp"
#include "capstan/boards/stm32f405/startup.hpp"
#include "capstan/firmware/console/text.hpp"
#include "capstan/hal/stm32f4/memory_map.hpp"
#include "capstan/hal/stm32f4/nvic.hpp"
#include "capstan/hal/stm32f4/semihosting.hpp"

namespace {

using namespace capstan;
namespace semihosting = stm32f4::semihosting;

volatile std::uint32_t zero = 0;

/// Deeper and deeper; what each level keeps and adds on the way back keeps the compiler from making a loop of it.
[[gnu::noinline]] auto overflow_stack(std::uint32_t depth) -> std::uint32_t {
  std::array<std::uint32_t, 16> kept{};
  kept[zero] = depth;
  return depth == UINT32_MAX ? 0 : overflow_stack(depth + 1) + kept[zero];
}

void fail(std::string_view how) {
  if (how == "bus") {
    *reinterpret_cast<volatile std::uint32_t*>(0x6000'0000) = 1;  // nothing is there
  } else if (how == "usage") {
    asm volatile("udf #0");
  } else if (how == "stack") {
    zero = overflow_stack(0);
  } else if (how == "stray") {
    stm32f4::enable_interrupt(stm32f4::nvic_registers(), stm32f4::Interrupt::kUsart2);
    stm32f4::pend_interrupt(stm32f4::nvic_registers(), stm32f4::Interrupt::kUsart2);
  }
}

}  // namespace

extern "C" {

void rt_release_outputs() {
  stm32f405::HostSink sink;
  Print(sink) << "released\n";
}
void rt_systick_isr() {}
void rt_cycle_isr() {}
void rt_usart1_isr() {}

}  // extern "C"

int main() {
  std::array<char, 256> text{};
  std::string_view words(text.data(), semihosting::command_line(text));
  static_cast<void>(next_word(words));  // the image itself
  stm32f405::HostSink sink;
  Print out(sink);
  stm32f405::FaultRecord record;
  if (!stm32f405::take_fault_record(record)) {
    out << "first start\n";
    fail(next_word(words));
    semihosting::exit(5);  // it did not fail
  }
  out << "remembers " << stm32f405::fault_name(record) << ", program counter "
      << (record.program_counter != 0 ? "known" : "lost") << ", status " << record.fault_status << ", address "
      << record.address << "\n";
  semihosting::exit(stm32f405::take_fault_record(record) ? 6 : 0);  // once is enough
}
