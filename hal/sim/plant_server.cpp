// SPDX-License-Identifier: Apache-2.0
#include "capstan/hal/sim/plant_server.hpp"

#include <unistd.h>

#include <array>
#include <cerrno>
#include <ostream>
#include <span>
#include <stdexcept>

#include "capstan/hal/plant_link/plant_server.hpp"
#include "capstan/hal/sim/multi_plant.hpp"
#include "capstan/hal/sim/sim_io.hpp"

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

/// Passes everything on and writes down each cycle: its number, then for each axis encoder counts, current as Q24,
/// their qualities, set value as Q24 and whether it is on. The sensed values are those that answer the drive beside
/// them.
template <JointIo Io>
class RecordingIo {
 public:
  static constexpr std::size_t kAxes = Io::kAxes;
  RecordingIo(Io& io, std::ostream* record) : io_(io), record_(record) { note({}); }

  auto read(Sensed<kAxes>& sensed) noexcept -> Status { return io_.read(sensed); }
  auto write(const Drive<kAxes>& drive) noexcept -> Status {
    const Status status = io_.write(drive);
    if (status == Status::kOk)
      note(drive);
    return status;
  }
  void release() noexcept { io_.release(); }
  [[nodiscard]] const std::string& failure() const { return io_.failure(); }

 private:
  void note(const Drive<kAxes>& drive) noexcept {
    Sensed<kAxes> sensed;
    if (record_ == nullptr || io_.read(sensed) != Status::kOk)
      return;
    *record_ << cycle_++;
    for (std::size_t i = 0; i < kAxes; ++i) {
      const AxisSensed& axis = sensed.axis[i];
      *record_ << ',' << axis.encoder_counts << ',' << axis.current_a.raw() << ',' << static_cast<int>(axis.encoder)
               << ',' << static_cast<int>(axis.current) << ',' << drive.axis[i].current_a.raw() << ','
               << static_cast<int>(drive.axis[i].enabled);
    }
    *record_ << '\n';
  }

  Io& io_;
  std::ostream* record_;
  std::uint64_t cycle_ = 0;
};

template <JointIo Io>
std::uint64_t serve_io(int file, Io& inner, const ServeOptions& options) {
  RecordingIo<Io> io(inner, options.record);
  plant_link::PlantServer<RecordingIo<Io>> server(io);
  typename plant_link::PlantServer<RecordingIo<Io>>::Answer answer;
  std::array<std::uint8_t, 4096> bytes{};
  while (true) {
    const ssize_t received = ::read(file, bytes.data(), bytes.size());
    if (received < 0 && errno == EINTR)
      continue;
    if (received <= 0)
      return server.steps();
    for (const std::uint8_t byte : std::span(bytes).first(static_cast<std::size_t>(received))) {
      if (server.take(byte, answer) && (server.steps() >= options.most_cycles || !write_all(file, answer.view())))
        return server.steps();
      if (!io.failure().empty())
        return server.steps();
    }
  }
}

template <std::size_t Axes>
ServeReport serve_several(int file, const Scenario& scenario, const ServeOptions& options) {
  MultiPlant plant(scenario);
  MultiSimIo<Axes> io(plant);
  const std::uint64_t cycles = serve_io(file, io, options);
  return {cycles, plant.truth(0).q2_rad, io.failure()};
}

ServeReport serve_one(int file, const Scenario& scenario, const ServeOptions& options) {
  Plant plant(scenario.plant, scenario.seed);
  for (const Fault& fault : scenario.faults)
    plant.schedule(fault);
  SimIo io(plant);
  const std::uint64_t cycles = serve_io(file, io, options);
  return {cycles, plant.truth().q2_rad, io.failure()};
}

}  // namespace

ServeReport serve(int file, const Scenario& scenario, std::size_t board_axes, const ServeOptions& options) {
  if (board_axes == 1 && scenario.other_axes.empty())
    return serve_one(file, scenario, options);
  switch (board_axes) {
    case 1:
      return serve_several<1>(file, scenario, options);
    case 2:
      return serve_several<2>(file, scenario, options);
    case 3:
      return serve_several<3>(file, scenario, options);
    case 4:
      return serve_several<4>(file, scenario, options);
    default:
      throw std::invalid_argument("a board has 1 to 4 axes; correct the number");
  }
}

}  // namespace capstan::sim
