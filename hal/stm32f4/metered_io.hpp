// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "capstan/hal/joint_io.hpp"

namespace capstan::stm32f4 {

/// Passes every call on and measures how long the hardware took, so that the cycle's own cost can be told from waiting.
template <JointIo Io, typename Counter>
class MeteredIo {
 public:
  static constexpr std::size_t kAxes = Io::kAxes;

  MeteredIo(Io& io, const Counter& counter) noexcept : io_(io), counter_(counter) {}

  [[nodiscard]] auto read(Sensed<kAxes>& in) noexcept -> Status {
    const std::uint32_t begin = counter_.core_cycles();
    const Status status = io_.read(in);
    spent_ += counter_.core_cycles() - begin;
    return status;
  }
  [[nodiscard]] auto write(const Drive<kAxes>& out) noexcept -> Status {
    const std::uint32_t begin = counter_.core_cycles();
    const Status status = io_.write(out);
    spent_ += counter_.core_cycles() - begin;
    return status;
  }
  void release() noexcept { io_.release(); }

  /// Core cycles spent in read() and write() since the last call of this.
  [[nodiscard]] auto take_spent() noexcept -> std::uint32_t {
    const std::uint32_t spent = spent_;
    spent_ = 0;
    return spent;
  }

 private:
  Io& io_;
  const Counter& counter_;
  std::uint32_t spent_ = 0;
};

}  // namespace capstan::stm32f4
