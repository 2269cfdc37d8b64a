// SPDX-License-Identifier: Apache-2.0
// The motor board's recorded run through the cycle as WebAssembly. The file lies in this module's memory.
#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "capstan/boards/stm32f405/board.hpp"
#include "capstan/boards/stm32f405/cycle_replay.hpp"

namespace {

using namespace capstan;

std::vector<std::uint8_t> input;
std::vector<std::uint8_t> output;

struct Source {
  auto read(std::span<std::uint8_t> bytes) -> std::size_t {
    const std::size_t count = std::min(bytes.size(), input.size() - at);
    std::copy_n(input.begin() + static_cast<std::ptrdiff_t>(at), count, bytes.begin());
    at += count;
    return count;
  }
  std::size_t at = 0;
};
struct Drain {
  static auto write(std::span<const std::uint8_t> bytes) -> bool {
    output.insert(output.end(), bytes.begin(), bytes.end());
    return true;
  }
};
struct NoMeter {
  void begin() {}
  void end() {}
};

}  // namespace

#define CAPSTAN_EXPORT extern "C" [[gnu::used, gnu::visibility("default")]]

CAPSTAN_EXPORT auto replay_input(std::uint32_t size) -> std::uint8_t* {
  input.resize(size);
  return input.data();
}
/// ReplayResult.
CAPSTAN_EXPORT auto replay_run() -> std::int32_t {
  Source source;
  Drain drain;
  NoMeter meter;
  return static_cast<std::int32_t>(stm32f405::replay<stm32f405::kAxes>(source, drain, meter));
}
CAPSTAN_EXPORT auto replay_output() -> const std::uint8_t* {
  return output.data();
}
CAPSTAN_EXPORT auto replay_output_size() -> std::uint32_t {
  return static_cast<std::uint32_t>(output.size());
}
