// SPDX-License-Identifier: Apache-2.0
// What the diagnosis makes of plants that share no formula with the laws: see tools/plant_benchmark.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

#include "capstan/hal/sim/step.hpp"
#include "capstan/tests/tools/plant/hybrid.hpp"
#include "capstan/tests/tools/plant/plant_gauge.hpp"
#include "capstan/tests/tools/plant/plant_health.hpp"
#include "capstan/tests/tools/plant/plant_joint.hpp"
#include "capstan/tests/tools/plant/told_torques.hpp"
#include "capstan/tools/diagnose/compare.hpp"
#include "capstan/tools/identify/identify.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/statistics.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools::plant {
namespace {

struct Options {
  std::uint64_t seed = 1;
  int joints = 1;
  std::vector<double> strengths = {4.0};
  std::vector<std::string> only;
  std::string keep;
  bool gauge = false, hybrid = false, health = false, healthy = false, from_nothing = false, compare = false,
       error_bars = false, torque_error_bars = false, all_motions = false, verbose = false;
};

/// What an answer says of one joint.
struct Answer {
  std::vector<std::string> named;  ///< the effects, or the parameters that moved
  std::vector<std::string> in_answer;
  double after = 0.0;  ///< over the camera's noise
  std::string verdict;
  std::optional<EffectSize> size;  ///< of the first one named
};

auto size_of(const AddedEffect& effect, const JointFile& law) -> std::optional<EffectSize> {
  if (!effect.size && effect.name == "transport_delay" && law.has(effect.name)) {
    const std::size_t at = law.catalogue->term(effect.name).first_shape;
    return EffectSize{law.parameters.shapes[at], "s", law.shape_ci95[at]};
  }
  return effect.size;
}

/// The same of the plant, where its switch means what the diagnosis says; 0 elsewhere.
auto true_size(const Switch& one, const sim::PlantParameters& plant) -> double {
  const double size = plant.effects.*one.size;
  if (one.name == "pretension_change") {
    return 1.0 + size / plant.pretension_n;
  }
  if (one.name == "transport_delay") {
    return sim::kStepS * static_cast<double>(sim::steps(size));  // the camera's value is late by whole steps
  }
  const bool alike =
      one.name == "gravity" || one.name == "load_inertia" || one.name == "presliding" || one.name == "play";
  return alike ? size : 0.0;
}

auto answer_of(const Diagnosis& d, double noise) -> Answer {
  Answer answer;
  for (const auto& effect : d.effects) {
    answer.named.push_back(effect.name);
    answer.in_answer.push_back(effect.name);
    answer.in_answer.insert(answer.in_answer.end(), effect.alternatives.begin(), effect.alternatives.end());
  }
  for (const auto& candidate : d.candidates) {
    answer.in_answer.push_back(candidate.name);
  }
  answer.after = d.after.rmse / noise;
  answer.verdict = verdict_word(d.verdict);
  if (!d.effects.empty()) {
    answer.size = size_of(d.effects.front(), d.found ? *d.found : d.law);
  }
  return answer;
}

/// rms of what an effect adds to what a law leaves: of its first and of its last answer, each with its own zero.
auto size_of_effect(const JointFile& law, const AxisLog& with, const AxisLog& without) -> double {
  const auto left = [&](const AxisLog& log) {
    const Eigen::VectorXd error = log.measured() - simulate({log}, motion_parameters(law));
    const Eigen::VectorXd centred = error.array() - error.mean();
    return rms(centred);
  };
  return std::sqrt(std::max(0.0, left(with) * left(with) - left(without) * left(without)));
}

/// The plant with a switch as far on as makes the healthy law err by so many camera noises; as far as it goes, if less.
auto with_switch(const sim::PlantParameters& healthy, const Switch& one, const JointFile& law, const AxisLog& log,
                 PlantMotion motion, std::uint64_t seed, double wanted) -> sim::PlantParameters {
  sim::PlantParameters plant = healthy;
  double size = one.usual;
  for (int round = 0; round < 4; ++round) {
    plant.effects.*one.size = size;
    if (one.name == "transmission_viscous") {
      plant.effects.transmission_viscous_backward_ns_per_m = size;
    }
    const double got = size_of_effect(law, log_of(plant, motion, seed), log);
    if (std::abs(got / wanted - 1.0) < 0.15) {
      break;
    }
    size = std::min(one.most, size * std::clamp(wanted / std::max(got, 1e-6), 0.2, 5.0));
  }
  return plant;
}

void count(std::map<std::string, std::map<std::string, int>>& confusion, const std::string& truth,
           const Answer& answer) {
  ++confusion[truth][answer.named.empty() ? answer.verdict : joined(answer.named, " + ")];
}

void print(const std::map<std::string, std::map<std::string, int>>& confusion) {
  for (const auto& [truth, answers] : confusion) {
    std::printf("  %-22s", truth.c_str());
    for (const auto& [name, times] : answers) {
      std::printf(" %s %d;", name.c_str(), times);
    }
    std::printf("\n");
  }
}

class Benchmark {
 public:
  explicit Benchmark(Options options) : options_(std::move(options)) {}

