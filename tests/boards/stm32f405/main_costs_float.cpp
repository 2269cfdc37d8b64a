// SPDX-License-Identifier: Apache-2.0
// Test image for the emulator: what the same laws and terms would cost in single precision, with the core's FPU on. The
// product has neither.
// Before the templates that are used with it.
#include "capstan/tests/boards/stm32f405/single_precision.hpp"

#include "capstan/tests/boards/stm32f405/all_costs.hpp"

namespace {
// Not inlined, or the FPU is used to enter the function that switches it on.
[[gnu::noinline]] void measure_in_single_precision() {
  capstan::costs::measure_everything<float>();
}
}  // namespace

int main() {
  // Coprocessors 10 and 11, the FPU, for everybody (ARMv7-M B3.2.20).
  *reinterpret_cast<volatile std::uint32_t*>(0xE000'ED88U) |= 0xFU << 20U;
  asm volatile("dsb\n\tisb" : : : "memory");
  measure_in_single_precision();
}
