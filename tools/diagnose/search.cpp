// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/diagnose/search.hpp"

#include <algorithm>
#include <cmath>

#include "capstan/tools/diagnose/pairs.hpp"
#include "capstan/tools/diagnose/proposal.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

constexpr std::size_t kMostEffects = 4;
/// A further effect must explain more than this share of what is still to be explained.
constexpr double kShareOfRest = 0.5;
/// A first effect that explains less than this may be half of a pair; a pair has to explain more.
constexpr double kShareAlone = 0.8;

class Searcher {
 public:
  Searcher(const Preparation& p, const LawForm& base, const std::function<void(const std::string&)>& progress)
      : p_(p), progress_(progress) {
    search_.law = base;
  }

  auto run() -> Search {
    progress_("looking at what " + joined(search_.law.terms, " + ") + " leaves");
    Round round = hold_round(p_, search_.law);
    const LawForm base = search_.law;
    const bool base_lacks_something = round.adequacy.lacks_something;
    base_energy_ = round.adequacy.law_energy;
    search_.base_reducible = round.adequacy.reducible_share;
    while (search_.effects.size() < kMostEffects && take_step(round)) {
    }
    check_backward(round);
    settle_level(base, round);
    conclude(round);
    // One of many effects passes by chance now and then, where nothing that matters is missing.
    if (!base_lacks_something && !search_.lacks_something && search_.share.lower < kNamedShare) {
      search_.effects.clear();
      search_.law = base;
    }
    return std::move(search_);
  }

 private:
  static auto confusable(const Round& round, const CandidateTrial& trial) -> std::vector<std::size_t> {
    if (!round.evidence.by_energy) {
      return confusable_with(round.evidence, round.trials, trial.candidate, round.adequacy.flexible_energy.sum());
    }
    std::vector<std::size_t> candidates;
    for (const auto& other : round.trials) {
      if (other.candidate != trial.candidate && other.possible && !clearly_positive(other.energies - trial.energies)) {
        candidates.push_back(other.candidate);
      }
    }
    return candidates;
  }

  /// The trial itself, or the special case of it that this log can not tell from it, or that leaves no more on rows it
  /// was not fitted to, whatever a noise model judged from the residual makes of the steps at reversals. Beside another
  /// effect that was found what the other left blurs the comparison, and half as much energy again is no difference;
  /// nor is it where the trial is a wider form of its effect, whose freedom makes up for what noise took from the law.
  auto simplest(const Round& round, const CandidateTrial* best, bool beside_another) const -> const CandidateTrial* {
    constexpr double kBlurred = 1.5;
    if (best == nullptr) {
      return best;
    }
    const Candidate& general = round.evidence.candidates[best->candidate];
    const auto names = names_of(round, confusable(round, *best));
    for (const auto& special : general.special_cases) {
      const bool blurred = beside_another || (brings_offset(search_.law, general.name) && special != general.name);
      const double allowed = best->energies.sum() * (blurred ? kBlurred : general.in_catalogue ? 1.0 : 0.0);
      const CandidateTrial* trial = trial_of(round, special);
      if (trial == nullptr || !passes(*trial, round.evidence)) {
        continue;
      }
      if (trial->energies.sum() <= allowed || std::find(names.begin(), names.end(), special) != names.end()) {
        return trial;
      }
    }
    return best;
  }

  /// Leaves a tenth less or more, for certain.
  static auto does_better(const Round& round, std::size_t candidate, const CandidateTrial& trial) -> bool {
    constexpr double kTenthLess = 0.9;
    const auto other = std::find_if(round.trials.begin(), round.trials.end(),
                                    [candidate](const auto& one) { return one.candidate == candidate; });
    return other->energies.sum() < kTenthLess * trial.energies.sum() &&
           clearly_positive(trial.energies - other->energies);
  }

  /// Those that this log can not tell from the trial, without those that contain it: these never are told apart, unless
  /// another effect's wider form certainly does better.
  auto rivals(const Round& round, const CandidateTrial& trial) const -> std::vector<std::size_t> {
    const std::string& name = round.evidence.candidates[trial.candidate].name;
    auto candidates = confusable(round, trial);
    candidates.erase(
        std::remove_if(candidates.begin(), candidates.end(),
                       [&](std::size_t candidate) {
                         const Candidate& other = round.evidence.candidates[candidate];
                         return !(other.wider && other.name != name && does_better(round, candidate, trial)) &&
                                is_one_of(other.special_cases, name);
                       }),
        candidates.end());
    return candidates;
  }

