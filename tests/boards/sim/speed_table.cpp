// SPDX-License-Identifier: Apache-2.0
// How fast the sim board runs: simulated over processor time, firmware included, by axes and elements per tendon.
// `sim_speed_table [SECONDS]` prints the table; SECONDS of the joint are run for each entry (default 3).
// `sim_speed_table --check` fails if one axis is slower than 50 times real time, or four slower than 12.
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <span>
#include <string_view>
#include <vector>

#include "capstan/boards/common/file_banks.hpp"
#include "capstan/boards/sim/sim_board.hpp"

namespace {

using namespace capstan;

class NoText final : public TextSink {
 private:
  void do_write(std::string_view) override {}
};

/// Axes whose tendons pass the joint of the one before.
auto scenario_of(int axes, int elements) -> sim::Scenario {
  sim::Scenario scenario;
  scenario.plant.element_count = elements;
  for (int i = 1; i < axes; ++i) {
    sim::OtherAxis axis;
    axis.joint.plant = scenario.plant;
    axis.joint.carried_radius_m.assign(static_cast<std::size_t>(axes), 0.0);
    axis.joint.carried_radius_m[static_cast<std::size_t>(i) - 1] = 1.6e-3;
    scenario.other_axes.push_back(axis);
  }
  return scenario;
}

void say(SimBoard& board, std::string_view line) {
  for (const char c : line) {
    board.shell().receive(c);
  }
  while (board.shell().busy()) {
    board.tick();
    board.shell().poll();
  }
}

/// 0.5 rad at 0.5 Hz under the firmware: reversals, sliding, sticking. 0: the firmware took the torque away.
auto times_real(int axes, int elements, double seconds) -> double {
  NoText nobody;
  FileBanks banks = FileBanks::temporary();
  SimBoard board(scenario_of(axes, elements), banks, nobody, false);
  board.tick();
  say(board, "arm\n");
  std::vector<double> wanted(static_cast<std::size_t>(axes));
  const std::clock_t start = std::clock();
  for (int i = 0; i < static_cast<int>(1000.0 * seconds); ++i) {
    for (int axis = 0; axis < axes; ++axis) {
      const double t = 0.001 * i;
      wanted[static_cast<std::size_t>(axis)] = 0.5 * std::sin(3.14159265358979 * t) * (axis % 2 == 0 ? 1.0 : -1.0);
    }
    board.tick(wanted);
  }
  const double took = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  return energised(board.machine().telemetry().state) ? seconds / took : 0.0;
}

auto fast_enough(int axes, double at_least) -> bool {
  constexpr int kElements = 16;
  const double times = times_real(axes, kElements, 3.0);
  std::printf("%d %s, %d elements per tendon: %.0f times real time (at least %.0f)\n", axes,
              axes == 1 ? "axis" : "axes", kElements, times, at_least);
  return times >= at_least;
}

void print_table(double seconds) {
  std::printf("simulated over processor time, firmware included\nelements");
  for (int axes = 1; axes <= 4; ++axes) {
    std::printf("%10d %s", axes, axes == 1 ? "axis" : "axes");
  }
  std::printf("\n");
  for (const int elements : {4, 8, 16, 32, 64}) {
    std::printf("%8d", elements);
    for (int axes = 1; axes <= 4; ++axes) {
      std::printf("%15.0f", times_real(axes, elements, seconds));
      std::fflush(stdout);
    }
    std::printf("\n");
  }
}

}  // namespace

int main(int count, char** words) {
  if (count == 2 && std::string_view(words[1]) == "--check") {
    const bool one = fast_enough(1, 50.0);
    return fast_enough(4, 12.0) && one ? 0 : 1;
  }
  const double seconds = count > 1 ? std::strtod(words[1], nullptr) : 3.0;
  if (count > 2 || !(seconds >= 0.1 && seconds <= 1000.0)) {
    std::fprintf(stderr, "give --check, or the seconds to run for each entry, 0.1 to 1000\n");
    return 2;
  }
  print_table(seconds);
  return 0;
}
