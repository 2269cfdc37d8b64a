// SPDX-License-Identifier: Apache-2.0
// Test image for the emulator: what each law and term costs in fixed point.
#include "capstan/tests/boards/stm32f405/all_costs.hpp"

int main() {
  capstan::costs::measure_everything<capstan::Q24>();
}
