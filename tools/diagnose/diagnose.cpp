// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "tools/diagnose/free_run.hpp"
#include "tools/diagnose/search.hpp"
#include "tools/identify/force_catalogue.hpp"
#include "tools/support/errors.hpp"
#include "tools/support/statistics.hpp"
#include "tools/support/text.hpp"

namespace capstan::tools {
namespace {

/// The effects found must explain more than this of what can be explained, or none of them is named.
constexpr double kNamedShare = 0.5;
/// And more than this where something is still missing beside them: what has a name removes nearly all that can be
/// removed, and the nearest wrong name seldom does.
constexpr double kNamedShareBesideUnlisted = 0.9;

constexpr const char* kLateDirection =
    "most of the running estimate's error is where the motor has turned and its encoder does not show it yet, and what "
    "a law lacks there no log of this encoder shows; a finer encoder or a smaller direction threshold would";

constexpr const char* kEverything =
    "Record four equal cycles with reversals under several loads and at several speeds, and with holds.";

auto stacked_signal(const std::vector<AxisLog>& logs, Eigen::VectorXd AxisLog::*signal) -> Eigen::VectorXd {
  Eigen::Index rows = 0;
  for (const auto& log : logs) {
    rows += log.samples();
  }
  Eigen::VectorXd all(rows);
  rows = 0;
  for (const auto& log : logs) {
    all.segment(rows, log.samples()) = log.*signal;
    rows += log.samples();
  }
  return all;
}

void describe_logs(const std::vector<AxisLog>& logs, const DiagnoseOptions& options, Diagnosis& d) {
  d.target = logs.front().target;
  bool torque = true;
  for (const auto& log : logs) {
    d.samples += log.samples();
    d.warnings.insert(d.warnings.end(), log.warnings.begin(), log.warnings.end());
    torque = torque && log.has_torque;
  }
  d.rate_hz = logs.front().rate_hz();
  const bool effort = logs.front().motion_alone();
  const char* usual = effort ? kEffortModel : (torque ? kDefaultModel : "kinematic");
  d.base_model = options.base_model.empty() ? usual : options.base_model;
}

auto next_motion(const Diagnosis& d, const std::string& name) -> std::string {
  const Catalogue& catalogue = *d.base.catalogue;
  return catalogue.has(name) ? catalogue.term(name).exciting_motion
                             : "reversals under several loads and speeds, with holds";
}

/// The verdict where no effect was found.
auto judge_empty(const Search& search, const Preparation& p, Diagnosis& d) -> Verdict {
  if (search.lacks_something) {
    d.reason = "Something is missing from the law, and nothing in the catalogue explains it";
    d.reason +=
        search.unlisted.empty() ? "." : "; it is most like " + search.unlisted + ", which this version can not add.";
    d.next_experiment = kEverything;
    if (search.unlisted.rfind("axis", 0) == 0) {
      const std::string axis = search.unlisted.substr(4, search.unlisted.find('/') - 4);
      d.next_experiment = "Ask again with --coupled-to " + axis + ": that axis may pull at this one.";
    }
    return Verdict::kUnknown;
  }
  d.reason = "What the law leaves can not be told from noise.";
  d.warnings.push_back("smallest contributions that this log would have shown, rms in " + d.unit + ": " +
                       joined(search.detectable));
  if (!p.repeats) {
    d.warnings.push_back(
        "the motion does not repeat, so a weak effect outside the catalogue may hide in the noise; "
        "record the same cycle four times");
  }
  return Verdict::kNothingMissing;
}

/// The verdict where `found` can not be told from other effects.
auto judge_ambiguous(const AddedEffect& effect, Diagnosis& d) -> Verdict {
  constexpr std::size_t kMostAlternatives = 3;  // more is no answer
  const bool all_listed = std::all_of(effect.alternatives.begin(), effect.alternatives.end(),
                                      [&d](const auto& name) { return d.base.catalogue->has(name); });
  if (effect.alternatives.size() > kMostAlternatives || !all_listed) {
    d.reason = "Something is missing from the law, but this log can not tell " + effect.name + " from " +
               joined(effect.alternatives) + ".";
    d.next_experiment = kEverything;
    return Verdict::kUnknown;
  }
  d.reason = "The law lacks " + effect.name + " or " + joined(effect.alternatives, " or ") +
             "; this log can not tell them apart.";
  d.next_experiment = "Record this motion, it separates them: " + next_motion(d, effect.name) + "; " +
                      next_motion(d, effect.alternatives.front()) + ".";
  return Verdict::kAmbiguous;
}

/// Puts the search into words and decides what may be named.
auto judge(const Search& search, const Preparation& p, Diagnosis& d) -> Verdict {
  if (search.effects.empty()) {
    return judge_empty(search, p, d);
  }
  std::vector<std::string> names;
  for (const auto& effect : search.effects) {
    names.push_back(effect.name);
  }
  const std::string found = joined(names, " and ");
  if (search.share.lower < (search.lacks_something ? kNamedShareBesideUnlisted : kNamedShare)) {
    const long certain = std::lround(100.0 * std::max(0.0, search.share.lower));
    d.reason = "Something is missing from the law; " + found + " explains no more than " + std::to_string(certain) +
               " % of what can be explained for certain, so it is not named.";
    d.next_experiment = kEverything;
    return Verdict::kUnknown;
  }
  if (!search.effects.front().alternatives.empty()) {
    return judge_ambiguous(search.effects.front(), d);
  }
  if (search.lacks_something) {
    d.reason = "The law lacks " + found + ", and something beyond it that is not in the catalogue";
    d.reason += search.unlisted.empty() ? "." : " (most like " + search.unlisted + ").";
    return Verdict::kEffectPlusUnlisted;
  }
  d.reason = "The law lacks " + found + "; what is left then can not be told from noise.";
  return Verdict::kEffect;
}

void keep_base_only(Diagnosis& d) {
  d.effects.clear();
  d.undetermined.clear();
  d.law = d.base;
  d.after = d.before;
  d.ratio_ci95 = {1.0, 1.0};
  d.traces.after = d.traces.before;
}

/// A Preisach table has cells that no motion but its recipe visits; they take no part then.
auto undetermined(const Preparation& p, const LawForm& law) -> std::vector<std::string> {
  if (law.has("preisach")) {
    return {};
  }
  const Eigen::MatrixXd columns = law_columns(p.causal, law);
  const Blocks blocks = refined(p.split, p.factor).learned();
  return undetermined_coefficients(fit_columns(columns, p.target, blocks, law_signs(law)), law, columns, p.target);
}

/// Whether the base law errs well above the noise, and most of that where the running switch does not know the
/// direction.
auto late_direction_weighs_most(const Preparation& p, const Diagnosis& d) -> bool {
  constexpr double kWellAboveNoise = 1.3;
  constexpr double kMost = 0.5;
  const double known = error_of_known_direction(p, d.traces.before);
  const double all = d.before.rmse * d.before.rmse;
  const double above_noise = all - d.noise_floor * d.noise_floor;
  return d.before.rmse > kWellAboveNoise * d.noise_floor && all - known * known > kMost * above_noise;
}

/// Reports once, on rows that chose nothing; an effect that does not lower the error there is taken back.
void report(const Preparation& p, const Search& search, const LawForm& base, Diagnosis& d) {
  d.base = causal_law(p, base);
  d.traces.before = estimates(p.logs, p.causal, d.base);
  d.before = report_error(p, d.traces.before);
  d.effects = search.effects;
  if (search.effects.empty() || is_refusal(d.verdict)) {
    keep_base_only(d);
    if (d.verdict == Verdict::kNothingMissing && late_direction_weighs_most(p, d)) {
      d.warnings.push_back(kLateDirection);
    }
    return;
  }
  d.law = causal_law(p, search.law);
  d.undetermined = undetermined(p, search.law);
  d.traces.after = estimates(p.logs, p.causal, d.law);
  d.after = report_error(p, d.traces.after);
  d.ratio_ci95 = ratio_interval(p, d.traces.before, d.traces.after);
  if (d.ratio_ci95[0] >= 1.0 || !holds_on_unseen_rows(p, base, search.law)) {
    const bool missing = search.base_reducible > 0.05;
    d.reason = "On rows that took no part in the choice, " + search.effects.front().name +
               " does not lower the error for certain, so it was not added.";
    d.verdict = missing ? Verdict::kUnknown : Verdict::kNothingMissing;
    keep_base_only(d);
  } else if (d.ratio_ci95[1] >= 1.0) {
    d.warnings.push_back("the running estimate gains little: " + std::string(kLateDirection));
  }
  if (!d.undetermined.empty()) {
    d.warnings.push_back("this log can not determine " + joined(d.undetermined) +
                         ": other values would fit as well, so the law holds for motions like this one only");
  }
}

/// The base law to start from; empty, with verdict and cure written, where the logs are not fit for it.
auto base_law(const std::vector<AxisLog>& logs, const DiagnoseOptions& options, Diagnosis& d)
    -> std::optional<LawForm> {
  std::string unfit = reason_unfit(logs);
  if (unfit.empty()) {
    try {
      return options.base_law ? *options.base_law : form_of_model(d.base_model, logs);
    } catch (const Refusal& refusal) {  // a force law has to be fitted to know where its search begins
      unfit = refusal.what();
    }
  }
  d.verdict = Verdict::kDataUnfit;
  d.reason = "The log is not fit for a diagnosis: " + unfit + ".";
  d.next_experiment = unfit.substr(unfit.find(';') + 2);
  return std::nullopt;
}

/// Searches, judges and reports.
void examine(const Preparation& p, const LawForm& base, const DiagnoseOptions& options, Diagnosis& d) {
  const Search search = search_effects(p, base, options.progress);
  d.rounds = search.rounds;
  d.explained_share = search.share.value;
  d.explained_share_lower = search.share.lower;
  d.noise_floor = search.noise_floor;
  d.floor_from_repeats = p.repeats.has_value();
  d.verdict = judge(search, p, d);
  options.progress("measuring the error on rows set aside");
  d.traces.time_s = stacked_signal(p.logs, &AxisLog::time_s);
  d.traces.q1 = stacked_signal(p.logs, &AxisLog::q1_rad);
  d.traces.measured = p.target;
  report(p, search, base, d);
  if (!d.effects.empty() && !p.repeats) {
    d.warnings.push_back(
        "the motion does not repeat, so the noise had to be judged from the residual: take the verdict as indicated, " +
        std::string("and confirm it with a log of four equal cycles"));
  }
}

}  // namespace

auto diagnose(const std::vector<AxisLog>& recorded, const DiagnoseOptions& options) -> Diagnosis {
  Diagnosis d;
  describe_logs(recorded, options, d);
  const Catalogue& catalogue =
      options.base_law ? *options.base_law->catalogue : catalogue_of_model(d.base_model, recorded);
  d.unit = catalogue.target_unit();
  d.motion_unit = catalogue.motion_unit();
  d.base = d.law = JointFile(catalogue);
  options.progress("checking the log");
  std::vector<AxisLog> logs = recorded;
  if (catalogue.target() == TargetKind::kForce) {
    std::transform(logs.begin(), logs.end(), logs.begin(),
                   [&d](const auto& log) { return averaged_for_force(d.base_model, log); });
  }
  const auto base = base_law(logs, options, d);
  if (!base) {
    return d;
  }
  const Preparation p = prepare(std::move(logs), *base);
  d.warnings.insert(d.warnings.end(), p.notes.begin(), p.notes.end());
  d.repeats = p.repeats ? p.repeats->count : 1;
  if (const auto names = undetermined(p, *base); !names.empty()) {
    d.verdict = Verdict::kNotIdentifiable;
    d.reason = "This log can not determine " + joined(names) + " of the base law.";
    d.next_experiment = kEverything;
    return d;
  }
  examine(p, *base, options, d);
  return d;
}

}  // namespace capstan::tools