  void run() {
    for (int i = 0; i < options_.joints; ++i) {
      for (const PlantMotion motion : kPlantMotions) {
        if (motion == PlantMotion::kIdentify || options_.all_motions) {
          one_joint(options_.seed + static_cast<std::uint64_t>(i), motion);
        }
      }
    }
    summarise();
  }

 private:
  void one_joint(std::uint64_t seed, PlantMotion motion) {
    const sim::PlantParameters plant = drawn_plant(seed);
    AxisLog log;
    HealthyJoint healthy;
    try {
      log = log_of(plant, motion, seed, kept("healthy", seed, motion));
      if (options_.compare) {
        healthy = healthy_joint({log}, {});
      } else {
        healthy.diagnosis = diagnose({log}, {});
      }
    } catch (const std::exception& error) {
      std::printf("seed %llu %s: %s\n", static_cast<unsigned long long>(seed), name_of(motion).c_str(), error.what());
      ++unfit_;
      return;
    }
    const Answer answer = answer_of(healthy.diagnosis, plant.camera_noise_rad);
    ++healthy_joints_;
    healthy_unnamed_ += answer.named.empty() ? 1 : 0;
    healthy_after_.push_back(answer.after);
    count(healthy_confusion_, healthy.diagnosis.base_model, answer);
    if (options_.verbose) {
      std::printf("seed %llu %s healthy: base %s, %s %s, after over camera noise %.3f\n",
                  static_cast<unsigned long long>(seed), name_of(motion).c_str(), healthy.diagnosis.base_model.c_str(),
                  answer.verdict.c_str(), joined(answer.named).c_str(), answer.after);
      std::fflush(stdout);
    }
    for (const auto& one : switches()) {
      const bool wanted = options_.only.empty() ||
                          std::find(options_.only.begin(), options_.only.end(), one.name) != options_.only.end();
      for (const double strength : options_.strengths) {
        if (wanted && !options_.healthy) {
          one_switch(plant, one, healthy, log, motion, seed, strength);
        }
      }
    }
  }

  void one_switch(const sim::PlantParameters& plant, const Switch& one, const HealthyJoint& healthy, const AxisLog& log,
                  PlantMotion motion, std::uint64_t seed, double strength) {
    try {
      const double wanted = strength * plant.camera_noise_rad;
      const sim::PlantParameters sick = with_switch(plant, one, healthy.diagnosis.law, log, motion, seed, wanted);
      const AxisLog now = log_of(sick, motion, seed + 1, kept(one.name, seed, motion));
      const double size = size_of_effect(healthy.diagnosis.law, now, log) / plant.camera_noise_rad;
      if (size < 0.5 * strength) {
        ++too_small_[one.name];
        return;
      }
      Answer answer;
      if (options_.compare) {
        answer = answer_of(compare(healthy, {now}, {}).now, plant.camera_noise_rad);
      } else {
        DiagnoseOptions options;
        if (!options_.from_nothing) {
          options.base_model = "healthy.toml";
          options.base_law = healthy.diagnosis.law;
        }
        answer = answer_of(diagnose({now}, options), plant.camera_noise_rad);
      }
      judge(one, answer, strength, size, seed, motion);
      judge_size(one, answer, true_size(one, sick));
    } catch (const std::exception& error) {
      std::printf("%s, seed %llu: %s\n", one.name.c_str(), static_cast<unsigned long long>(seed), error.what());
      ++unfit_;
    }
  }

