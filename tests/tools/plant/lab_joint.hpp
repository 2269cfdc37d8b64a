// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "capstan/tests/tools/plant/effect_benchmark.hpp"
#include "capstan/tests/tools/plant/lab_motion.hpp"

namespace capstan::tools::plant {

/// A switch of a plant, where it is in its parameters, and what the diagnosis should tell of its size; nothing where it
/// means something else.
template <typename Parameters>
struct LabSwitch {
  using Effects = decltype(Parameters::effects);
  Switchable what;
  double Effects::*size;
  double (*true_size)(const Parameters& healthy, double size) = nullptr;
};

/// The size that is told is the switch's own.
template <typename Parameters>
auto own_size(const Parameters& /*healthy*/, double size) -> double {
  return size;
}

/// A joint of a plant that a laboratory moves, in the experiment drawn for its seed. `log_of` knows the plant.
template <typename Parameters>
class LabJoint final : public SwitchedJoint {
 public:
  using Switches = std::vector<LabSwitch<Parameters>>;
  LabJoint(const Parameters& joint, std::uint64_t seed, const Switches& switches)
      : joint_(joint), experiment_(drawn_experiment(seed)), switches_(switches) {}

  [[nodiscard]] auto motion() const -> std::string override { return name_of(experiment_.motion); }
  [[nodiscard]] auto camera_noise_rad() const -> double override { return joint_.camera_noise_rad; }
  [[nodiscard]] auto switches() const -> std::vector<Switchable> override {
    std::vector<Switchable> all;
    for (const auto& one : switches_) {
      all.push_back(one.what);
    }
    return all;
  }
  [[nodiscard]] auto log(std::size_t which, double size, bool again, const std::string& keep) const
      -> AxisLog override {
    Parameters joint = joint_;
    joint.effects.*switches_[which].size = size;
    LabExperiment experiment = experiment_;
    experiment.noise_seed += again ? 1 : 0;
    return log_of(joint, experiment, keep);
  }
  [[nodiscard]] auto true_size(std::size_t which, double size) const -> double override {
    const auto told = switches_[which].true_size;
    return told != nullptr ? told(joint_, size) : 0.0;
  }
  [[nodiscard]] auto other_motion() const -> std::optional<AxisLog> override {
    return log_of(joint_, other_experiment(experiment_), {});
  }

 private:
  Parameters joint_;
  LabExperiment experiment_;
  Switches switches_;
};

}  // namespace capstan::tools::plant
