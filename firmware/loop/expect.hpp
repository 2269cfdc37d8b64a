// SPDX-License-Identifier: Apache-2.0
#pragma once

/// For what a caller owes (`@pre`): programmer's errors, never input. Where it does not hold the program ends at once,
/// with a trap that on a board takes the torque away: the motor board's fault handler releases first, then records the
/// place and restarts; on Linux the process ends, and drives and brake lines go to rest with it. Nothing is printed and
/// nothing is copied: a comparison and a branch.
#define CAPSTAN_EXPECT(condition)    \
  do {                               \
    if (!(condition)) [[unlikely]] { \
      __builtin_trap();              \
    }                                \
  } while (false)
