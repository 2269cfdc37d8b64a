// SPDX-License-Identifier: Apache-2.0
// The multiple of its gains at which a commissioned joint is promised to swing, and the one at which it does.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "capstan/tests/tools/run/drawn_joint.hpp"
#include "capstan/tests/tools/run/number_from.hpp"
#include "capstan/tools/commission/commission.hpp"
#include "capstan/tools/response/limit_cycle.hpp"
#include "capstan/tools/support/errors.hpp"

namespace capstan::tools {
namespace {

constexpr double kStep = 1.02;  // from one gain to the next

/// A joint that is commissioned, its set as the board has it, and what it goes by.
struct Ready {
  LoopGains gains;
  std::optional<LimitCycle> promised;
  double motor_rad_s = 0.0;  ///< of the log
};

/// Throws Refusal with its sentence where the joint is not commissioned.
auto commissioned(SimShell& line, const sim::PlantParameters& plant) -> Ready {
  for (const std::string& one : data_sheet(plant)) {
    line.ask(one);
  }
  for (int i = 0; i < 40; ++i) {
    line.ask("log joint0 50 10");  // what fell, fell
  }
  const Operator person{.tell = [](const std::string&) {},
                        .agrees = [](const std::string&) { return true; },
                        .keep = [](int, const Progress&) {}};
  const Commissioned all = commission(
      line, person,
      {.axis = 0, .corridor_rad = 1.0, .inertia_kgm2 = plant.motor_inertia_kgm2, .key = {}, .saves = false}, {});
  std::string dump;
  for (const std::string& one : line.ask("dump")) {
    dump += one + "\n";
  }
  const LoopGains gains = read_gains(dump, 0);
  return {gains, predict_limit_cycle(*all.response, gains), all.response->motor_speed_rad_s};
}

struct Window {
  double speed = 0.0, hz = 0.0;
};

/// The motor about its way in windows of 100 ms, from 600 ms after a turn on; by the plant, not by the encoder.
auto windows_of(const std::vector<double>& reference, const std::vector<double>& speed) -> std::vector<Window> {
  std::vector<Window> windows;
  std::size_t steady = 0;
  for (std::size_t i = 2; i < reference.size(); ++i) {
    const double now = reference[i] - reference[i - 1];
    const double turn = now - (reference[i - 1] - reference[i - 2]);
    steady = std::fabs(now) > 5e-6 && std::fabs(turn) < 3e-7 ? steady + 1 : 0;
    if (steady <= 600 || steady % 100 != 0) {
      continue;
    }
    double mean = 0.0;
    double power = 0.0;
    int risings = 0;
    for (std::size_t k = i - 99; k <= i; ++k) {
      mean += speed[k] / 100.0;
    }
    for (std::size_t k = i - 99; k <= i; ++k) {
      power += std::pow(speed[k] - mean, 2) / 100.0;
      risings += k > i - 99 && speed[k - 1] < mean && speed[k] >= mean ? 1 : 0;
    }
    windows.push_back({std::sqrt(2.0 * power), risings / 0.1});
  }
  return windows;
}

/// Twice to and fro at the log's speed.
auto legs(SimShell& line, double joint_rad_s) -> std::vector<Window> {
  line.ask("disarm");
  line.ask("arm");
  for (const char c : "experiment joint0 speed_ladder amplitude=0.5 speeds=" + rounded(joint_rad_s, 4) +
                          " cycles=2 offset=0 every=50\n") {
    line.board().shell().receive(c);
  }
  std::vector<double> reference;
  std::vector<double> speed;
  line.board().tick();
  line.board().shell().poll();
  while (line.board().shell().busy() && reference.size() < 60'000) {
    line.board().tick();
    line.board().shell().poll();
    reference.push_back(line.board().machine().axis_telemetry(0).q2_reference_rad.to_double());
    speed.push_back(line.board().truth(0).q1_rate_rad_per_s);
  }
  return windows_of(reference, speed);
}

struct Seen {
  double onset = 0.0, hz = 0.0;  ///< swings most of the time
  double burst = 0.0;            ///< once at least
};

/// Gains raised until the joint swings by more than half of its way's speed. The observer is off, for it takes the
/// torque from a joint that swings; its limit of the current's rate stays.
auto raised(SimShell& line, const sim::PlantParameters& plant, const Ready& ready) -> Seen {
  line.ask("maintenance open");
  line.ask("set joint0.limits.current_rate " + rounded(ready.gains.rate_nm / plant.torque_constant_nm_per_a) +
           " A/cycle");
  line.ask("set joint0.observer.inertia 0");
  line.ask("set joint0.limits.joint_speed 10");  // bursts of an elbow are overspeed
  Seen seen;
  // Bursts, which a table has beside it, come sooner.
  const double from = std::getenv("CAPSTAN_PLANTS") == nullptr ? 0.85 : 0.45;
  for (double factor = from * ready.promised->onset; factor < 1.5 * ready.promised->smooth_onset; factor *= kStep) {
    line.ask("set joint0.control.stiffness " + rounded(factor * ready.gains.stiffness, 6));
    line.ask("set joint0.control.damping " + rounded(factor * ready.gains.damping, 7));
    std::vector<Window> windows = legs(line, ready.motor_rad_s * plant.input_radius_m / plant.output_radius_m);
    if (windows.empty()) {
      return seen;  // a fault
    }
    std::sort(windows.begin(), windows.end(), [](const Window& a, const Window& b) { return a.speed < b.speed; });
    const double half = 0.5 * ready.motor_rad_s;
    seen.burst = seen.burst == 0.0 && windows.back().speed > half ? factor : seen.burst;
    const std::size_t middle = windows.size() / 2;
    if (windows[middle].speed > half) {
      for (std::size_t i = middle; i < windows.size(); ++i) {
        seen.hz += windows[i].hz / static_cast<double>(windows.size() - middle);
      }
      seen.onset = factor;
      return seen;
    }
  }
  return seen;
}

/// For a table: CAPSTAN_SEED=4310 CAPSTAN_PLANTS=4 promised_onset_test; of one joint CAPSTAN_INSTRUMENT=raven2:1
TEST(PromisedOnset, IsWhereACommissionedJointSwings) {
  const std::uint64_t first = number_from("CAPSTAN_SEED", 4390);
  const std::uint64_t plants = number_from("CAPSTAN_PLANTS", 1);
  std::printf("joint | onset without the gate, promised, seen, bursts | Hz promised, seen\n");
  for (const char* name : {"micro_forceps:0", "da_vinci_wrist:0", "robot_finger:0", "raven2:1"}) {
    if (const char* only = std::getenv("CAPSTAN_INSTRUMENT"); only != nullptr && std::string(only) != name) {
      continue;
    }
    for (std::uint64_t seed = first; seed < first + plants; ++seed) {
      const sim::Scenario scenario = draw(seed, joint_of(name));
      SimShell line(scenario);
      try {
        const Ready ready = commissioned(line, scenario.plant);
        ASSERT_TRUE(ready.promised) << name << ' ' << seed;
        const Seen seen = raised(line, scenario.plant, ready);
        std::printf("%s %llu | %.2f %.2f %.2f %.2f | %.0f %.0f\n", name, static_cast<unsigned long long>(seed),
                    ready.promised->smooth_onset, ready.promised->onset, seen.onset, seen.burst, ready.promised->hz,
                    seen.hz);
        ASSERT_GT(seen.onset, 0.0) << name << ' ' << seed << ": a fault ended it";
        EXPECT_NEAR(ready.promised->onset, seen.onset, 0.12 * seen.onset) << name << ' ' << seed;
        EXPECT_NEAR(ready.promised->hz, seen.hz, 0.15 * seen.hz) << name << ' ' << seed;
      } catch (const Refusal& refusal) {
        std::printf("%s %llu | stopped: %s\n", name, static_cast<unsigned long long>(seed), refusal.what());
      }
      std::fflush(stdout);
    }
  }
}

}  // namespace
}  // namespace capstan::tools
