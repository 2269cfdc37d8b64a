// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

namespace capstan {

/// Lines of one GPIO chip, taken as inputs or as outputs and given back at the end. One of gpio_request_*.cpp carries
/// it out: by the kernel's own interface, by libgpiod 1 or by libgpiod 2. Values are the lines' electrical levels: bit
/// i is the i-th line. What begins with `rt_` neither waits nor allocates.
class GpioRequest {
 public:
  static constexpr std::size_t kMostLines = 8;
  enum class Direction : std::uint8_t { kInput, kOutput };
  enum class Edges : std::uint8_t { kNone, kSeen, kFailed };

  /// Takes nothing.
  GpioRequest() = default;
  /// @param levels  what outputs begin with   Inputs tell their edges. Throws std::runtime_error with what the system
  /// said if the lines can not be had.
  GpioRequest(const std::string& chip, std::span<const std::uint32_t> offsets, Direction direction,
              std::uint32_t levels);
  GpioRequest(GpioRequest&&) noexcept = default;
  auto operator=(GpioRequest&&) noexcept -> GpioRequest& = default;

  [[nodiscard]] explicit operator bool() const { return static_cast<bool>(lines_); }

  /// Whether the first line had an edge since the last call, whichever way.
  auto rt_edges() -> Edges;
  /// The first line's level. False: the system refused.
  auto rt_get(bool& high) -> bool;
  /// All lines at once. False: the system refused.
  auto rt_set(std::uint32_t levels) -> bool;

 private:
  struct Lines;                   // of the implementation
  std::shared_ptr<Lines> lines_;  // nobody shares them; it knows how to give them back where `Lines` is not known
};

}  // namespace capstan
