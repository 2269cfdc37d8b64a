// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>
#include <cstdint>

namespace capstan::stm32f4 {

/// One 32-bit register of a peripheral. Drivers are templates on this type, so that the host's tests run the very same
/// code against cells that behave as the reference manual says (flags that come late or never, write-1-to-clear, ...).
template <typename Cell>
concept RegisterCell = requires(Cell cell, const Cell& constant, std::uint32_t value) {
  { constant.read() }
  noexcept->std::same_as<std::uint32_t>;
  { cell.write(value) }
  noexcept->std::same_as<void>;
};

/// The target's cell: every call is exactly one bus access, never merged or dropped by the compiler.
class MemoryRegister {
 public:
  [[nodiscard]] auto read() const noexcept -> std::uint32_t { return value_; }
  void write(std::uint32_t value) noexcept { value_ = value; }

 private:
  volatile std::uint32_t value_;
};
static_assert(RegisterCell<MemoryRegister> && sizeof(MemoryRegister) == 4);

/// Read-modify-write: not atomic against an interrupt that changes the same register.
template <RegisterCell Cell>
void set_bits(Cell& cell, std::uint32_t mask) noexcept {
  cell.write(cell.read() | mask);
}

template <RegisterCell Cell>
void clear_bits(Cell& cell, std::uint32_t mask) noexcept {
  cell.write(cell.read() & ~mask);
}

/// Replaces the bits under `mask` by those of `value`.
template <RegisterCell Cell>
void modify(Cell& cell, std::uint32_t mask, std::uint32_t value) noexcept {
  cell.write((cell.read() & ~mask) | (value & mask));
}

/// Polls until (cell & mask) == wanted, at most `polls` times. False: the flag did not come. No wait in this project is
/// without a bound: a crystal that does not start must end in a reported fault, not in a board that says nothing.
template <RegisterCell Cell>
[[nodiscard]] auto wait_for(const Cell& cell, std::uint32_t mask, std::uint32_t wanted, std::uint32_t polls) noexcept
    -> bool {
  for (std::uint32_t i = 0; i < polls; ++i) {
    if ((cell.read() & mask) == wanted) {
      return true;
    }
  }
  return false;
}

}  // namespace capstan::stm32f4
