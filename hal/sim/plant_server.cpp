// SPDX-License-Identifier: Apache-2.0
#include "hal/sim/plant_server.hpp"

#include <unistd.h>

#include <array>
#include <cerrno>
#include <span>
#include <stdexcept>

#include "hal/plant_link/plant_server.hpp"
#include "hal/sim/multi_plant.hpp"
#include "hal/sim/sim_io.hpp"

namespace capstan::sim {
namespace {

bool write_all(int file, std::span<const std::uint8_t> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(file, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR)
      continue;
    if (written <= 0)
      return false;
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  return true;
}

template <JointIo Io>
std::uint64_t serve_io(int file, Io& io, std::uint64_t most_cycles) {
  plant_link::PlantServer<Io> server(io);
  typename plant_link::PlantServer<Io>::Answer answer;
  std::array<std::uint8_t, 4096> bytes{};
  while (true) {
    const ssize_t received = ::read(file, bytes.data(), bytes.size());
    if (received < 0 && errno == EINTR)
      continue;
    if (received <= 0)
      return server.steps();
    for (const std::uint8_t byte : std::span(bytes).first(static_cast<std::size_t>(received))) {
      if (server.take(byte, answer) && (server.steps() >= most_cycles || !write_all(file, answer.view())))
        return server.steps();
      if (!io.failure().empty())
        return server.steps();
    }
  }
}

template <std::size_t Axes>
ServeReport serve_several(int file, const Scenario& scenario, std::uint64_t most_cycles) {
  MultiPlant plant(scenario);
  MultiSimIo<Axes> io(plant);
  const std::uint64_t cycles = serve_io(file, io, most_cycles);
  return {cycles, plant.truth(0).q2_rad, io.failure()};
}

ServeReport serve_one(int file, const Scenario& scenario, std::uint64_t most_cycles) {
  Plant plant(scenario.plant, scenario.seed);
  for (const Fault& fault : scenario.faults)
    plant.schedule(fault);
  SimIo io(plant);
  const std::uint64_t cycles = serve_io(file, io, most_cycles);
  return {cycles, plant.truth().q2_rad, io.failure()};
}

}  // namespace

ServeReport serve(int file, const Scenario& scenario, std::size_t board_axes, std::uint64_t most_cycles) {
  if (board_axes == 1 && scenario.other_axes.empty())
    return serve_one(file, scenario, most_cycles);
  switch (board_axes) {
    case 1:
      return serve_several<1>(file, scenario, most_cycles);
    case 2:
      return serve_several<2>(file, scenario, most_cycles);
    case 3:
      return serve_several<3>(file, scenario, most_cycles);
    case 4:
      return serve_several<4>(file, scenario, most_cycles);
    default:
      throw std::invalid_argument("a board has 1 to 4 axes; correct the number");
  }
}

}  // namespace capstan::sim
