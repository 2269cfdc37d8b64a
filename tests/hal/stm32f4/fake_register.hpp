// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>

#include "capstan/hal/stm32f4/register.hpp"

namespace capstan::stm32f4 {

/// A register with a will of its own: a test gives it the behaviour the reference manual describes.
class FakeRegister {
 public:
  using OnRead = std::function<std::uint32_t(std::uint32_t value)>;
  using OnWrite = std::function<std::uint32_t(std::uint32_t old, std::uint32_t written)>;

  [[nodiscard]] auto read() const noexcept -> std::uint32_t {
    ++reads;
    return on_read ? on_read(value) : value;
  }
  void write(std::uint32_t written) noexcept {
    ++writes;
    value = on_write ? on_write(value, written) : written;
  }

  std::uint32_t value = 0;
  mutable std::uint32_t reads = 0;
  std::uint32_t writes = 0;
  OnRead on_read;
  OnWrite on_write;
};
static_assert(RegisterCell<FakeRegister>);

/// Flags that software clears by writing 1 to them; writing 0 leaves them alone.
inline auto write_one_to_clear(std::uint32_t flags) -> FakeRegister::OnWrite {
  return [flags](std::uint32_t old, std::uint32_t written) { return old & ~(written & flags); };
}

/// Flags that software clears by writing 0 to them; writing 1 leaves them alone.
inline auto write_zero_to_clear(std::uint32_t flags) -> FakeRegister::OnWrite {
  return [flags](std::uint32_t old, std::uint32_t written) { return old & (written | ~flags); };
}

}  // namespace capstan::stm32f4
