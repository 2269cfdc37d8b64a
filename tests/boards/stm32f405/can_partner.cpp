// SPDX-License-Identifier: Apache-2.0
// can_partner: the board's node on a bus, for can_dbc_test. Reads frames, "IDENTIFIER BYTES" in hexadecimal, gives them
// to the board one a millisecond, and prints the frames that the board sends while it is brought through four scenes,
// each behind its name.
#include <cstdio>
#include <iostream>
#include <sstream>

#include "capstan/tests/boards/stm32f405/can_bench.hpp"

namespace capstan::stm32f405 {
namespace {

void print_scene(const char* name, CanBench& bench, std::size_t from) {
  for (; from < bench.chip.sent.size(); ++from) {
    const CanFrame& frame = bench.chip.sent[from];
    std::printf("%s %x ", name, static_cast<unsigned>(frame.id));
    for (std::size_t i = 0; i < frame.size; ++i) {
      std::printf("%02x", static_cast<unsigned>(frame.data[i]));
    }
    std::printf("\n");
  }
}

auto read_frame(const std::string& line) -> CanFrame {
  std::istringstream words(line);
  unsigned id = 0;
  std::string bytes;
  words >> std::hex >> id >> bytes;
  CanFrame frame{.id = static_cast<std::uint16_t>(id), .size = static_cast<std::uint8_t>(bytes.size() / 2)};
  for (std::size_t i = 0; i < frame.size; ++i) {
    frame.data.at(i) = static_cast<std::uint8_t>(std::stoul(bytes.substr(2 * i, 2), nullptr, 16));
  }
  return frame;
}

auto run() -> int {
  CanBench bench;
  if (!bench.start()) {
    return 1;
  }
  for (std::size_t axis = 0; axis < 4; ++axis) {
    bench.io.motors[axis].angle_rad = -0.1 * static_cast<double>(axis + 1);
  }
  bench.io.current_shift_a = -0.25;
  bench.steps(300);
  print_scene("rest", bench, 0);

  bench.io.current_shift_a = 0.0;
  static_cast<void>(bench.ask("version"));
  std::size_t from = bench.chip.sent.size();
  static_cast<void>(bench.ask("arm"));
  bench.steps(100);
  print_scene("armed", bench, from);

  from = bench.chip.sent.size();
  for (std::string line; std::getline(std::cin, line);) {
    bench.chip.arrive(read_frame(line));
    bench.step();
  }
  print_scene("stream", bench, from);

  from = bench.chip.sent.size();
  bench.io.estop = true;
  bench.steps(2);
  bench.io.encoder = Quality::kMissing;
  bench.steps(250);
  print_scene("stopped", bench, from);
  return 0;
}

}  // namespace
}  // namespace capstan::stm32f405

int main() {
  return capstan::stm32f405::run();
}
