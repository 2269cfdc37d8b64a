// SPDX-License-Identifier: Apache-2.0
// Makes a run to replay: replay_fixture SECONDS INPUT EXPECTED [motion]. The firmware's cycle controls the simulated
// plant, with every effect of its laws switched on (`motion`: no laws of efforts, and every joint has its Preisach
// model), through moves, streamed references and every kind of sensor trouble. INPUT gets what the cycle was given,
// EXPECTED what this machine's cycle made of it when it replayed that file. Status 1 when the run did not visit all it
// is meant to visit, since a comparison of idle cycles would prove nothing.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "capstan/boards/stm32f405/board.hpp"
#include "capstan/boards/stm32f405/cycle_replay.hpp"
#include "capstan/hal/sim/plant.hpp"
#include "capstan/hal/sim/sim_io.hpp"
#include "capstan/tests/boards/stm32f405/replay_joints.hpp"

namespace {

using namespace capstan;
using namespace capstan::stm32f405;

struct InputFile {
  explicit InputFile(const std::string& path) : stream(path, std::ios::binary) {}
  auto read(std::span<std::uint8_t> bytes) -> std::size_t {
    stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    return static_cast<std::size_t>(stream.gcount());
  }
  std::ifstream stream;
};

struct OutputFile {
  explicit OutputFile(const std::string& path) : stream(path, std::ios::binary) {}
  auto write(std::span<const std::uint8_t> bytes) -> bool {
    stream.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    return stream.good();
  }
  std::ofstream stream;
};

struct NoMeter {
  void begin() {}
  void end() {}
};

using Input = ReplayInput<kAxes>;

/// What the operator does and what goes wrong, by cycle.
class Story {
 public:
  void tell(std::uint32_t cycle, Input& input) {
    const std::uint32_t second = cycle / 1000;
    const std::uint32_t within = cycle % 1000;
    input.command.disarm = within == 0 && second % 4 == 0;  // clears what the last story left latched
    input.command.arm = within == 2 && second % 4 == 0;
    input.command.experiment = presses(second, within);
    for (std::size_t i = 0; i < kAxes; ++i) {
      input.command.axis[i] = order(second, within, i, input.sensed.axis[i]);
    }
    if (second % 4 == 3) {
      trouble(second, within, input);
    }
  }

 private:
  /// An experiment drives the joints by torque, from rest.
  static auto presses(std::uint32_t second, std::uint32_t within) -> bool {
    return second % 4 == 2 && within >= 900 && within < 980;
  }

  auto order(std::uint32_t second, std::uint32_t within, std::size_t axis, const AxisSensed& sensed) -> Request {
    if (within == 1 && second % 4 == 0) {  // after a jump's loss of position; the motor is where its encoder says
      constexpr double kRadPerCount = 6.283185307179586 / 40960.0;
      return {.kind = Request::Kind::kZero, .position_rad = Q24::from_double(kRadPerCount * sensed.encoder_counts)};
    }
    if (within == 20 + axis) {
      return {.kind = Request::Kind::kMove, .position_rad = angle(1.2), .speed_rad_s = Q24::from_double(1.5)};
    }
    if (second % 4 == 1 && within > 200) {
      return {.kind = Request::Kind::kFollow,
              .position_rad = Q24::from_double(0.8 * std::sin(0.01 * within + static_cast<double>(axis)))};
    }
    if (presses(second, within)) {
      return {.kind = Request::Kind::kTorque,
              .torque_nm = Q24::from_double(0.05 * std::sin(0.1 * within + static_cast<double>(axis)))};
    }
    if (second % 4 == 0 && within == 900) {  // from rest too; a joint that nobody holds runs away, and is held
      return {.kind = Request::Kind::kForce,
              .joint_torque_nm = Q24::from_double(axis % 2 == 0 ? 0.03 : -0.03),
              .torque_rate_nm_s = Q24::from_double(0.5),
              .corridor_rad = Q24::from_double(axis < 2 ? 0.03 : 0.0)};
    }
    if (within == 700 || (second % 4 == 0 && within == 980) || (second % 4 == 2 && within == 980)) {
      return {.kind = Request::Kind::kStop};
    }
    return {};
  }

  auto angle(double half_range) -> Q24 {
    return Q24::from_double(std::uniform_real_distribution<double>(-half_range, half_range)(random_));
  }

  void trouble(std::uint32_t second, std::uint32_t within, Input& input) {
    if (within < 500 || within > 505) {
      return;
    }
    AxisSensed& sensed = input.sensed.axis[second / 4 % kAxes];
    switch (second / 4 % 7) {
      case 0:
        sensed.encoder = Quality::kMissing;
        break;
      case 1:
        sensed.current = Quality::kInvalid;
        break;
      case 2:
        sensed.encoder_counts += 1 << 20;
        break;
      case 3:
        input.sensed.estop = true;
        break;
      case 4:
        ++overruns_;
        break;
      case 5:
        sensed.encoder_counts = within % 2 == 0 ? INT32_MAX : INT32_MIN;
        break;
      default:
        sensed.current_a = Q24::lowest();
        break;
    }
    input.sensed.overruns = overruns_;
  }

