// SPDX-License-Identifier: Apache-2.0
// What the diagnosis makes of plants that share no formula with the laws: see tools/plant_benchmark.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

#include "capstan/tests/tools/plant/coulomb_joint.hpp"
#include "capstan/tests/tools/plant/hybrid.hpp"
#include "capstan/tests/tools/plant/independent_joint.hpp"
#include "capstan/tests/tools/plant/plant_gauge.hpp"
#include "capstan/tests/tools/plant/plant_health.hpp"
#include "capstan/tests/tools/plant/plant_joint.hpp"
#include "capstan/tests/tools/plant/told_torques.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools::plant {
namespace {

struct Options : EffectOptions {
  bool gauge = false, hybrid = false, health = false, error_bars = false, torque_error_bars = false,
       all_motions = false, independent = false, coulomb = false;
};

/// The joints of one seed, one per motion.
auto drawn_joints(std::uint64_t seed, const Options& options) -> std::vector<std::unique_ptr<SwitchedJoint>> {
  std::vector<std::unique_ptr<SwitchedJoint>> joints;
  if (options.independent) {
    joints.push_back(switched_independent_joint(seed));
    return joints;
  }
  if (options.coulomb) {
    joints.push_back(switched_coulomb_joint(seed));
    return joints;
  }
  for (const PlantMotion motion : kPlantMotions) {
    if (motion == PlantMotion::kIdentify || options.all_motions) {
      joints.push_back(switched_joint(seed, motion));
    }
  }
  return joints;
}

/// What a board says of tendons that fail while it watches.
void ask_boards(const Options& options) {
  Confusion confusion;
  std::vector<double> tension_errors;
  int right = 0, all = 0, silent = 0, healthy = 0;
  for (int i = 0; i < options.joints; ++i) {
    const std::uint64_t seed = options.seed + static_cast<std::uint64_t>(i);
    for (const std::string model : {"pseudo_kinematic", "tendon"}) {
      try {
        const WatchedJoint joint(drawn_plant(seed), seed, model);
        for (const TendonFault& fault : tendon_faults()) {
          for (const bool sensor : {true, false}) {
            const HealthAnswer answer = joint.watch(fault.name, sensor, 20.0, 100 * seed);
            const TendonHealth wanted = sensor ? fault.cause : fault.blind;
            const std::string truth =
                (fault.name.empty() ? "healthy" : fault.name) + (sensor ? ", sensor" : ", torque");
            ++confusion[truth][info(answer.health).name];
            const bool is_right = answer.health == wanted;
            (wanted == TendonHealth::kNothing ? silent : right) += is_right ? 1 : 0;
            ++(wanted == TendonHealth::kNothing ? healthy : all);
            if (fault.name == "loose") {
              tension_errors.push_back(std::abs(answer.tension / answer.true_tension - 1.0));
            }
            if (options.verbose) {
              std::printf("seed %llu %s %s: %s after %.1f s, tension %.3f of %.3f, warnings %u%s\n",
                          static_cast<unsigned long long>(seed), model.c_str(), truth.c_str(), info(answer.health).name,
                          answer.after_s, answer.tension, answer.true_tension, answer.warnings,
                          is_right ? "" : " WRONG");
              std::fflush(stdout);
            }
          }
        }
      } catch (const std::exception& error) {
        std::printf("seed %llu %s: %s\n", static_cast<unsigned long long>(seed), model.c_str(), error.what());
      }
    }
  }
  std::printf("right cause within 20 s: %d of %d; nothing said where nothing shows: %d of %d\n", right, all, silent,
              healthy);
  if (!tension_errors.empty()) {
    std::sort(tension_errors.begin(), tension_errors.end());
    std::printf("tension of a loose joint: off by %.1f %% in the median, %.1f %% at most\n",
                100.0 * tension_errors[tension_errors.size() / 2], 100.0 * tension_errors.back());
  }
  print(confusion);
}

}  // namespace
}  // namespace capstan::tools::plant

auto main(int argc, char** argv) -> int {
  CLI::App app("What the diagnosis makes of simulated joints with an effect that it is not told");
  capstan::tools::plant::Options options;
  app.add_option("--seed", options.seed, "of the first joint (default 1)");
  app.add_option("--joints", options.joints, "how many joints are drawn (default 1)");
  app.add_option("--strengths", options.strengths, "rms of an effect beside the healthy law, in camera noises");
  app.add_option("--only", options.only, "some switches only");
  app.add_option("--keep", options.keep, "folder that the logs are written to");
  app.add_flag("--health", options.health, "ask boards what became of tendons that fail while they watch");
  app.add_flag("--error-bars", options.error_bars, "how often the joint is within the error bar that a board tells");
  app.add_flag("--torque-error-bars", options.torque_error_bars,
               "the same of the joint's torque, tip held or on a spring");
  app.add_flag("--hybrid", options.hybrid, "joint angle and torque by one law, tip free, touching and held");
  app.add_flag("--gauge", options.gauge, "pretension in N and friction numbers, 3 to 30 N, and how they change");
  app.add_flag("--healthy", options.healthy, "healthy joints only");
  app.add_flag("--from-nothing", options.from_nothing, "the usual base law instead of the healthy joint's");
  app.add_flag("--compare", options.compare, "ask `capstan compare` instead");
  app.add_flag("--independent", options.independent,
               "another plant, which shares no code with hal/sim: masses, springs and bristles in laboratory motions");
  app.add_flag(
      "--coulomb", options.coulomb,
      "a third plant, which shares no code with either: tendons that stick or slide exactly, a joint with drag");
  app.add_flag("--all-motions", options.all_motions, "three motions instead of one");
  app.add_flag("--verbose", options.verbose, "a line for each joint");
  CLI11_PARSE(app, argc, argv);
  if (options.health) {
    capstan::tools::plant::ask_boards(options);
  } else if (options.error_bars) {
    capstan::tools::plant::ask_error_bars(options.seed, options.joints);
  } else if (options.torque_error_bars) {
    capstan::tools::plant::ask_torque_error_bars(options.seed, options.joints);
  } else if (options.hybrid) {
    capstan::tools::plant::ask_hybrid(options.seed, options.joints);
  } else if (options.gauge) {
    capstan::tools::plant::ask_gauges(options.seed, options.joints, options.independent);
  } else {
    capstan::tools::plant::ask_effects(
        options, [&](std::uint64_t seed) { return capstan::tools::plant::drawn_joints(seed, options); });
  }
  return 0;
}
