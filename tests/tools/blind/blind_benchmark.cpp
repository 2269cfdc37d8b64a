// SPDX-License-Identifier: Apache-2.0
// Diagnoses joints whose missing effect is drawn by chance, and counts how often the answer is right.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <map>
#include <mutex>
#include <numeric>
#include <random>
#include <thread>

#include "capstan/tests/tools/blind/blind_axis.hpp"
#include "capstan/tests/tools/blind/blind_joint.hpp"
#include "capstan/tests/tools/blind/flexible_model.hpp"
#include "capstan/tools/diagnose/diagnosis.hpp"
#include "capstan/tools/identify/given_motion.hpp"
#include "capstan/tools/identify/identify.hpp"
#include "capstan/tools/joint_file/table_section.hpp"
#include "capstan/tools/support/side_by_side.hpp"
#include "capstan/tools/support/statistics.hpp"

namespace capstan::tools::blind {
namespace {

enum class Answer { kRight, kInSet, kInPart, kMissed, kRefused, kWrong, kNotVisible };

struct Outcome {
  Case drawn;
  Diagnosis diagnosis;
  double after_over_floor = 0.0;
  double removed = 0.0;  ///< share of the base law's error energy that the delivered law takes away, on rows set aside
  /// The same of a flexible model: of an effort the diagnosis's own, out of fold; of a joint that of blind_ceiling, on
  /// the same rows.
  FlexibleModel removable;
  Answer answer = Answer::kWrong;
};

auto names_in(const Diagnosis& d) -> std::vector<std::string> {
  std::vector<std::string> names;
  for (const auto& effect : d.effects) {
    names.push_back(effect.name);
  }
  return names;
}

auto contains(const std::vector<std::string>& names, const std::string& name) -> bool {
  return std::find(names.begin(), names.end(), name) != names.end();
}

auto judge(const Case& c, const Diagnosis& d) -> Answer {
  const auto names = names_in(d);
  bool all = true;
  bool in_set = !c.truths.empty();
  for (const auto& truth : c.truths) {
    all = all && contains(names, truth);
    const bool alternative = !d.effects.empty() && contains(d.effects.front().alternatives, truth);
    in_set = in_set && (contains(names, truth) || alternative);
  }
  if (d.verdict == Verdict::kEffect && all && names.size() == c.truths.size()) {
    return Answer::kRight;
  }
  if (d.verdict == Verdict::kNothingMissing) {
    return c.truths.empty() ? Answer::kRight : Answer::kMissed;
  }
  if (is_refusal(d.verdict)) {
    return Answer::kRefused;
  }
  const bool part = std::all_of(names.begin(), names.end(), [&](const auto& name) { return contains(c.truths, name); });
  return in_set ? Answer::kInSet : (part ? Answer::kInPart : Answer::kWrong);
}

struct Tally {
  int counts[6] = {};
  void add(Answer answer) { ++counts[static_cast<std::size_t>(answer)]; }
};

struct Options {
  int seeds = 1;
  std::uint64_t first_seed = 0;
  std::vector<std::string> only;
  std::vector<double> strengths = {1.0, 3.0, 10.0};
  std::string family = "both";
  bool pairs = false;
  bool verbose = false;
};

using Truths = std::vector<std::vector<std::string>>;

auto joint_truths(bool pairs) -> Truths {
  Truths truths;
  const auto& names = listed_effects();
  for (std::size_t a = 0; pairs && a < names.size(); ++a) {
    for (std::size_t b = a + 1; b < names.size(); ++b) {
      truths.push_back({names[a], names[b]});
    }
  }
  if (!pairs) {
    truths.push_back({});
    for (const auto& list : {listed_effects(), unlisted_effects()}) {
      for (const auto& name : list) {
        truths.push_back({name});
      }
    }
  }
  return truths;
}

auto axis_truths() -> Truths {
  Truths truths = listed_efforts();
  truths.insert(truths.begin(), std::vector<std::string>{});
  for (const auto& name : unlisted_efforts()) {
    truths.push_back({name});
  }
  return truths;
}

auto cases_of(const Options& options, bool effort) -> std::vector<Case> {
  const Truths truths = effort ? axis_truths() : joint_truths(options.pairs);
  std::vector<Case> cases;
  std::uint64_t seed = options.first_seed;
  for (const auto& names : truths) {
    if (!options.only.empty() &&
        (names.empty() ? !contains(options.only, "none") : !contains(options.only, names.back()))) {
      continue;
    }
    for (const Motion motion : kMotions) {
      for (const double strength : options.strengths) {
        for (const bool repeats : {true, false}) {
          for (int i = 0; i < options.seeds; ++i) {
            cases.push_back({names, effort, motion, strength, repeats, ++seed});
          }
        }
      }
    }
  }
  return cases;
}

auto title(const Case& c) -> std::string {
  return c.truths.empty() ? "none" : c.truths.size() == 1 ? c.truths[0] : c.truths[0] + " + " + c.truths[1];
}

void print_outcome(const Outcome& o) {
  constexpr const char* kWords[] = {"right", "in set", "in part", "missed", "refused", "WRONG", "not visible"};
  std::string names;
  for (const auto& effect : o.diagnosis.effects) {
    names += " " + effect.name;
    for (const auto& other : effect.alternatives) {
      names += "|" + other;
    }
  }
  std::string law;
  for (const auto& term : o.diagnosis.law.terms) {
    law += " " + term;
    if (term == kTableTerm) {
      const auto first = o.diagnosis.law.catalogue->term(term).first_shape;
      law += " (" + described_table(&o.diagnosis.law.parameters.shapes[first]) + ")";
    }
  }
  std::printf("%-20s %-9s x%-4.3g %-7s seed %llu: %-7s %s%s (%s) after/floor %.2f removed %.3f of %.3f, law%s\n",
              title(o.drawn).c_str(), motion_name(o.drawn.motion), o.drawn.strength,
              o.drawn.repeats ? "repeats" : "single", static_cast<unsigned long long>(o.drawn.seed),
              kWords[static_cast<std::size_t>(o.answer)], verdict_word(o.diagnosis.verdict), names.c_str(),
              o.diagnosis.reason.c_str(), o.after_over_floor, o.removed, o.removable.by_signals, law.c_str());
}

auto is_foreign(const Case& c) -> bool {
  return c.truths.empty() || contains(c.effort ? unlisted_efforts() : unlisted_effects(), c.truths[0]);
}

void print_figures(const Tally& listed, const Tally& foreign, const std::vector<double>& after) {
  const auto& [right, in_set, in_part, missed, refused, wrong] = listed.counts;
  const int named = right + in_set + in_part + wrong;
  const int none = std::accumulate(std::begin(foreign.counts), std::end(foreign.counts), 0);
  const int named_foreign = foreign.counts[static_cast<std::size_t>(Answer::kWrong)];
  if (named + missed + refused > 0) {
    std::printf("listed: %d of %d answered; right name alone %.1f %%, truth in the answer %.1f %% of those answered\n",
                named, named + missed + refused, 100.0 * right / std::max(1, named),
                100.0 * (right + in_set) / std::max(1, named));
  }
  if (none > 0) {
    std::printf("none or unlisted: %d of %d were given a name (%.1f %%)\n", named_foreign, none,
                100.0 * named_foreign / none);
  }
  if (!after.empty()) {
    const Eigen::VectorXd ratios =
        Eigen::Map<const Eigen::VectorXd>(after.data(), static_cast<Eigen::Index>(after.size()));
    std::printf("error after over noise floor where named right: median %.3f\n", median(ratios));
  }
}

auto is_unlisted(const Case& c) -> bool {
  return is_foreign(c) && !c.truths.empty();
}

/// What the delivered laws take away of effects that have no name, beside a flexible model, where that takes away
/// anything. Who does harm takes away nothing.
void print_removed(const std::vector<Outcome>& outcomes, double FlexibleModel::*model, const char* words) {
  constexpr double kAnything = 0.05;
  std::vector<double> shares;
  double removed = 0.0;
  double removable = 0.0;
  for (const auto& o : outcomes) {
    const double most = o.removable.*model;
    if (is_unlisted(o.drawn) && o.answer != Answer::kNotVisible && most > kAnything) {
      shares.push_back(std::max(0.0, o.removed) / most);
      removed += std::max(0.0, o.removed);
      removable += most;
    }
  }
  if (!shares.empty()) {
    const Eigen::VectorXd all =
        Eigen::Map<const Eigen::VectorXd>(shares.data(), static_cast<Eigen::Index>(shares.size()));
    std::printf(
        "unlisted, of what a flexible model%s takes away the delivered law does: %.1f %% of all, median %.2f, at least "
        "0.8 in %.1f %% of %zu\n",
        words, 100.0 * removed / removable, median(all), 100.0 * (all.array() >= 0.8).cast<double>().mean(),
        shares.size());
  }
}

void print_table(const std::vector<Outcome>& outcomes) {
  std::map<std::string, Tally> by_truth;
  Tally listed;
  Tally foreign;
  std::vector<double> after;
  for (const auto& o : outcomes) {
    if (o.answer == Answer::kNotVisible) {
      continue;
    }
    by_truth[title(o.drawn)].add(o.answer);
    (is_foreign(o.drawn) ? foreign : listed).add(o.answer);
    if (!is_foreign(o.drawn) && o.answer == Answer::kRight) {
      after.push_back(o.after_over_floor);
    }
  }
  std::printf("%-44s %6s %6s %7s %6s %7s %6s\n", "truth", "right", "in set", "in part", "missed", "refused", "wrong");
  for (const auto& [name, t] : by_truth) {
    std::printf("%-44s %6d %6d %7d %6d %7d %6d\n", name.c_str(), t.counts[0], t.counts[1], t.counts[2], t.counts[3],
                t.counts[4], t.counts[5]);
  }
  print_figures(listed, foreign, after);
  print_removed(outcomes, &FlexibleModel::by_signals, "");
  if (!outcomes.empty() && !outcomes.front().drawn.effort) {
    print_removed(outcomes, &FlexibleModel::with_time, " that knows the time");
  }
}

/// What no law that reads these sensors can go below: noise of the effort, and what the encoder's steps make of inertia
/// and drag; averaged as effort and law are.
auto floor_of(const BlindAxis& axis) -> double {
  const LawForm form = form_of_model(kEffortModel, {axis.log});
  std::vector<std::string> notes;
  const auto conditioner = choose_conditioner({axis.log}, form, notes);
  AxisLog exact = axis.log;
  exact.q1_rad = axis.angle;
  const LawDesign design = design_for({axis.log}, form, conditioner);
  const AngleNoise noise = motor_angle_noise({axis.log});
  const LawDesign finer({exact}, {given_motion(exact, conditioner, noise).samples}, design.smoothing());
  const Eigen::Vector2d theta{axis.inertia, axis.drag};
  const Eigen::VectorXd hidden = (law_columns(design, form) - law_columns(finer, form)) * theta;
  return std::hypot(rms(design.smoothed(axis.noise)), rms(hidden));
}

auto tried(const Case& c) -> Outcome {
  Outcome outcome;
  outcome.drawn = c;
  AxisLog log;
  double floor = 0.0;
  bool visible = true;
  if (c.effort) {
    const BlindAxis axis = blind_axis(c);
    log = axis.log;
    floor = floor_of(axis);
    visible = axis.visible;
  } else {
    const BlindJoint joint = blind_joint(c);
    log = joint.log;
    floor = joint.floor_rad;
    visible = joint.visible;
  }
  outcome.diagnosis = diagnose({log}, {});
  const Diagnosis& d = outcome.diagnosis;
  if (c.effort) {
    outcome.removable.by_signals = d.rounds.empty() ? 0.0 : std::max(0.0, d.rounds.front().reducible_share);
  } else if (visible && is_unlisted(c)) {
    outcome.removable = flexible_model_of(log, d);
  }
  const double left = d.before.rmse > 0.0 ? d.after.rmse / d.before.rmse : 1.0;
  outcome.removed = 1.0 - left * left;
  outcome.diagnosis.traces = {};
  outcome.after_over_floor = outcome.diagnosis.after.rmse / floor;
  outcome.answer = visible ? judge(c, outcome.diagnosis) : Answer::kNotVisible;
  return outcome;
}

void try_all(const std::vector<Case>& cases, bool verbose) {
  std::vector<Outcome> outcomes(cases.size());
  std::mutex printing;
  const int threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  side_by_side(threads, cases.size(), [&](std::size_t i) {
    outcomes[i] = tried(cases[i]);
    if (verbose) {
      const std::lock_guard<std::mutex> lock(printing);
      print_outcome(outcomes[i]);
      std::fflush(stdout);
    }
  });
  print_table(outcomes);
}

auto run(const Options& options) -> int {
  for (const bool effort : {false, true}) {
    const bool asked = options.family == "both" || options.family == (effort ? "effort" : "transmission");
    if (asked && !(effort && options.pairs)) {
      std::printf("%s\n", effort ? "efforts" : "joint angles");
      try_all(cases_of(options, effort), options.verbose);
    }
  }
  return 0;
}

}  // namespace
}  // namespace capstan::tools::blind

auto main(int argc, char** argv) -> int {
  using namespace capstan::tools::blind;
  CLI::App app{"Diagnoses joints with an effect drawn by chance and counts the right, refused and wrong answers."};
  Options options;
  options.first_seed = std::random_device{}();
  app.add_option("--seeds", options.seeds, "joints per cell of effect, motion, strength and repetition");
  app.add_option("--seed", options.first_seed, "first seed, to repeat a run; fresh otherwise");
  app.add_option("--only", options.only, "effects to try (none: no effect)");
  app.add_option("--strengths", options.strengths, "rms of the effect outside the base law, over the sensor's noise");
  app.add_option("--family", options.family, "transmission, effort or both")
      ->check(CLI::IsMember({"transmission", "effort", "both"}));
  app.add_flag("--pairs", options.pairs, "two effects at once");
  app.add_flag("--verbose", options.verbose, "a line for every joint");
  CLI11_PARSE(app, argc, argv);
  std::printf("first seed %llu\n", static_cast<unsigned long long>(options.first_seed));
  return run(options);
}
