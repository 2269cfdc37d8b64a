// SPDX-License-Identifier: Apache-2.0
#include "capstan/tests/tools/plant/plant_gauge.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "capstan/tests/tools/plant/independent_joint.hpp"
#include "capstan/tests/tools/plant/plant_joint.hpp"
#include "capstan/tools/diagnose/diagnosis.hpp"
#include "capstan/tools/identify/identify.hpp"
#include "capstan/tools/identify/tendon_fit.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/random.hpp"

namespace capstan::tools::plant {
namespace {

/// Errors of one number over many joints.
class Tally {
 public:
  explicit Tally(const char* name, double asked) : name_(name), asked_(asked) {}
  void add(const Told& one, double share) {
    errors_.push_back(std::abs(share));
    within_ += std::abs(share) <= asked_ ? 1 : 0;
    held_ += one.held() ? 1 : 0;
  }
  void print() {
    if (errors_.empty()) {
      return;
    }
    std::sort(errors_.begin(), errors_.end());
    std::printf("%-34s off by %.1f %% in the median, %.1f %% at most; within %.0f %%: %d of %zu; in its interval: %d\n",
                name_, 100.0 * errors_[errors_.size() / 2], 100.0 * errors_.back(), 100.0 * asked_, within_,
                errors_.size(), held_);
  }

 private:
  const char* name_;
  double asked_;
  std::vector<double> errors_;
  int within_ = 0, held_ = 0;
};

auto gauged_joint(const sim::PlantParameters& plant, std::uint64_t seed) -> GaugedJoint {
  return {plant.input_radius_m,
          0.5 * (plant.stiffness_top_n_per_m + plant.stiffness_bottom_n_per_m),
          0.5 * (plant.eta_top + plant.eta_bottom),
          plant.pretension_n,
          free_and_held(plant, seed),
          [plant, seed](double change_n) {
            sim::PlantParameters later = plant;
            later.effects.pretension_change_n = change_n;
            return log_of(later, PlantMotion::kIdentify, seed + 2);
          }};
}

/// One of the other plant, with 3 to 30 N.
auto gauged_independent(std::uint64_t seed) -> GaugedJoint {
  independent::Parameters joint = independent_joint(seed);
  joint.pretension_n = 3.0 * std::pow(10.0, Random(seed + 77777).uniform());
  LabExperiment free = drawn_experiment(seed);
  LabExperiment pulls = free;
  pulls.motion = LabMotion::kPulls;
  pulls.noise_seed += 1;
  free.noise_seed += 2;
  independent::Parameters held = joint;
  held.held = true;
  return {joint.motor_radius_m,
          0.5 * (joint.top.stiffness_n_per_m + joint.bottom.stiffness_n_per_m),
          0.5 * (joint.top.eta + joint.bottom.eta),
          joint.pretension_n,
          {log_of(joint, drawn_experiment(seed)), log_of(held, pulls)},
          [joint, free](double change_n) {
            independent::Parameters later = joint;
            later.effects.pretension_n = change_n;
            return log_of(later, free);
          }};
}

}  // namespace

auto drawn_pretension(std::uint64_t seed) -> sim::PlantParameters {
  sim::PlantParameters plant = drawn_plant(seed);
  plant.pretension_n = 3.0 * std::pow(10.0, Random(seed + 77777).uniform());
  return plant;
}

auto free_and_held(const sim::PlantParameters& plant, std::uint64_t seed) -> std::vector<AxisLog> {
  sim::PlantParameters held = plant;
  held.environment.kind = sim::EnvironmentKind::kLocked;
  return {log_of(plant, PlantMotion::kIdentify, seed), log_of(held, PlantMotion::kPull, seed + 1)};
}

auto gauge(const GaugedJoint& truth, double times) -> GaugeAnswer {
  JointFile joint = identify(truth.free_and_held, form_of_model(kTendonModel, truth.free_and_held)).joint;
  JointFile by_stiffness = joint;
  put_into_newtons({.radius_m = truth.radius_m}, joint);
  put_into_newtons({.stiffness_n_per_m = truth.stiffness_n_per_m}, by_stiffness);
  if (!joint.fit->pretension || joint.fit->pretension->force_n() == 0.0) {
    throw Refusal("a free motion and a held tip gave no pretension");
  }
  const auto force = [&](const JointFile& of) -> Told {
    return {{of.fit->pretension->force_n(), of.fit->pretension->force_95_n()}, truth.pretension_n};
  };
  GaugeAnswer answer{force(joint),
                     force(by_stiffness),
                     {{joint.fit->pretension->eta(), joint.fit->pretension->eta_95()}, truth.eta},
                     {},
                     {}};
  const double change = (times - 1.0) * truth.pretension_n;
  DiagnoseOptions options;
  options.base_law = joint;
  options.base_model = "joint.toml";
  const auto drift = diagnose({truth.free_later(change)}, options).pretension;
  if (drift) {
    answer.now_n = {drift->pretension, times * truth.pretension_n};
    answer.change_n = {drift->change, change};
  }
  return answer;
}

auto gauge(const sim::PlantParameters& plant, std::uint64_t seed, double times) -> GaugeAnswer {
  return gauge(gauged_joint(plant, seed), times);
}

void ask_gauges(std::uint64_t first, int joints, bool independent) {
  Tally force("pretension, N by radius", 0.1), stiff("pretension, N by stiffness", 0.1), eta("friction number", 0.05),
      now("pretension later, free tip", 0.1), change("its change, of the first pretension", 0.1);
  int untold = 0;
  for (int i = 0; i < joints; ++i) {
    const std::uint64_t seed = first + static_cast<std::uint64_t>(i);
    const double times = 0.5 * std::pow(3.6, Random(seed + 88888).uniform());
    try {
      const GaugedJoint joint = independent ? gauged_independent(seed) : gauged_joint(drawn_pretension(seed), seed);
      std::printf("seed %llu, %.2f N, eta %.3f: ", static_cast<unsigned long long>(seed), joint.pretension_n,
                  joint.eta);
      const GaugeAnswer answer = gauge(joint, times);
      std::printf(
          "%.2f +-%.2f N (by stiffness %.2f +-%.2f), eta %.3f +-%.3f; %.2f N later: ", answer.force_n.told.value,
          answer.force_n.told.half, answer.by_stiffness_n.told.value, answer.by_stiffness_n.told.half,
          answer.eta.told.value, answer.eta.told.half, times * joint.pretension_n);
      force.add(answer.force_n, answer.force_n.error());
      stiff.add(answer.by_stiffness_n, answer.by_stiffness_n.error());
      eta.add(answer.eta, answer.eta.error());
      if (answer.now_n) {
        std::printf("%.2f +-%.2f N, by %.2f +-%.2f\n", answer.now_n->told.value, answer.now_n->told.half,
                    answer.change_n->told.value, answer.change_n->told.half);
        now.add(*answer.now_n, answer.now_n->error());
        change.add(*answer.change_n, (answer.change_n->told.value - answer.change_n->truth) / joint.pretension_n);
      } else {
        std::printf("not told\n");
        ++untold;
      }
    } catch (const std::exception& error) {
      std::printf("seed %llu: %s\n", static_cast<unsigned long long>(seed), error.what());
    }
    std::fflush(stdout);
  }
  for (Tally* tally : {&force, &stiff, &eta, &now, &change}) {
    tally->print();
  }
  std::printf("later pretension not told: %d\n", untold);
}

}  // namespace capstan::tools::plant
