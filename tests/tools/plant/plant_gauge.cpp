// SPDX-License-Identifier: Apache-2.0
#include "capstan/tests/tools/plant/plant_gauge.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

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

auto gauge(const sim::PlantParameters& plant, std::uint64_t seed, double times) -> GaugeAnswer {
  const std::vector<AxisLog> logs = free_and_held(plant, seed);
  JointFile joint = identify(logs, form_of_model(kTendonModel, logs)).joint;
  JointFile by_stiffness = joint;
  put_into_newtons({.radius_m = plant.input_radius_m}, joint);
  put_into_newtons({.stiffness_n_per_m = 0.5 * (plant.stiffness_top_n_per_m + plant.stiffness_bottom_n_per_m)},
                   by_stiffness);
  if (!joint.fit->pretension || joint.fit->pretension->force_n() == 0.0) {
    throw Refusal("a free motion and a held tip gave no pretension");
  }
  const auto force = [&](const JointFile& of) -> Told {
    return {{of.fit->pretension->force_n(), of.fit->pretension->force_95_n()}, plant.pretension_n};
  };
  GaugeAnswer answer{
      force(joint),
      force(by_stiffness),
      {{joint.fit->pretension->eta(), joint.fit->pretension->eta_95()}, 0.5 * (plant.eta_top + plant.eta_bottom)},
      {},
      {}};
  sim::PlantParameters later = plant;
  later.effects.pretension_change_n = (times - 1.0) * plant.pretension_n;
  DiagnoseOptions options;
  options.base_law = joint;
  options.base_model = "joint.toml";
  const auto drift = diagnose({log_of(later, PlantMotion::kIdentify, seed + 2)}, options).pretension;
  if (drift) {
    answer.now_n = {drift->pretension, times * plant.pretension_n};
    answer.change_n = {drift->change, later.effects.pretension_change_n};
  }
  return answer;
}

void ask_gauges(std::uint64_t first, int joints) {
  Tally force("pretension, N by radius", 0.1), stiff("pretension, N by stiffness", 0.1), eta("friction number", 0.05),
      now("pretension later, free tip", 0.1), change("its change, of the first pretension", 0.1);
  int untold = 0;
  for (int i = 0; i < joints; ++i) {
    const std::uint64_t seed = first + static_cast<std::uint64_t>(i);
    const sim::PlantParameters plant = drawn_pretension(seed);
    const double times = 0.5 * std::pow(3.6, Random(seed + 88888).uniform());
    std::printf("seed %llu, %.2f N, eta %.3f: ", static_cast<unsigned long long>(seed), plant.pretension_n,
                0.5 * (plant.eta_top + plant.eta_bottom));
    try {
      const GaugeAnswer answer = gauge(plant, seed, times);
      std::printf(
          "%.2f +-%.2f N (by stiffness %.2f +-%.2f), eta %.3f +-%.3f; %.2f N later: ", answer.force_n.told.value,
          answer.force_n.told.half, answer.by_stiffness_n.told.value, answer.by_stiffness_n.told.half,
          answer.eta.told.value, answer.eta.told.half, times * plant.pretension_n);
      force.add(answer.force_n, answer.force_n.error());
      stiff.add(answer.by_stiffness_n, answer.by_stiffness_n.error());
      eta.add(answer.eta, answer.eta.error());
      if (answer.now_n) {
        std::printf("%.2f +-%.2f N, by %.2f +-%.2f\n", answer.now_n->told.value, answer.now_n->told.half,
                    answer.change_n->told.value, answer.change_n->told.half);
        now.add(*answer.now_n, answer.now_n->error());
        change.add(*answer.change_n, (answer.change_n->told.value - answer.change_n->truth) / plant.pretension_n);
      } else {
        std::printf("not told\n");
        ++untold;
      }
    } catch (const std::exception& error) {
      std::printf("%s\n", error.what());
    }
    std::fflush(stdout);
  }
  for (Tally* tally : {&force, &stiff, &eta, &now, &change}) {
    tally->print();
  }
  std::printf("later pretension not told: %d\n", untold);
}

}  // namespace capstan::tools::plant
