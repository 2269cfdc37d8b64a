// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnose/rounds.hpp"

#include <algorithm>
#include <cmath>

#include "tools/support/statistics.hpp"
#include "tools/support/text.hpp"

namespace capstan::tools {
namespace {

constexpr std::size_t kMostEffects = 4;
/// A further effect must explain more than this share of what is still to be explained.
constexpr double kShareOfRest = 0.5;

/// One round: the law so far, what it leaves, and how every family does on that.
struct Round {
  LawResidual residual;
  Evidence evidence;
  Adequacy adequacy;
  std::vector<FamilyTrial> trials;
};

auto hold_round(const Preparation& p, const LawForm& law) -> Round {
  Round round;
  round.residual = residual_of(p, law);
  round.evidence = gather_evidence(p, law, round.residual);
  round.adequacy = judge_adequacy(p, round.evidence);
  round.trials = try_families(round.evidence);
  return round;
}

auto best_passing(const Round& round, bool catalogue_only) -> const FamilyTrial* {
  const FamilyTrial* best = nullptr;
  for (const auto& trial : round.trials) {
    const bool eligible = !catalogue_only || round.evidence.families[trial.family].in_catalogue;
    if (eligible && passes(trial, round.evidence) && (best == nullptr || trial.likelihood_gain > best->likelihood_gain)) {
      best = &trial;
    }
  }
  return best;
}

auto outcome_of(const Round& round, const FamilyTrial& trial, const FamilyTrial* chosen, const std::vector<std::size_t>& confusable)
    -> std::string {
  if (&trial == chosen) {
    return "explains the residual best";
  }
  if (trial.learned.gain <= 0.0) {
    return "ruled out: the data ask for a sign that physics forbids";
  }
  if (trial.absorbed > 0.99) {
    return "not identifiable beside the law on this motion";
  }
  if (chosen != nullptr && std::find(confusable.begin(), confusable.end(), trial.family) != confusable.end()) {
    return "this log can not tell it from the best";
  }
  if (trial.p_value > kAlpha) {
    return "not detected";
  }
  if (trial.log_evidence < evidence_needed(round.evidence)) {
    return "not confirmed on unseen rows";
  }
  return "ruled out: the best explains significantly more";
}

auto ranking(const Round& round, const FamilyTrial* chosen, const std::vector<std::size_t>& confusable) -> std::vector<RankedEffect> {
  const double energy = round.evidence.white().projected(round.evidence.learned).error_energy();
  std::vector<RankedEffect> ranked;
  for (const auto& trial : round.trials) {
    const auto& family = round.evidence.families[trial.family];
    ranked.push_back({family.name, family.in_catalogue, trial.p_value, trial.log_evidence,
                      energy > 0.0 ? trial.learned.gain / energy : 0.0, trial.raw_explained, outcome_of(round, trial, chosen, confusable)});
  }
  std::sort(ranked.begin(), ranked.end(), [](const auto& a, const auto& b) { return a.explained > b.explained; });
  return ranked;
}

auto names_of(const Round& round, const std::vector<std::size_t>& families) -> std::vector<std::string> {
  std::vector<std::string> names;
  for (const std::size_t family : families) {
    names.push_back(round.evidence.families[family].name);
  }
  return names;
}

/// The law with one effect more, its shapes refined on the measured quantity; empty if the effect does not hold in the joint fit.
auto law_with(const Preparation& p, const LawForm& law, const Family& family, const FamilyTrial& trial) -> std::optional<LawForm> {
  const Blocks learned = refined(p.split, p.factor).learned();
  const CatalogueTerm& term = catalogue_term(family.name);
  LawForm next = law;
  next.terms.push_back(family.name);
  next.set_shapes(term, family.variants[trial.learned.variant].shapes);
  next = refine_shapes(p.hindsight, p.target, learned, next);
  if (!shapes_at_limits(next).empty()) {
    return std::nullopt;
  }
  const LinearFit fit = fit_law(p.hindsight, p.target, learned, next);
  Eigen::Index column = 0;
  bool present = term.acts_on_output;
  for (const auto& other : term_catalogue()) {
    if (next.has(other.name)) {
      for (std::size_t i = 0; i < other.coefficients.size(); ++i, ++column) {
        present = present || (other.name == family.name && fit.theta[column] != 0.0);
      }
    }
  }
  return present ? std::optional(next) : std::nullopt;
}

class Searcher {
 public:
  Searcher(const Preparation& p, const LawForm& base, const std::function<void(const std::string&)>& progress)
      : p_(p), progress_(progress) {
    search_.law = base;
  }

  auto run() -> Search {
    progress_("looking at what " + joined(search_.law.terms, " + ") + " leaves");
    Round round = hold_round(p_, search_.law);
    note(round);
    base_energy_ = round.adequacy.law_energy;
    search_.base_reducible = round.adequacy.reducible_share;
    while (search_.effects.size() < kMostEffects && take_step(round)) {
    }
    conclude(round);
    return std::move(search_);
  }