  /// The two effects that a probe has within itself, where this log can not tell them together from it.
  static auto parts_of(const Round& round, const CandidateTrial& probe) -> std::optional<EffectPair> {
    const Candidate& candidate = round.evidence.candidates[probe.candidate];
    auto pair = candidate.in_catalogue ? std::nullopt : pair_of(round.evidence, candidate.special_cases);
    return pair && !clearly_positive(pair->energies - probe.energies) ? pair : std::nullopt;
  }

  /// Whether one effect explains most, and is a probe.
  static auto stands_in_for_most(const Round& round, const CandidateTrial* best) -> bool {
    return best != nullptr && best->explained >= kShareAlone * round.adequacy.reducible_share &&
           !round.evidence.candidates[best->candidate].in_catalogue;
  }

  /// The best pair where one effect explains too little; or where a probe explains most, or as much as the best, but
  /// two that are listed more.
  auto better_pair(const Round& round, const CandidateTrial* best) const -> std::optional<EffectPair> {
    const bool too_little = best == nullptr || best->explained < kShareAlone * round.adequacy.reducible_share;
    const bool clear =
        best != nullptr && round.evidence.candidates[best->candidate].in_catalogue && rivals(round, *best).empty();
    if (!too_little && clear) {
      return std::nullopt;
    }
    auto pair = best_pair(round.evidence, *search_.law.catalogue);
    return pair && (too_little || clearly_positive(best->energies - pair->energies)) ? pair : std::nullopt;
  }

  /// What sensors or a grid hide is not noise to the trials. No effect is named that is not larger than that; beside a
  /// grid, none where nothing is known to be missing.
  static auto may_be_hidden(const Round& round, const CandidateTrial& trial) -> bool {
    const bool grid = round.residual.adapted.cols() > 0;
    const double explained = trial.explained * round.adequacy.law_energy.sum();
    return explained < round.adequacy.hidden_energy || (grid && !round.adequacy.lacks_something);
  }

  /// Beside an effect that was found stands what its own term does not get quite right, certain in a long log and
  /// small: where nothing that matters is missing, what explains less than what matters has no name.
  auto hardly_matters(const Round& round, const CandidateTrial& trial) const -> bool {
    return !search_.effects.empty() && !round.adequacy.lacks_something && trial.explained < kMatters;
  }

  /// Adds what a round finds and holds the next one. False when nothing further is to be added.
  auto take_step(Round& round) -> bool {
    const CandidateTrial* best = simplest(round, best_passing(round, false), !search_.effects.empty());
    if (best != nullptr && (may_be_hidden(round, *best) || hardly_matters(round, *best))) {
      best = nullptr;
    }
    if (search_.effects.empty() && round.adequacy.lacks_something &&
        (add_pair(round, better_pair(round, best), stands_in_for_most(round, best)) ||
         (best != nullptr && add_pair(round, parts_of(round, *best))))) {
      return true;
    }
    if (best == nullptr) {
      search_.rounds.push_back(summary_of(round, nullptr, {}));
      return false;
    }
    auto confusable = rivals(round, *best);
    const CandidateTrial* chosen = best;
    if (!round.evidence.candidates[best->candidate].in_catalogue) {
      chosen = best_passing(round, true);
      const auto at =
          chosen == nullptr ? confusable.end() : std::find(confusable.begin(), confusable.end(), chosen->candidate);
      if (at == confusable.end()) {
        search_.rounds.push_back(summary_of(round, best, confusable));
        search_.unlisted = round.evidence.candidates[best->candidate].name;
        search_.lacks_something = search_.effects.empty() && best->explained > kMatters;
        return false;
      }
      confusable.erase(at);
      confusable.insert(confusable.begin(), best->candidate);
    }
    search_.rounds.push_back(summary_of(round, chosen, confusable));
    return add(round, *chosen, confusable);
  }

