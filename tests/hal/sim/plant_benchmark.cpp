// SPDX-License-Identifier: Apache-2.0
// What one millisecond of the plant costs, against elements per tendon and axes. Not a test; run by hand:
//   sim_plant_benchmark --benchmark_min_time=1
// The counter x_real_time is simulated time over processor time.
#include <benchmark/benchmark.h>

#include <cmath>
#include <vector>

#include "capstan/hal/sim/deterministic_math.hpp"
#include "capstan/hal/sim/multi_plant.hpp"

namespace capstan::sim {
namespace {

// A position servo on q1 following 0.5 rad at 0.5 Hz: reversals, sliding, sticking.
double servo(const Truth& t, std::size_t axis) {
  const double wanted = 0.5 * det_sin(3.14159265358979 * t.time_s + static_cast<double>(axis));
  return 20.0 * (wanted - t.q1_rad) - 0.05 * t.q1_rate_rad_per_s;
}

void report(benchmark::State& state) {
  state.counters["x_real_time"] =
      benchmark::Counter(0.001 * static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}

void one_axis(benchmark::State& state) {
  PlantParameters p;
  p.element_count = static_cast<int>(state.range(0));
  Plant plant(p, 1);
  for (auto each : state) {
    static_cast<void>(each);
    plant.step(servo(plant.truth(), 0), true);
  }
  report(state);
}

// Every axis' tendons pass the joint of the one before.
void several_axes(benchmark::State& state) {
  PlantParameters p;
  p.element_count = static_cast<int>(state.range(1));
  const auto count = static_cast<std::size_t>(state.range(0));
  std::vector<InstrumentAxis> axes(count, InstrumentAxis{"a", p, {}});
  for (std::size_t i = 1; i < count; ++i) {
    axes[i].carried_radius_m.assign(count, 0.0);
    axes[i].carried_radius_m[i - 1] = 1.6e-3;
  }
  MultiPlant plant(axes, 1);
  std::vector<MotorCommand> commands(count);
  for (auto each : state) {
    static_cast<void>(each);
    for (std::size_t i = 0; i < count; ++i)
      commands[i] = {servo(plant.truth(i), i), true};
    plant.step(commands);
  }
  report(state);
}

void drag_and_play(benchmark::State& state) {
  PlantParameters p;
  p.effects.transmission_viscous_forward_ns_per_m = p.effects.transmission_viscous_backward_ns_per_m = 1500.0;
  p.effects.play_half_width_rad = 0.03;
  Plant plant(p, 1);
  for (auto each : state) {
    static_cast<void>(each);
    plant.step(servo(plant.truth(), 0), true);
  }
  report(state);
}

BENCHMARK(one_axis)->Arg(4)->Arg(8)->Arg(16)->Arg(32)->Arg(64)->Arg(128);
BENCHMARK(several_axes)->Args({1, 16})->Args({2, 16})->Args({3, 16})->Args({4, 16})->Args({6, 16})->Args({4, 32});
BENCHMARK(drag_and_play);

}  // namespace
}  // namespace capstan::sim

BENCHMARK_MAIN();