 private:
  /// Adds the best effect of a round and holds the next one. False when nothing further is to be added.
  auto take_step(Round& round) -> bool {
    const FamilyTrial* best = best_passing(round, false);
    if (best == nullptr) {
      search_.rounds.push_back(ranking(round, nullptr, {}));
      return false;
    }
    auto confusable = confusable_with(round.evidence, round.trials, best->family);
    const FamilyTrial* chosen = best;
    if (!round.evidence.families[best->family].in_catalogue) {
      chosen = best_passing(round, true);
      const bool open = chosen != nullptr && std::find(confusable.begin(), confusable.end(), chosen->family) != confusable.end();
      if (!open) {
        search_.rounds.push_back(ranking(round, best, confusable));
        search_.unlisted = round.evidence.families[best->family].name;
        return false;
      }
      confusable.erase(std::find(confusable.begin(), confusable.end(), chosen->family));
      confusable.insert(confusable.begin(), best->family);
    }
    search_.rounds.push_back(ranking(round, chosen, confusable));
    return add(round, *chosen, confusable);
  }

  auto add(Round& round, const FamilyTrial& trial, const std::vector<std::size_t>& confusable) -> bool {
    const Family& family = round.evidence.families[trial.family];
    const bool further = !search_.effects.empty();
    if (further && !confusable.empty()) {
      return false;  // what remains is not one thing: it stays unlisted
    }
    const auto law = law_with(p_, search_.law, family, trial);
    if (!law) {
      search_.rounds.back().front().outcome = "refused: its shape ran to the end of its range or its sign is impossible";
      return false;
    }
    progress_("trying " + family.name);
    Round next = hold_round(p_, *law);
    note(next);
    const auto share = explained_share(round.adequacy.law_energy, next.adequacy.law_energy, next.adequacy.ceiling_energy);
    if (further && share.lower < kShareOfRest) {
      return false;
    }
    search_.effects.push_back({family.name, names_of(round, confusable), trial.p_value, trial.log_evidence,
                               evidence_needed(round.evidence), trial.likelihood_gain, trial.block_t, trial.absorbed});
    search_.law = *law;
    round = std::move(next);
    const bool ambiguous = !search_.effects.back().alternatives.empty();
    return !ambiguous;
  }

  void note(const Round& r) {
    std::string ar;
    for (double a : r.evidence.noise.coefficients) ar += " " + rounded(a, 3);
    search_.trace.push_back("lacks " + std::to_string(r.adequacy.lacks_something) + " lof_p " + rounded(r.adequacy.lack_of_fit_p) + " ceil_t " +
                            rounded(r.adequacy.ceiling_t) + " reducible " + rounded(r.adequacy.reducible_share) + " law rms " +
                            rounded(std::sqrt(r.adequacy.law_energy.sum() / static_cast<double>(rows_in(p_.split.learned())))) + " ceil rms " +
                            rounded(std::sqrt(r.adequacy.ceiling_energy.sum() / static_cast<double>(rows_in(p_.split.learned())))) +
                            " innov " + rounded(std::sqrt(r.evidence.innovation_variance)) + " AR" + ar + " need " +
                            rounded(evidence_needed(r.evidence)) + " cols " + std::to_string(r.evidence.layout.total));
  }
  void conclude(const Round& round) {
    search_.lacks_something = round.adequacy.lacks_something;
    if (!search_.effects.empty()) {
      search_.share = explained_share(base_energy_, round.adequacy.law_energy, round.adequacy.ceiling_energy);
    }
    if (p_.repeats) {
      search_.noise_floor = pure_error_level(p_, p_.target - round.residual.fitted);
    } else {
      const double rows = static_cast<double>(rows_in(p_.split.learned()));
      search_.noise_floor = std::sqrt(std::min(round.adequacy.ceiling_energy.sum(), round.adequacy.law_energy.sum()) / rows);
    }
    for (const auto& trial : round.trials) {
      const auto& family = round.evidence.families[trial.family];
      if (family.in_catalogue) {
        search_.detectable.push_back(family.name + " " + rounded(trial.detectable, 2));
      }
    }
  }

  const Preparation& p_;
  const std::function<void(const std::string&)>& progress_;
  Search search_;
  Eigen::VectorXd base_energy_;
};

}  // namespace

auto residual_of(const Preparation& p, const LawForm& law) -> LawResidual {
  const Eigen::MatrixXd columns = law_columns(p.hindsight, law);
  const LinearFit fit = fit_columns(columns, p.target, refined(p.split, p.factor).learned(), law_signs(law));
  LawResidual residual;
  residual.fitted = columns * fit.theta;
  residual.error = decimated(p.target - residual.fitted, p.factor);
  Eigen::MatrixXd base = columns;
  for (const auto& term : term_catalogue()) {
    for (std::size_t i = 0; law.has(term.name) && i < term.shapes.size(); ++i) {
      LawForm moved = law;
      const double step = 1e-3 * (term.shapes[i].maximum - term.shapes[i].minimum);
      moved.shapes[term.first_shape + i] += step;
      base.conservativeResize(Eigen::NoChange, base.cols() + 1);
      base.rightCols(1) = (law_columns(p.hindsight, moved) * fit.theta - residual.fitted) / step;
    }
  }
  residual.base = decimated(base, p.factor);
  return residual;
}

auto search_effects(const Preparation& p, const LawForm& base, const std::function<void(const std::string&)>& progress) -> Search {
  return Searcher(p, base, progress).run();
}

}  // namespace capstan::tools