  std::mt19937 random_{20};
  std::uint32_t overruns_ = 0;
};

/// What must have been seen for the comparison to mean something.
struct Visited {
  std::set<State> states;
  std::set<Fault> faults;
  std::set<ControlMode> modes;
  std::set<std::size_t> judged;  // axes, by their monitors
  unsigned limits = 0;
  std::array<double, kAxes> travel_rad{};

  void note(const CycleState<kAxes>& state) {
    states.insert(state.telemetry.state);
    faults.insert(state.telemetry.first_fault);
    for (std::size_t i = 0; i < kAxes; ++i) {
      const AxisTelemetry& axis = state.axis[i].telemetry();
      limits |= axis.limits;
      modes.insert(axis.mode);
      if (axis.misfit != Q24{}) {
        judged.insert(i);
      }
      const double moved = std::abs((axis.q2_rad - last_q2[i]).to_double());
      travel_rad[i] += moved < 0.01 ? moved : 0.0;  // more in a millisecond is one of the story's jumps
      last_q2[i] = axis.q2_rad;
    }
  }
  [[nodiscard]] auto least_travel_rad() const -> double {
    return *std::min_element(travel_rad.begin(), travel_rad.end());
  }
  [[nodiscard]] auto enough(std::uint32_t seconds) const -> bool {
    return states.size() == kStateNames.size() - 1 && least_travel_rad() > 0.2 * seconds &&
           (seconds < 32 || faults.size() >= 5) && limits != 0 && modes.size() == 3 && judged.size() == kAxes;
  }
  std::array<Q24, kAxes> last_q2{};
};

auto head_of(const Config<kAxes>& config) -> std::vector<std::uint8_t> {
  std::vector<std::uint8_t> head(12 + 4 * kAxes * parameters().size());
  stm32f405::detail::ByteWriter header(head);
  header.u32(kReplayMagic);
  header.u32(kAxes);
  header.u32(static_cast<std::uint32_t>(parameters().size()));
  for (const AxisConfig& axis : config) {
    for (const ParameterInfo& parameter : parameters()) {
      header.u32(static_cast<std::uint32_t>(raw_value(axis, parameter)));
    }
  }
  return head;
}

/// One joint for each axis, each with noise of its own.
struct Joint {
  explicit Joint(std::uint64_t seed) : plant(sim::PlantParameters{}, seed), io(plant) {}
  sim::Plant plant;
  SimIo io;
};

auto record(std::uint32_t seconds, const std::string& path, Joints kind, Visited& visited) -> bool {
  OutputFile file(path);
  Config<kAxes> config;
  std::vector<std::unique_ptr<Joint>> joints;
  for (std::size_t i = 0; i < kAxes; ++i) {
    config[i] = lively_config(i, kind);
    joints.push_back(std::make_unique<Joint>(5 + i));
  }
  bool good = file.write(head_of(config));
  CycleState<kAxes> state(config);
  Story story;
  std::uint32_t overruns = 0;
  for (std::uint32_t cycle_count = 0; good && cycle_count < seconds * 1000; ++cycle_count) {
    Input input;
    input.sensed.overruns = overruns;
    for (std::size_t i = 0; i < kAxes; ++i) {
      Sensed<1> one;
      static_cast<void>(joints[i]->io.read(one));
      input.sensed.axis[i] = one.axis[0];
    }
    story.tell(cycle_count, input);
    overruns = input.sensed.overruns;
    std::array<std::uint8_t, kInputSize<kAxes>> bytes{};
    encode<kAxes>(input, bytes);
    const Drive<kAxes> drive = cycle(state, input.sensed, input.command);
    visited.note(state);
    good = file.write(bytes);
    for (std::size_t i = 0; i < kAxes; ++i) {
      good = good && joints[i]->io.write({{drive.axis[i]}}) == Status::kOk;
    }
  }
  return good;
}

}  // namespace

int main(int count, char** words) {
  const bool motion = count == 5 && std::string(words[4]) == "motion";
  if (count != 4 && !motion) {
    std::fprintf(stderr, "three arguments are needed, a fourth is `motion`: SECONDS INPUT EXPECTED [motion]\n");
    return 2;
  }
  const auto seconds = static_cast<std::uint32_t>(std::strtoul(words[1], nullptr, 10));
  Visited visited;
  if (!record(seconds, words[2], motion ? Joints::kMotion : Joints::kEverything, visited)) {
    std::fprintf(stderr, "%s: the run could not be recorded; is the disk full?\n", words[2]);
    return 1;
  }
  std::printf(
      "fixture: %u s, %zu axes, records of %zu and %zu bytes, %zu states, %zu kinds of fault, joint travel %.1f "
      "rad\n",
      seconds, kAxes, kInputSize<kAxes>, kOutputSize<kAxes>, visited.states.size(), visited.faults.size(),
      visited.least_travel_rad());
  if (!visited.enough(seconds)) {
    std::fprintf(stderr, "the run visited too little to prove anything; look at Story in replay_fixture.cpp\n");
    return 1;
  }
  InputFile input(words[2]);
  OutputFile output(words[3]);
  NoMeter meter;
  return static_cast<int>(replay<kAxes>(input, output, meter));
}
