// SPDX-License-Identifier: Apache-2.0
#include "boards/sim/sim_board.hpp"

#include <algorithm>
#include <stdexcept>

namespace capstan {

auto MemoryBanks::do_erase(int bank) -> bool {
  banks_[static_cast<std::size_t>(bank)] = Bank{};
  return true;
}

auto MemoryBanks::do_write(int bank, std::size_t offset, std::span<const std::uint8_t> bytes) -> bool {
  auto& memory = banks_[static_cast<std::size_t>(bank)].bytes;
  if (offset + bytes.size() > memory.size()) {
    return false;
  }
  std::copy(bytes.begin(), bytes.end(), memory.begin() + static_cast<std::ptrdiff_t>(offset));
  return true;
}

auto MemoryBanks::do_read(int bank, std::size_t offset, std::span<std::uint8_t> bytes) -> bool {
  const auto& memory = banks_[static_cast<std::size_t>(bank)].bytes;
  if (offset + bytes.size() > memory.size()) {
    return false;
  }
  std::copy_n(memory.begin() + static_cast<std::ptrdiff_t>(offset), bytes.size(), bytes.begin());
  return true;
}

SimBoard::SimBoard(const sim::Scenario& scenario, Banks& banks, TextSink& sink, bool echo)
    : plant_(scenario.plant, scenario.seed),
      io_(plant_),
      application_(io_, banks),
      shell_(application_, sink, "sim", echo) {
  for (const sim::Fault& fault : scenario.faults) {
    plant_.schedule(fault);
  }
}

void SimBoard::tick(std::optional<double> reference_rad) {
  Application<SimIo>::Streamed streamed{};
  if (reference_rad) {
    streamed[0] = {AxisCommand::Kind::kFollow, Q24::from_double(*reference_rad), {}};
  }
  application_.rt_tick(streamed);
  if (!io_.failure().empty()) {
    throw std::runtime_error(io_.failure());
  }
}

}  // namespace capstan