  auto add(Round& round, const CandidateTrial& trial, const std::vector<std::size_t>& confusable) -> bool {
    const bool further = !search_.effects.empty();
    if (further && !confusable.empty()) {
      return false;  // what remains is not one thing: it stays unlisted
    }
    const Proposal one = proposal(round, trial.candidate, trial.variant);
    const auto law = law_with(p_, search_.law, {one});
    if (!law) {
      refuse(one.name, "refused: a nonlinear parameter of it runs to the end of its range, or its sign is impossible");
      return false;
    }
    progress_("trying " + one.name);
    Round next = hold_round(p_, *law);
    const auto share =
        explained_share(round.adequacy.law_energy, next.adequacy.law_energy, next.adequacy.flexible_energy);
    if (further && share.lower < kShareOfRest) {
      refuse(one.name, "refused: it explains less than half of what is left to explain");
      return false;
    }
    search_.effects.push_back(added_effect(round, trial, confusable));
    search_.law = *law;
    round = std::move(next);
    return confusable.empty();
  }

  /// Two effects at once, each of which has to be the best where the other is already in the law, unless that builds on
  /// it. They may have to suffice: to leave nothing but noise.
  auto add_pair(Round& round, const std::optional<EffectPair>& pair, bool must_suffice = false) -> bool {
    if (!pair || explained_share(round.adequacy.law_energy, pair->energies, round.adequacy.flexible_energy).lower <
                     kShareAlone) {
      return false;
    }
    Proposal both[2] = {proposal(round, pair->candidate[0], pair->variant[0]),
                        proposal(round, pair->candidate[1], pair->variant[1])};
    auto law = law_with(p_, search_.law, {both[0], both[1]});
    std::vector<AddedEffect> effects;
    std::vector<RoundSummary> summaries = {summary_of(round, nullptr, {})};
    std::vector<std::string> doubtful;  // what a probe explains better where a third effect is missing
    for (std::size_t k = 0; k < 2 && law; ++k) {
      if (builds_on(both[1 - k].name, both[k].name)) {  // one makes no sense without the other
        effects.push_back(added_effect(round, *trial_of(round, both[k].name), {}));
        continue;
      }
      progress_("trying " + both[0].name + " and " + both[1].name);
      const Round without = hold_round(p_, law_without(*law, both[k].name));
      const CandidateTrial* best = simplest(without, best_passing(without, false), true);
      if (best != nullptr && !without.evidence.candidates[best->candidate].in_catalogue) {
        best = trial_of(without, both[k].name);
        doubtful.push_back(both[k].name);
      }
      if (best == nullptr || !passes(*best, without.evidence)) {
        return false;
      }
      effects.push_back(added_effect(without, *best, {}));
      summaries.push_back(summary_of(without, best, {}));
      // The pair was chosen from a grid; beside the other effect, fitted, a neighbour may do better.
      if (effects.back().name != both[k].name) {
        both[k] = proposal(without, best->candidate, best->variant);
        law = law_with(p_, search_.law, {both[0], both[1]});
      }
    }
    if (!law) {
      return false;
    }
    const bool larger_first = effects[0].explained >= effects[1].explained;
    if (builds_on(effects[0].name, effects[1].name) ||
        (!larger_first && !builds_on(effects[1].name, effects[0].name))) {
      std::swap(effects[0], effects[1]);
    }
    Round next = hold_round(p_, *law);
    if (!doubtful.empty() && !add_third(*law, next, doubtful, effects)) {
      return false;
    }
    if (must_suffice && next.adequacy.lacks_something) {
      return false;
    }
    search_.effects = effects;
    search_.rounds.insert(search_.rounds.end(), summaries.begin(), summaries.end());
    search_.law = *law;
    round = std::move(next);
    return true;
  }

  /// A third effect beside a pair, with which the doubtful ones of the pair are the best where they are missing.
  auto add_third(LawForm& law, Round& round, const std::vector<std::string>& doubtful,
                 std::vector<AddedEffect>& effects) -> bool {
    const CandidateTrial* third = simplest(round, best_passing(round, true), true);
    if (third == nullptr || !round.adequacy.lacks_something || !rivals(round, *third).empty()) {
      return false;
    }
    const auto with_third = law_with(p_, law, {proposal(round, third->candidate, third->variant)});
    const auto is_best = [&](const std::string& name) {
      const Round without = hold_round(p_, law_without(*with_third, name));
      const CandidateTrial* best = simplest(without, best_passing(without, false), true);
      return best != nullptr && without.evidence.candidates[best->candidate].name == name;
    };
    if (!with_third || !std::all_of(doubtful.begin(), doubtful.end(), is_best)) {
      return false;
    }
    effects.push_back(added_effect(round, *third, {}));
    law = *with_third;
    round = hold_round(p_, law);
    return true;
  }

