// SPDX-License-Identifier: Apache-2.0
// The simulated plant at the end of the emulated board's second serial port: plant_over_socket SOCKET [CYCLES]. Ends
// when the emulator closes the line, or leaves by itself after that many cycles, with a summary on standard output;
// status 2 when the line cannot be opened, 1 when the plant diverged.
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <span>
#include <string>
#include <thread>

#include "hal/plant_link/plant_server.hpp"
#include "hal/sim/plant.hpp"
#include "hal/sim/sim_io.hpp"

namespace {

/// Waits for the emulator to open its end. -1: it did not within ten seconds.
auto connect_to(const std::string& path) -> int {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof address.sun_path) {
    return -1;
  }
  std::memcpy(address.sun_path, path.c_str(), path.size() + 1);
  for (int attempt = 0; attempt < 1000; ++attempt) {
    const int line = socket(AF_UNIX, SOCK_STREAM, 0);
    if (line >= 0 && connect(line, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) {
      return line;
    }
    if (line >= 0) {
      close(line);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return -1;
}

auto send_all(int line, std::span<const std::uint8_t> bytes) -> bool {
  while (!bytes.empty()) {
    const ssize_t sent = send(line, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent <= 0) {
      return false;
    }
    bytes = bytes.subspan(static_cast<std::size_t>(sent));
  }
  return true;
}

}  // namespace

int main(int count, char** words) {
  if (count != 2 && count != 3) {
    std::fprintf(
        stderr,
        "the emulator's socket is needed, and a number of cycles may follow; see tools/qemu_stm32f405 --help\n");
    return 2;
  }
  const std::uint64_t cycles = count == 3 ? std::strtoull(words[2], nullptr, 10) : UINT64_MAX;
  const int line = connect_to(words[1]);
  if (line < 0) {
    std::fprintf(stderr, "%s: nobody answers there; start the emulator with --plant %s\n", words[1], words[1]);
    return 2;
  }
  capstan::sim::Plant plant(capstan::sim::PlantParameters{}, 1);
  capstan::SimIo io(plant);
  capstan::plant_link::PlantServer<capstan::SimIo> server(io);
  capstan::plant_link::PlantServer<capstan::SimIo>::Answer answer;
  std::array<std::uint8_t, 4096> bytes{};
  bool open = true;
  while (open) {
    const ssize_t received = recv(line, bytes.data(), bytes.size(), 0);
    open = received > 0;
    for (ssize_t i = 0; open && i < received; ++i) {
      if (server.take(bytes[static_cast<std::size_t>(i)], answer)) {
        open = server.steps() < cycles && send_all(line, answer.view());
      }
    }
  }
  close(line);
  std::printf("plant: %llu cycles, motor %.6f rad, joint %.6f rad\n", static_cast<unsigned long long>(server.steps()),
              plant.truth().q1_rad, plant.truth().q2_rad);
  if (!io.failure().empty()) {
    std::fprintf(stderr, "the plant diverged: %s\n", io.failure().c_str());
    return 1;
  }
  return 0;
}
