// SPDX-License-Identifier: Apache-2.0
// tracking_check RECORD CONSOLE: were the estimates that the emulated board printed while it moved a simulated joint
// those of this machine, to the last bit? RECORD is what the plant answered in each cycle (capstan_plant --record),
// CONSOLE what the board said: its parameters ("set ..."), `status` before and after `zero joint0 0`, and logs of joint
// 0. The law begins anew in the cycle that took the `zero`, which lies between the two answers to `status`; every cycle
// between them is tried.
#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "capstan/boards/stm32f405/board.hpp"
#include "capstan/firmware/loop/cycle.hpp"
#include "capstan/firmware/parameters/parameters.hpp"

namespace {

using namespace capstan;
using stm32f405::kAxes;

struct Logged {
  std::int64_t tick = 0;
  Q24 q1, tau, q2;
};

/// What the console said.
struct Console {
  Config<kAxes> config{};
  std::int64_t zero_after = -1;   ///< tick before the `zero`
  std::int64_t zero_before = -1;  ///< tick after it
  std::vector<Logged> log;
};

auto number_after(const std::string& line, const std::string& key) -> std::int64_t {
  const std::size_t at = line.find(key);
  return at == std::string::npos ? -1 : std::atoll(line.c_str() + at + key.size());
}

/// "set joint0.group.name value" into the configuration; anything it does not know ends the program.
void set(Config<kAxes>& config, const std::string& line) {
  std::istringstream words(line.substr(line.find("set ") + 4));
  std::string name;
  double value = 0.0;
  const bool whole = static_cast<bool>(words >> name >> value) && name.starts_with("joint0.");
  const ParameterInfo* parameter = whole ? find_parameter(name.substr(7)) : nullptr;
  if (parameter == nullptr) {
    std::fprintf(stderr, "%s: this is no parameter of joint 0\n", line.c_str());
    std::exit(2);
  }
  set_raw_value(config[0], *parameter, Q24::from_double(value).raw());
}

auto read_console(std::istream& in) -> Console {
  Console console;
  bool zeroed = false;
  for (std::string line; std::getline(in, line);) {
    if (line.find("set joint") != std::string::npos && line.find("error") == std::string::npos) {
      set(console.config, line);
    } else if (line.find("zero joint0 0") != std::string::npos) {
      zeroed = true;
    } else if (const std::int64_t tick = number_after(line, " cycles "); tick >= 0 && line.starts_with("state ")) {
      if (!zeroed) {
        console.zero_after = tick;
      } else if (console.zero_before < 0) {
        console.zero_before = tick;
      }
    } else if (!line.empty() && std::isdigit(static_cast<unsigned char>(line[0])) != 0) {
      std::array<double, 4> values{};
      std::istringstream fields(line);
      std::string field;
      for (double& value : values) {
        std::getline(fields, field, ',');
        value = std::atof(field.c_str());  // printed so that it reads back as the same number
      }
      console.log.push_back({static_cast<std::int64_t>(values[0] * 1000.0 + 0.5), Q24::from_double(values[1]),
                             Q24::from_double(values[2]), Q24::from_double(values[3])});
    }
  }
  return console;
}

auto read_record(std::istream& in) -> std::vector<Sensed<kAxes>> {
  std::vector<Sensed<kAxes>> cycles;
  for (std::string line; std::getline(in, line);) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream fields(line);
    std::int64_t number = 0;
    fields >> number;
    Sensed<kAxes> sensed;
    for (AxisSensed& axis : sensed.axis) {
      std::int32_t current = 0;
      std::int32_t drive = 0;
      int encoder_quality = 0;
      int current_quality = 0;
      int on = 0;
      fields >> axis.encoder_counts >> current >> encoder_quality >> current_quality >> drive >> on;
      axis.current_a = Q24::from_raw(current);
      axis.encoder = static_cast<Quality>(encoder_quality);
      axis.current = static_cast<Quality>(current_quality);
    }
    if (!fields) {
      break;  // the plant was stopped within a line
    }
    cycles.push_back(sensed);
  }
  return cycles;
}

/// How many logged estimates agree, up to the first that does not, if the board's tick is the record's line + `offset`
/// and the zero was taken at `zero_tick`.
auto agreeing(const Console& console, const std::vector<Sensed<kAxes>>& record, std::int64_t offset,
              std::int64_t zero_tick) -> std::size_t {
  CycleState<kAxes> state(console.config);
  std::size_t next = 0;
  for (std::size_t line = 0; line < record.size() && next < console.log.size(); ++line) {
    Command<kAxes> command;
    const std::int64_t tick = static_cast<std::int64_t>(line) + offset;
    if (tick == zero_tick) {
      command.axis[0].kind = Request::Kind::kZero;
    }
    static_cast<void>(cycle(state, record[line], command));
    if (tick == console.log[next].tick) {
      const AxisTelemetry& axis = state.axis[0].telemetry();
      const Logged& logged = console.log[next];
      if (axis.q1_rad != logged.q1 || axis.tau_nm != logged.tau || axis.q2_rad != logged.q2) {
        return next;
      }
      ++next;
    }
  }
  return next;
}

/// The one shift for which every logged torque is that of its cycle: the noise of the current sensor never repeats.
auto find_offset(const Console& console, const std::vector<Sensed<kAxes>>& record) -> std::optional<std::int64_t> {
  const Q24 scale = console.config[0].motor.torque_per_current_nm_per_a;
  for (std::int64_t offset = 0; offset < 5000; ++offset) {
    const bool fits = std::all_of(console.log.begin(), console.log.end(), [&](const Logged& logged) {
      const std::int64_t line = logged.tick - offset;
      return line >= 0 && line < static_cast<std::int64_t>(record.size()) &&
             record[static_cast<std::size_t>(line)].axis[0].current_a * scale == logged.tau;
    });
    if (fits) {
      return offset;
    }
  }
  return {};
}

}  // namespace

int main(int count, char** words) {
  if (count != 3) {
    std::fprintf(stderr, "two arguments are needed: RECORD CONSOLE\n");
    return 2;
  }
  std::ifstream record_file(words[1]);
  std::ifstream console_file(words[2]);
  const Console console = read_console(console_file);
  const std::vector<Sensed<kAxes>> record = read_record(record_file);
  if (console.log.size() < 100 || record.size() < 1000 || console.zero_after < 0 || console.zero_before < 0) {
    std::fprintf(stderr, "too little to compare: %zu logged samples, %zu cycles\n", console.log.size(), record.size());
    return 1;
  }
  const auto offset = find_offset(console, record);
  if (!offset) {
    std::fprintf(stderr, "the logged torques are not those of the plant at any shift\n");
    return 1;
  }
  std::size_t best = 0;
  for (std::int64_t tick = console.zero_after; tick <= console.zero_before + 1; ++tick) {
    best = std::max(best, agreeing(console, record, *offset, tick));
  }
  const auto [low, high] = std::minmax_element(console.log.begin(), console.log.end(),
                                               [](const Logged& a, const Logged& b) { return a.q2 < b.q2; });
  std::printf("tracking: %zu of %zu logged samples over %.1f s agree bit for bit, joint from %.3f to %.3f rad\n", best,
              console.log.size(), static_cast<double>(console.log.back().tick - console.log.front().tick) / 1000.0,
              low->q2.to_double(), high->q2.to_double());
  return best == console.log.size() && high->q2.to_double() - low->q2.to_double() > 0.5 ? 0 : 1;
}