  [[nodiscard]] auto kept(const std::string& name, std::uint64_t seed, PlantMotion motion) const -> std::string {
    return options_.keep.empty()
               ? ""
               : options_.keep + "/" + name + "_" + std::to_string(seed) + "_" + name_of(motion) + ".csv";
  }

  void judge(const Switch& one, const Answer& answer, double strength, double size, std::uint64_t seed,
             PlantMotion motion) {
    count(confusion_, one.name, answer);
    if (one.expected.empty()) {
      ++foreign_;
      foreign_named_ += answer.named.empty() ? 0 : 1;
    } else {
      ++listed_;
      first_ += !answer.named.empty() && answer.named.front() == one.expected ? 1 : 0;
      const auto& all = answer.in_answer;
      contained_ += std::find(all.begin(), all.end(), one.expected) != all.end() ? 1 : 0;
    }
    after_.push_back(answer.after);
    if (options_.verbose) {
      std::printf("seed %llu %s %s x%g (%.1f): %s %s, after over camera noise %.3f\n",
                  static_cast<unsigned long long>(seed), name_of(motion).c_str(), one.name.c_str(), strength, size,
                  answer.verdict.c_str(), joined(answer.named).c_str(), answer.after);
      std::fflush(stdout);
    }
  }

  void judge_size(const Switch& one, const Answer& answer, double truth) {
    if (truth == 0.0 || !answer.size || answer.named.front() != one.expected) {
      return;
    }
    const double error = answer.size->value / truth - 1.0;
    size_errors_[one.name].push_back(std::abs(error));
    const auto& ci95 = answer.size->ci95;
    ++sizes_;
    sizes_covered_ += ci95 && (*ci95)[0] <= truth && truth <= (*ci95)[1] ? 1 : 0;
    if (options_.verbose) {
      std::printf("  size %.5g of %.5g, off by %.1f %%, interval +-%.1f %%\n", answer.size->value, truth, 100.0 * error,
                  ci95 ? 50.0 * ((*ci95)[1] - (*ci95)[0]) / truth : 0.0);
    }
  }

  static auto middle(std::vector<double> values) -> double {
    return values.empty()
               ? 0.0
               : median(Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size())));
  }

  void summarise() const {
    std::printf("healthy joints: %d, nothing named on %d; after over camera noise: median %.3f, largest %.3f\n",
                healthy_joints_, healthy_unnamed_, middle(healthy_after_),
                healthy_after_.empty() ? 0.0 : *std::max_element(healthy_after_.begin(), healthy_after_.end()));
    std::printf("by base law:\n");
    print(healthy_confusion_);
    if (listed_ + foreign_ > 0) {
      std::printf(
          "listed switches: %d, named first %d, in the answer %d; foreign: %d, named %d; after over camera noise: "
          "median %.3f\n",
          listed_, first_, contained_, foreign_, foreign_named_, middle(after_));
      std::printf("by switch:\n");
      print(confusion_);
    }
    for (const auto& [name, errors] : size_errors_) {
      std::printf("  size of %s: off by %.1f %% in the median of %zu, %.1f %% at most\n", name.c_str(),
                  100.0 * middle(errors), errors.size(), 100.0 * *std::max_element(errors.begin(), errors.end()));
    }
    if (sizes_ > 0) {
      std::printf("  true size within its 95 %% interval: %d of %d\n", sizes_covered_, sizes_);
    }
    for (const auto& [name, times] : too_small_) {
      std::printf("  %s could not be made large enough %d times\n", name.c_str(), times);
    }
    if (unfit_ > 0) {
      std::printf("%d joints gave no log\n", unfit_);
    }
  }

  Options options_;
  int healthy_joints_ = 0, healthy_unnamed_ = 0, listed_ = 0, first_ = 0, contained_ = 0, foreign_ = 0,
      foreign_named_ = 0, unfit_ = 0;
  std::vector<double> healthy_after_, after_;
  std::map<std::string, std::vector<double>> size_errors_;  ///< shares
  int sizes_ = 0, sizes_covered_ = 0;
  std::map<std::string, std::map<std::string, int>> healthy_confusion_, confusion_;
  std::map<std::string, int> too_small_;
};

/// What a board says of tendons that fail while it watches.
void ask_boards(const Options& options) {
  std::map<std::string, std::map<std::string, int>> confusion;
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
    capstan::tools::plant::ask_gauges(options.seed, options.joints);
  } else {
    capstan::tools::plant::Benchmark(options).run();
  }
  return 0;
}