  void refuse(const std::string& name, const std::string& why) {
    for (auto& ranked : search_.rounds.back().ranking) {
      if (ranked.name == name) {
        ranked.outcome = why;
      }
    }
  }

  /// An effect added early may be superfluous beside the later ones: it has to pass again where all the others are in
  /// the law.
  void check_backward(Round& round) {
    for (std::size_t i = 0; search_.effects.size() > 1 && i + 1 < search_.effects.size();) {
      const std::string name = search_.effects[i].name;
      if (others_build_on(name)) {
        ++i;
        continue;
      }
      progress_("checking " + name + " again");
      Round without = hold_round(p_, law_without(search_.law, name));
      const CandidateTrial* trial = trial_of(without, name);
      if (trial != nullptr && passes(*trial, without.evidence)) {
        ++i;
        continue;
      }
      search_.law = law_without(search_.law, name);
      search_.effects.erase(search_.effects.begin() + static_cast<std::ptrdiff_t>(i));
      round = std::move(without);
    }
  }

  /// A level that came with a spring which is gone is an effect by itself, or goes too.
  void settle_level(const LawForm& base, Round& round) {
    const std::string level = "offset";
    const bool named = std::any_of(search_.effects.begin(), search_.effects.end(),
                                   [&](const auto& effect) { return effect.name == level; });
    if (named || base.has(level) || !search_.law.has(level) || search_.law.has("spring")) {
      return;
    }
    Round without = hold_round(p_, law_without(search_.law, level));
    const CandidateTrial* trial = trial_of(without, level);
    if (trial != nullptr && passes(*trial, without.evidence)) {
      search_.effects.push_back(added_effect(without, *trial, {}));
    } else {
      search_.law = law_without(search_.law, level);
      round = std::move(without);
    }
  }

  auto builds_on(const std::string& effect, const std::string& base) const -> bool {
    const auto& below = search_.law.catalogue->term(effect).builds_on;
    return std::find(below.begin(), below.end(), base) != below.end();
  }

  auto others_build_on(const std::string& name) const -> bool {
    return std::any_of(search_.effects.begin(), search_.effects.end(),
                       [&](const auto& effect) { return builds_on(effect.name, name); });
  }

  void conclude(const Round& round) {
    search_.lacks_something = search_.lacks_something || round.adequacy.lacks_something;
    if (!search_.effects.empty()) {
      search_.share = explained_share(base_energy_, round.adequacy.law_energy, round.adequacy.flexible_energy);
    }
    const Eigen::VectorXd error = p_.target - round.residual.fitted;
    if (p_.repeats) {
      search_.noise_floor = pure_error_level(p_, error);
    } else {
      const auto rows = static_cast<double>(rows_in(p_.split.learned()));
      // Out of fold a law that the log hardly determines may leave any amount; what it leaves in the fit bounds the
      // noise.
      const double left = std::min({round.adequacy.flexible_energy.sum(), round.adequacy.law_energy.sum(),
                                    stacked(round.residual.error, p_.split.learned()).squaredNorm()});
      search_.noise_floor = std::sqrt(left / rows + averaged_out(p_, error));
    }
    for (const auto& trial : round.trials) {
      const auto& candidate = round.evidence.candidates[trial.candidate];
      if (candidate.in_catalogue && !candidate.wider) {
        search_.detectable.push_back({candidate.name, trial.detectable});
      }
    }
  }

  const Preparation& p_;
  const std::function<void(const std::string&)>& progress_;
  Search search_;
  Eigen::VectorXd base_energy_;
};

}  // namespace

auto search_effects(const Preparation& p, const LawForm& base, const std::function<void(const std::string&)>& progress)
    -> Search {
  return Searcher(p, base, progress).run();
}

}  // namespace capstan::tools
