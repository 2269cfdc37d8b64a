// SPDX-License-Identifier: Apache-2.0
// Makes a run to replay: replay_fixture SECONDS INPUT EXPECTED. The firmware's cycle controls the simulated plant, with
// every effect of its law switched on, through moves, streamed references and every kind of sensor trouble. INPUT gets
// what the cycle was given, EXPECTED what this machine's cycle made of it when it replayed that file. Status 1 when the
// run did not visit all it is meant to visit, since a comparison of idle cycles would prove nothing.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "boards/stm32f405/cycle_replay.hpp"
#include "hal/sim/plant.hpp"
#include "hal/sim/sim_io.hpp"

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

/// A law in which no term is idle.
auto lively_config() -> AxisConfig {
  AxisConfig config;
  const auto set = [&config](const char* name, double value) {
    const ParameterInfo* parameter = find_parameter(name);
    if (parameter == nullptr) {
      std::fprintf(stderr, "%s: the firmware has no such parameter any more; change replay_fixture.cpp\n", name);
      std::exit(1);
    }
    set_raw_value(config, *parameter, Q24::from_double(value).raw());
  };
  set("motor_angle.beta", 0.97);
  set("joint_offset.offset", 0.012);
  set("tendon_elongation.top", -0.11);
  set("tendon_elongation.bottom", -0.09);
  set("transmission_viscous.top", -0.004);
  set("transmission_viscous.bottom", -0.006);
  set("pretension_offset.contrast", 0.008);
  set("play.gain", 0.05);
  set("play.half_width", 0.01);
  set("transport_delay.delay", 0.03);
  set("control.torque_forward", 0.05);
  set("control.torque_backward", -0.04);
  return config;
}

/// What the operator does and what goes wrong, by cycle.
class Story {
 public:
  void tell(std::uint32_t cycle, ReplayInput& input) {
    const std::uint32_t second = cycle / 1000;
    const std::uint32_t within = cycle % 1000;
    AxisCommand& command = input.command.axis[0];
    if (within == 0) {
      input.command.disarm = second % 4 == 0;     // clears what the last story left latched
    } else if (within == 1 && second % 4 == 0) {  // and a jump's loss of position; the motor is where its encoder says
      constexpr double kRadPerCount = 6.283185307179586 / 40960.0;
      command = {AxisCommand::Kind::kZero, Q24::from_double(kRadPerCount * input.sensed.axis[0].encoder_counts), {}};
    } else if (within == 2) {
      input.command.arm = second % 4 == 0;
    } else if (within == 20) {
      command = {AxisCommand::Kind::kMove, angle(1.2), Q24::from_double(1.5)};
    } else if (second % 4 == 1 && within > 200) {
      command = {AxisCommand::Kind::kFollow, Q24::from_double(0.8 * std::sin(0.01 * within)), {}};
    } else if (within == 700) {
      command.kind = AxisCommand::Kind::kStop;
    }
    if (second % 4 == 3) {
      trouble(second, within, input);
    }
  }

 private:
  auto angle(double half_range) -> Q24 {
    return Q24::from_double(std::uniform_real_distribution<double>(-half_range, half_range)(random_));
  }

  void trouble(std::uint32_t second, std::uint32_t within, ReplayInput& input) {
    AxisSensed& sensed = input.sensed.axis[0];
    if (within < 500 || within > 505) {
      return;
    }
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
  unsigned limits = 0;
  double travel_rad = 0.0;

  void note(const CycleState<1>& state) {
    const AxisTelemetry& axis = state.axis[0].telemetry();
    states.insert(state.telemetry.state);
    faults.insert(state.telemetry.first_fault);
    limits |= axis.limits;
    const double moved = std::abs((axis.q2_rad - last_q2).to_double());
    travel_rad += moved < 0.01 ? moved : 0.0;  // more in a millisecond is one of the story's jumps
    last_q2 = axis.q2_rad;
  }
  [[nodiscard]] auto enough(std::uint32_t seconds) const -> bool {
    return states.size() == kStateNames.size() && travel_rad > 0.2 * seconds && (seconds < 32 || faults.size() >= 5) &&
           limits != 0;
  }
  Q24 last_q2;
};

auto record(std::uint32_t seconds, const std::string& path, Visited& visited) -> bool {
  OutputFile file(path);
  const Config<1> config{lively_config()};
  std::vector<std::uint8_t> head(8 + 4 * parameters().size());
  stm32f405::detail::ByteWriter header(head);
  header.u32(kReplayMagic);
  header.u32(static_cast<std::uint32_t>(parameters().size()));
  for (const ParameterInfo& parameter : parameters()) {
    header.u32(static_cast<std::uint32_t>(raw_value(config[0], parameter)));
  }
  bool good = file.write(head);

  sim::Plant plant(sim::PlantParameters{}, 5);
  SimIo io(plant);
  CycleState<1> state(config);
  Story story;
  ReplayInput input;
  for (std::uint32_t cycle_count = 0; good && cycle_count < seconds * 1000; ++cycle_count) {
    const std::uint32_t overruns = input.sensed.overruns;
    input = {};
    input.sensed.overruns = overruns;
    static_cast<void>(io.read(input.sensed));
    input.sensed.overruns = overruns;
    story.tell(cycle_count, input);
    std::array<std::uint8_t, kInputSize> bytes{};
    encode(input, bytes);
    const Drive<1> drive = cycle(state, input.sensed, input.command);
    visited.note(state);
    good = file.write(bytes) && io.write(drive) == Status::kOk;
  }
  return good;
}

}  // namespace

int main(int count, char** words) {
  if (count != 4) {
    std::fprintf(stderr, "three arguments are needed: SECONDS INPUT EXPECTED\n");
    return 2;
  }
  const auto seconds = static_cast<std::uint32_t>(std::strtoul(words[1], nullptr, 10));
  Visited visited;
  if (!record(seconds, words[2], visited)) {
    std::fprintf(stderr, "%s: the run could not be recorded; is the disk full?\n", words[2]);
    return 1;
  }
  std::printf("fixture: %u s, %zu states, %zu kinds of fault, joint travel %.1f rad\n", seconds, visited.states.size(),
              visited.faults.size(), visited.travel_rad);
  if (!visited.enough(seconds)) {
    std::fprintf(stderr, "the run visited too little to prove anything; look at Story in replay_fixture.cpp\n");
    return 1;
  }
  InputFile input(words[2]);
  OutputFile output(words[3]);
  NoMeter meter;
  return static_cast<int>(replay(input, output, meter));
}
