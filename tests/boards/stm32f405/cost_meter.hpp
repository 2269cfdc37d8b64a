// SPDX-License-Identifier: Apache-2.0
#pragma once

// Counts what one call costs on this core: "cost NAME MEAN MAX", instructions over random and adversarial input.
#include <algorithm>
#include <cstdint>
#include <limits>
#include <string_view>

#include "capstan/boards/stm32f405/host_sink.hpp"
#include "capstan/firmware/console/text.hpp"
#include "capstan/hal/stm32f4/memory_map.hpp"
#include "capstan/hal/stm32f4/semihosting.hpp"
#include "capstan/hal/stm32f4/tick.hpp"
#include "capstan/model/scalar.hpp"

namespace capstan::costs {
namespace semihosting = stm32f4::semihosting;

inline constexpr std::uint32_t kCoreHz = 168'000'000;  // at which the emulator's timer counts
inline constexpr int kCalls = 1000;

inline stm32f4::Tick<stm32f4::MemoryRegister> tick{stm32f4::systick_registers()};

/// A number of the format from units of 2^-24.
template <typename Scalar>
constexpr auto number(std::int32_t raw) -> Scalar {
  if constexpr (std::is_same_v<Scalar, Q24>) {
    return Q24::from_raw(raw);
  } else {
    return static_cast<Scalar>(raw) * ScalarTraits<Scalar>::from(0x1p-24);
  }
}

/// A constant of the format: the target converts no double at run time.
template <typename Scalar>
consteval auto from(double value) -> Scalar {
  return ScalarTraits<Scalar>::from(value);
}

/// Numbers that look like chance, the same every run and in every format.
template <typename Scalar>
class Chance {
 public:
  /// In [-size, size).
  auto within(Scalar size) -> Scalar {
    state_ = state_ * 1664525U + 1013904223U;
    return size * number<Scalar>(static_cast<std::int32_t>(state_) >> 7);
  }

 private:
  std::uint32_t state_ = 12345;
};
template <typename Scalar>
inline Chance<Scalar> chance;

/// Keeps the compiler from working anything out beforehand, or from leaving it out.
template <typename T>
void touch(T& value) {
  asm volatile("" : : "r"(&value) : "memory");
}

/// Ticks of one call, or nothing if the timer began anew meanwhile. The timer's interrupt is held off.
template <typename Work>
auto ticks_of(Work&& work, std::uint32_t& ticks) -> bool {
  asm volatile("cpsid i" : : : "memory");
  const std::uint32_t begin = tick.since_edge();
  asm volatile("" : : : "memory");
  work();
  asm volatile("" : : : "memory");
  const std::uint32_t end = tick.since_edge();
  asm volatile("cpsie i" : : : "memory");
  ticks = end - begin;
  return end > begin;
}

/// @param prepare  called before each call and not counted
template <typename Prepare, typename Work>
void measure(Print& out, std::string_view name, Prepare&& prepare, Work&& work) {
  static std::uint32_t overhead = 0;
  if (overhead == 0) {
    overhead = std::numeric_limits<std::uint32_t>::max();
    for (int i = 0; i < 100; ++i) {
      std::uint32_t ticks = 0;
      overhead = ticks_of([] {}, ticks) ? std::min(overhead, ticks) : overhead;
    }
  }
  std::uint32_t sum = 0;
  std::uint32_t max = 0;
  std::uint32_t calls = 0;
  for (int i = 0; i < kCalls; ++i) {
    prepare(i);
    std::uint32_t ticks = 0;
    if (ticks_of(work, ticks)) {
      const std::uint32_t own = ticks > overhead ? ticks - overhead : 0;
      sum += own;
      max = std::max(max, own);
      ++calls;
    }
  }
  out << "cost " << name << " " << stm32f4::emulated_instructions(sum, kCoreHz) / std::max<std::uint32_t>(1, calls)
      << " " << stm32f4::emulated_instructions(max, kCoreHz) << "\n";
}

/// One motion for all: a walk with reversals, torque and angle.
template <typename Scalar>
struct Walk {
  Scalar q1{};
  Scalar tau{};
  void step(int i) {
    constexpr Scalar kStride = from<Scalar>(0.01);
    constexpr Scalar kShare = from<Scalar>(0.3);
    constexpr Scalar kMost = from<Scalar>(0.2);
    const Scalar stride = chance<Scalar>.within(kStride + kStride) + (i % 200 < 100 ? kStride : -kStride);
    q1 += stride;
    tau = clamp(tau + stride * kShare + chance<Scalar>.within(kStride), -kMost, kMost);
  }
};

}  // namespace capstan::costs

// Of an image that measures, which is one source: nothing but the tick interrupts it.
extern "C" {

void rt_release_outputs() {
  capstan::stm32f4::semihosting::exit(20);
}
void rt_systick_isr() {
  capstan::costs::tick.rt_isr();
}
void rt_cycle_isr() {
  capstan::stm32f4::semihosting::exit(20);
}
void rt_usart1_isr() {
  capstan::stm32f4::semihosting::exit(20);
}

}  // extern "C"
