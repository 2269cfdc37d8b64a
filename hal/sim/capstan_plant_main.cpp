// SPDX-License-Identifier: Apache-2.0
// The simulated instrument as a program of its own, at the end of a line to a board.
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <stdexcept>
#include <string>

#include "capstan/hal/sim/plant_server.hpp"

namespace {

constexpr const char* kUsage =
    "Usage: capstan_plant [OPTION]... LINE\n"
    "\n"
    "Serves a simulated instrument to a board over LINE, in lock-step: one drive frame, one millisecond, one sensed "
    "frame.\n"
    "\n"
    "LINE: connect:PATH  a Unix socket that the board's emulator opens (tools/qemu_stm32f405 --plant PATH)\n"
    "      listen:PATH   a Unix socket opened here\n"
    "      tcp:PORT      a port on loopback opened here\n"
    "      pty           a terminal made here; its name is printed\n"
    "\n"
    "  --scenario FILE   instrument, effects, environment, faults and seed; its motion plays no part (default: the\n"
    "                    built-in micro-forceps)\n"
    "  --axes N          axes of the board, 1 to 4 (default: those of the instrument)\n"
    "  --cycles N        leave after that many cycles\n"
    "  --record FILE     write every cycle down: number, then for each axis counts, current, qualities, set value, on\n"
    "  --help            this text\n"
    "\n"
    "Exit status: 0 the board closed the line or the cycles are done; 1 the plant diverged; 2 wrong usage or bad "
    "input.\n";

struct Options {
  std::string line;
  std::string scenario;
  std::string record;
  std::size_t axes = 0;
  std::uint64_t cycles = UINT64_MAX;
};

std::uint64_t whole_number(const std::string& option, const char* text) {
  char* end = nullptr;
  const std::uint64_t value = std::strtoull(text, &end, 10);
  if (end == text || *end != '\0' || value == 0 || *text == '-')
    throw std::runtime_error(option + " takes a whole number from 1, not `" + text + "`; correct it");
  return value;
}

Options options_of(int count, char** words) {
  Options options;
  for (int i = 1; i < count; ++i) {
    const std::string word = words[i];
    if (word == "--scenario" || word == "--axes" || word == "--cycles" || word == "--record") {
      if (i + 1 == count)
        throw std::runtime_error(word + " needs a value; see --help");
      const char* value = words[++i];
      if (word == "--scenario")
        options.scenario = value;
      else if (word == "--record")
        options.record = value;
      else if (word == "--axes")
        options.axes = whole_number(word, value);
      else
        options.cycles = whole_number(word, value);
    } else if (options.line.empty() && !word.starts_with("--")) {
      options.line = word;
    } else {
      throw std::runtime_error("`" + word + "` is no option; see --help");
    }
  }
  if (options.line.empty())
    throw std::runtime_error("no line to a board was given; see --help");
  return options;
}

}  // namespace

int main(int count, char** words) {
  if (count == 2 && std::string(words[1]) == "--help") {
    std::fputs(kUsage, stdout);
    return 0;
  }
  // A board that closes the line ends the service by an answer that cannot be written, not by a signal.
  std::signal(SIGPIPE, SIG_IGN);
  try {
    const Options options = options_of(count, words);
    const capstan::sim::Scenario scenario =
        options.scenario.empty() ? capstan::sim::Scenario{} : capstan::sim::load_scenario(options.scenario);
    const std::size_t axes = options.axes > 0 ? options.axes : 1 + scenario.other_axes.size();
    std::ofstream record;
    if (!options.record.empty()) {
      record.open(options.record);
      if (!record)
        throw std::runtime_error(options.record + " cannot be written; give another file for --record");
    }
    const capstan::FileDescriptor line = capstan::sim::open_line(options.line);
    const capstan::sim::ServeReport report =
        capstan::sim::serve(line.get(), scenario, axes, {options.cycles, record.is_open() ? &record : nullptr});
    std::printf("plant: %llu cycles, joint %.6f rad\n", static_cast<unsigned long long>(report.cycles),
                report.first_joint_rad);
    if (record.is_open() && !record.flush())
      throw std::runtime_error(options.record + " is cut off, as the disk took no more; free some space");
    if (report.failure.empty())
      return 0;
    std::fprintf(stderr, "capstan_plant: %s\n", report.failure.c_str());
    return 1;
  } catch (const std::exception& problem) {
    std::fprintf(stderr, "capstan_plant: %s\n", problem.what());
    return 2;
  }
}
