// SPDX-License-Identifier: Apache-2.0
#pragma once

/// For what a caller owes (`@pre`): programmer's errors, never input. Where it does not hold the program ends at once
/// with a trap. On the motor board the fault handler takes the torque away first, then records the place and restarts;
/// on Linux the process ends, as after any crash. Nothing is printed and nothing is copied: a comparison and a branch.
#define CAPSTAN_EXPECT(condition)    \
  do {                               \
    if (!(condition)) [[unlikely]] { \
      __builtin_trap();              \
    }                                \
  } while (false)
