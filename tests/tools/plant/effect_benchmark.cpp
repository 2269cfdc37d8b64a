// SPDX-License-Identifier: Apache-2.0
#include "capstan/tests/tools/plant/effect_benchmark.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "capstan/tools/diagnose/compare.hpp"
#include "capstan/tools/identify/identify.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/statistics.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools::plant {
namespace {

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

/// A switch as far on as makes the healthy law err by so many radians; as far as it goes, if less.
auto size_wanted(const SwitchedJoint& joint, std::size_t which, const JointFile& law, const AxisLog& log, double wanted)
    -> double {
  const Switchable one = joint.switches()[which];
  double size = one.usual;
  for (int round = 0; round < 4; ++round) {
    const double got = size_of_effect(law, joint.log(which, size, false, {}), log);
    if (std::abs(got / wanted - 1.0) < 0.15) {
      break;
    }
    size = std::min(one.most, size * std::clamp(wanted / std::max(got, 1e-6), 0.2, 5.0));
  }
  return size;
}

void count(Confusion& confusion, const std::string& truth, const Answer& answer) {
  ++confusion[truth][answer.named.empty() ? answer.verdict : joined(answer.named, " + ")];
}

class Benchmark {
 public:
  explicit Benchmark(EffectOptions options) : options_(std::move(options)) {}

  void run(const std::function<std::vector<std::unique_ptr<SwitchedJoint>>(std::uint64_t seed)>& drawn) {
    for (int i = 0; i < options_.joints; ++i) {
      const std::uint64_t seed = options_.seed + static_cast<std::uint64_t>(i);
      for (const auto& joint : drawn(seed)) {
        label_ = "seed " + std::to_string(seed) + " " + joint->motion();
        file_ = "_" + std::to_string(seed) + "_" + joint->motion() + ".csv";
        one_joint(*joint);
      }
    }
    summarise();
  }

 private:
  void one_joint(const SwitchedJoint& joint) {
    AxisLog log;
    HealthyJoint healthy;
    try {
      log = joint.log(0, 0.0, false, kept("healthy"));
      DiagnoseOptions options;
      if (const auto other = joint.other_motion()) {
        options.test_logs = {*other};
      }
      if (options_.compare) {
        healthy = healthy_joint({log}, options);
      } else {
        healthy.diagnosis = diagnose({log}, options);
      }
    } catch (const std::exception& error) {
      std::printf("%s: %s\n", label_.c_str(), error.what());
      ++unfit_;
      return;
    }
    judge_healthy(healthy.diagnosis, joint.camera_noise_rad());
    const auto switches = joint.switches();
    for (std::size_t which = 0; which < switches.size(); ++which) {
      const bool wanted = options_.only.empty() || std::find(options_.only.begin(), options_.only.end(),
                                                             switches[which].name) != options_.only.end();
      for (const double strength : options_.strengths) {
        if (wanted && !options_.healthy) {
          one_switch(joint, which, healthy, log, strength);
        }
      }
    }
  }

  void judge_healthy(const Diagnosis& d, double noise) {
    const Answer answer = answer_of(d, noise);
    ++healthy_joints_;
    healthy_unnamed_ += answer.named.empty() ? 1 : 0;
    healthy_after_.push_back(answer.after);
    count(healthy_confusion_, d.base_model, answer);
    std::string other;
    if (!d.tested.empty()) {
      other_after_.push_back(d.tested.front().after.rmse / noise);
      other = ", in another motion " + rounded(other_after_.back());
    }
    if (options_.verbose) {
      std::printf("%s healthy: base %s, %s %s, after over camera noise %.3f%s\n", label_.c_str(), d.base_model.c_str(),
                  answer.verdict.c_str(), joined(answer.named).c_str(), answer.after, other.c_str());
      std::fflush(stdout);
    }
  }

  void one_switch(const SwitchedJoint& joint, std::size_t which, const HealthyJoint& healthy, const AxisLog& log,
                  double strength) {
    const Switchable one = joint.switches()[which];
    const JointFile& law = healthy.diagnosis.law;
    const double noise = joint.camera_noise_rad();
    try {
      const double on = size_wanted(joint, which, law, log, strength * noise);
      const AxisLog now = joint.log(which, on, true, kept(one.name));
      const double size = size_of_effect(law, now, log) / noise;
      if (size < 0.5 * strength) {
        ++too_small_[one.name];
        return;
      }
      Answer answer;
      if (options_.compare) {
        answer = answer_of(compare(healthy, {now}, {}).now, noise);
      } else {
        DiagnoseOptions options;
        if (!options_.from_nothing) {
          options.base_model = "healthy.toml";
          options.base_law = law;
        }
        answer = answer_of(diagnose({now}, options), noise);
      }
      judge(one, answer, strength, size);
      judge_size(one, answer, joint.true_size(which, on));
    } catch (const std::exception& error) {
      std::printf("%s, %s: %s\n", one.name.c_str(), label_.c_str(), error.what());
      ++unfit_;
    }
  }

  [[nodiscard]] auto kept(const std::string& name) const -> std::string {
    return options_.keep.empty() ? "" : options_.keep + "/" + name + file_;
  }

  void judge(const Switchable& one, const Answer& answer, double strength, double size) {
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
      std::printf("%s %s x%g (%.1f): %s %s, after over camera noise %.3f\n", label_.c_str(), one.name.c_str(), strength,
                  size, answer.verdict.c_str(), joined(answer.named).c_str(), answer.after);
      std::fflush(stdout);
    }
  }

  void judge_size(const Switchable& one, const Answer& answer, double truth) {
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
    if (!other_after_.empty()) {
      std::printf("  in another motion: median %.3f, largest %.3f; at most 1.1 on %td\n", middle(other_after_),
                  *std::max_element(other_after_.begin(), other_after_.end()),
                  std::count_if(other_after_.begin(), other_after_.end(), [](double after) { return after <= 1.1; }));
    }
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

  EffectOptions options_;
  std::string label_, file_;  ///< of the joint asked
  int healthy_joints_ = 0, healthy_unnamed_ = 0, listed_ = 0, first_ = 0, contained_ = 0, foreign_ = 0,
      foreign_named_ = 0, unfit_ = 0;
  std::vector<double> healthy_after_, other_after_, after_;
  std::map<std::string, std::vector<double>> size_errors_;  ///< shares
  int sizes_ = 0, sizes_covered_ = 0;
  Confusion healthy_confusion_, confusion_;
  std::map<std::string, int> too_small_;
};

}  // namespace

void print(const Confusion& confusion) {
  for (const auto& [truth, answers] : confusion) {
    std::printf("  %-22s", truth.c_str());
    for (const auto& [name, times] : answers) {
      std::printf(" %s %d;", name.c_str(), times);
    }
    std::printf("\n");
  }
}

void ask_effects(const EffectOptions& options,
                 const std::function<std::vector<std::unique_ptr<SwitchedJoint>>(std::uint64_t seed)>& drawn) {
  Benchmark(options).run(drawn);
}

}  // namespace capstan::tools::plant
