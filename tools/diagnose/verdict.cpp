// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/diagnose/verdict.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <set>

#include "capstan/tools/diagnose/adequacy.hpp"
#include "capstan/tools/diagnose/free_run.hpp"
#include "capstan/tools/diagnose/left_to_choose.hpp"
#include "capstan/tools/diagnose/proposal.hpp"
#include "capstan/tools/identify/tendon_fit.hpp"
#include "capstan/tools/joint_file/table_section.hpp"
#include "capstan/tools/select/deciding_numbers.hpp"
#include "capstan/tools/support/statistics.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

/// More than kNamedShare where something is still missing beside the effects found: what has a name removes nearly all
/// that can be removed, and the nearest wrong name seldom does.
constexpr double kNamedShareBesideUnlisted = 0.9;

/// Where the running estimate does not know the direction yet, and what would show it sooner. Logs of a drawn joint, 50
/// to 1000 Hz, show 51 % of the reversals and more in the next row where no count of the encoder hides them (28 Nov
/// 2026).
auto late_direction(const Preparation& p) -> std::string {
  const bool by_rate = share_late_by_one_row(p) > 0.5;
  const std::string stem = "most of the running estimate's error is just after reversals, before ";
  return stem + (by_rate ? "the log's next row shows them, so no log at this rate can show what a law lacks there; log "
                           "at a higher rate"
                         : "this encoder shows them, so no log of it can show what a law lacks there; use a finer "
                           "encoder or a smaller direction threshold");
}

auto next_motion(const Diagnosis& d, const std::string& name) -> std::string {
  const Catalogue& catalogue = *d.base.catalogue;
  return catalogue.has(name) ? catalogue.term(name).exciting_motion
                             : "reversals under several loads and speeds, with holds";
}

/// The verdict where no effect was found.
auto judge_empty(const Search& search, Diagnosis& d) -> Verdict {
  if (search.lacks_something) {
    d.unlisted = search.unlisted;
    d.reason = reason_without_name(d.unlisted);
    d.next_experiment = kEverything;
    if (const auto axis = axis_of_probe(search.unlisted)) {
      d.next_experiment =
          "Repeat the diagnosis with --coupled-to " + std::to_string(*axis) + ": that axis may pull at this one.";
    }
    return Verdict::kUnknown;
  }
  d.reason = "The residual cannot be distinguished from noise.";
  return Verdict::kNothingMissing;
}

/// The verdict where `found` can not be told from other effects.
auto judge_ambiguous(const AddedEffect& effect, Diagnosis& d) -> Verdict {
  constexpr std::size_t kMostAlternatives = 3;  // more is no answer
  const bool all_listed = std::all_of(effect.alternatives.begin(), effect.alternatives.end(),
                                      [&d](const auto& name) { return d.base.catalogue->has(name); });
  if (effect.alternatives.size() > kMostAlternatives || !all_listed) {
    d.reason = "Something is missing from the law, but this log cannot distinguish " + effect.name + " from " +
               joined(effect.alternatives) + ".";
    d.next_experiment = kEverything;
    return Verdict::kUnknown;
  }
  d.reason = "The law lacks " + effect.name + " or " + joined(effect.alternatives, " or ") +
             "; this log cannot distinguish them.";
  d.next_experiment = "Record this motion, which separates them: " + next_motion(d, effect.name) + "; " +
                      next_motion(d, effect.alternatives.front()) + ".";
  return Verdict::kAmbiguous;
}

/// An error as a share of the target's rms about its mean.
auto share_of_target(const Preparation& p, double rmse) -> double {
  const double size = rms_about_mean(p.target);
  return size > 0.0 ? rmse / size : 1.0;
}

/// Share of the largest of the effects that the log would just have shown.
auto largest_hidden_share(const Preparation& p, const Diagnosis& d) -> double {
  double largest = 0.0;
  for (const auto& effect : d.detectable) {
    largest = std::max(largest, effect.rmse);
  }
  return d.detectable.empty() ? 1.0 : share_of_target(p, largest);
}

/// Whether most of what an estimate errs above the noise lies where the running switch does not know the direction.
auto late_direction_weighs_most(const Preparation& p, const Diagnosis& d, const Eigen::VectorXd& estimate) -> bool {
  constexpr double kMost = 0.5;
  const double known = error_of_known_direction(p, estimate);
  const double error = report_error(p, estimate).rmse;
  const double all = error * error;
  const double above_noise = all - d.noise_floor * d.noise_floor;
  return all - known * known > kMost * above_noise;
}

void refuse_completeness(const std::string& why, Diagnosis& d) {
  say({Verdict::kUnknown, why, kEverything}, d);
}

/// `nothing_missing` has to be earned.
void check_completeness(const Preparation& p, Diagnosis& d) {
  // What a grid of relays rounds off repeats and is no effect, so a force law is not held to the floor.
  const bool held_to_floor = d.base.catalogue->target() != TargetKind::kForce;
  if (held_to_floor && d.before.rmse > kAboveFloor * d.noise_floor) {
    if (late_direction_weighs_most(p, d, d.traces.before)) {
      d.warnings.push_back(late_direction(p));
    } else {
      refuse_completeness("The law leaves " + rounded(d.before.rmse / d.noise_floor, 2) +
                              " times the noise on rows set aside, and no effect is certain to lower that.",
                          d);
      return;
    }
  }
  // What comes and goes from one cycle to the next passes for noise there, as a joint does that sticks for a while.
  const double floor_share = share_of_target(p, d.noise_floor);
  const bool repeats_agree = p.repeats && floor_share <= kLargestHiddenShare;
  if (!repeats_agree && largest_hidden_share(p, d) > kLargestHiddenShare) {
    refuse_completeness(p.repeats
                            ? "No effect shows, but the repeated cycles differ by " + rounded(100.0 * floor_share, 2) +
                                  " % of the motion, so an effect of a tenth of the motion could be hidden."
                            : "No effect shows, but without repeated cycles this log would not show one of a "
                              "tenth of the motion either.",
                        d);
    return;
  }
  std::vector<std::string> sizes;
  for (const auto& effect : d.detectable) {
    sizes.push_back(effect.name + " " + rounded(effect.rmse, 2));
  }
  d.warnings.push_back("smallest contributions that this log would show, rms in " + d.unit + ": " + joined(sizes));
  if (!p.repeats) {
    d.warnings.push_back(
        "the motion does not repeat, so a weak effect outside the catalogue may hide in the noise; "
        "record the same cycle four times");
  }
}

/// Signal and form that a term of a law stands for.
struct Dependence {
  std::string signal, form;
};

auto dependence_of(const TermChoice& choice, const Preparation& p, const std::string& axis) -> Dependence {
  const std::string q1 = axis + "/q1";
  const auto other = [&](std::size_t slot) {
    const auto& others = p.logs.front().others;
    return slot < others.size() ? "axis" + std::to_string(others[slot].number) + "/q1" : std::string("another axis");
  };
  if (choice.term.starts_with("coupled_hysteresis")) {
    const char last = choice.term.back();
    return {other(last == '2' ? 1 : (last == '3' ? 2 : 0)), "another joint's tendon with its own hysteresis"};
  }
  if (choice.term == "table") {
    const auto signal = static_cast<TableSignal>(std::lround(choice.shapes[0]));
    const auto factor = static_cast<TableFactor>(std::lround(choice.shapes[4]));
    return {
        signal == TableSignal::kMotorAngle ? q1 : (signal == TableSignal::kTorque ? axis + "/tau" : describe(signal)),
        factor == TableFactor::kOne ? "curve" : std::string("curve times ") + describe(factor)};
  }
  static const std::map<std::string, std::string> kOverTheAngle = {{"curved_ratio", "curve"},
                                                                   {"presliding", "rounded hysteresis"},
                                                                   {"angle_periodic", "wave"},
                                                                   {"gravity", "weight"},
                                                                   {"transport_delay", "delay"}};
  if (const auto form = kOverTheAngle.find(choice.term); form != kOverTheAngle.end()) {
    return {q1, form->second};
  }
  return choice.term == "thermal_drift" ? Dependence{"time", "drift"} : Dependence{axis + "/tau", choice.term};
}

/// Calls `look(term, i, column)` for the coefficients of a law, `i` counted from the first of the term.
/// @param columns  law_columns()
void for_each_column(const Eigen::MatrixXd& columns, const LawForm& law,
                     const std::function<void(const CatalogueTerm&, std::size_t, const Eigen::VectorXd&)>& look) {
  Eigen::Index column = 0;
  for (const CatalogueTerm* term : ordered_terms(law)) {
    for (std::size_t i = 0; i < term->coefficients.size(); ++i) {
      look(*term, i, columns.col(column++));
    }
  }
}

auto is_usual(const std::string& term) -> bool {
  const auto usual = terms_of_model(kDefaultModel);
  return term == kTendonModel || std::find(usual.begin(), usual.end(), term) != usual.end();
}

}  // namespace

auto undetermined(const Preparation& p, const LawForm& law) -> std::vector<std::string> {
  if (law.has("preisach")) {
    return {};
  }
  // Knots of a table take up what the rest leaves, a level too, and mean nothing one by one: what the rest is worth is
  // asked without them.
  const LawForm asked = law.has(kTableTerm) ? law_without(law, kTableTerm) : law;
  const Eigen::MatrixXd columns = law_columns(p.causal, asked);
  const Blocks blocks = refined(p.split, p.factor).learned();
  auto names =
      undetermined_coefficients(fit_columns(columns, p.target, blocks, law_signs(asked)), asked, columns, p.target);
  // Nor is a part of an effect asked for whose signal the log lacks, as a drift's temperature without a thermometer.
  for_each_column(columns, asked, [&names](const CatalogueTerm& term, std::size_t i, const Eigen::VectorXd& column) {
    if (!is_usual(term.name) && term.coefficients.size() > 1 && column.isZero(0.0)) {
      std::erase(names, term.name + "." + term.coefficients[i].name);
    }
  });
  return names;
}

void keep_what_is_not_asked(const Preparation& p, const JointFile& given, JointFile& law) {
  const LawForm form = form_of(law);
  for_each_column(law_columns(p.causal, form), form,
                  [&](const CatalogueTerm& term, std::size_t i, const Eigen::VectorXd& column) {
                    const std::size_t at = term.first_coefficient + i;
                    if (given.has(term.name) && column.isZero(0.0)) {
                      law.parameters.coefficients[at] = given.parameters.coefficients[at];
                      law.coefficient_ci95[at] = given.coefficient_ci95[at];
                    }
                  });
}

auto unfit(const std::string& what_for, const std::string& reason) -> Nameless {
  return {Verdict::kDataUnfit, "The log is not fit for " + what_for + ": " + reason + ".",
          reason.substr(reason.find(';') + 2)};
}

auto nameless(const Preparation& p, const LawForm& law) -> std::optional<Nameless> {
  if (const std::string reason = reason_nameless(p.logs); !reason.empty()) {
    return unfit("naming what the law lacks", reason);
  }
  if (const auto names = undetermined(p, law); !names.empty()) {
    return Nameless{Verdict::kNotIdentifiable, "This log cannot determine " + joined(names) + " of the base law.",
                    kEverything};
  }
  return std::nullopt;
}

void say(const Nameless& why, Diagnosis& d) {
  d.verdict = why.verdict;
  d.reason = why.reason;
  d.next_experiment = why.next_experiment;
}

auto judge(const Search& search, Diagnosis& d) -> Verdict {
  if (search.effects.empty()) {
    return judge_empty(search, d);
  }
  const std::string found = names_of(search.effects);
  if (search.share.lower < (search.lacks_something ? kNamedShareBesideUnlisted : kNamedShare)) {
    const long certain = std::lround(100.0 * std::max(0.0, search.share.lower));
    d.reason = "Something is missing from the law; " + found + " is only certain to explain " +
               std::to_string(certain) + " % of what can be explained, so it is not named.";
    d.next_experiment = kEverything;
    return Verdict::kUnknown;
  }
  if (!search.effects.front().alternatives.empty()) {
    return judge_ambiguous(search.effects.front(), d);
  }
  if (search.lacks_something && search.share.lower < kWholeEffect) {
    d.reason = "The law lacks " + found + ", and something beyond it that is not in the catalogue";
    d.reason += search.unlisted.empty() ? "." : " (most like " + search.unlisted + ").";
    return Verdict::kEffectPlusUnlisted;
  }
  d.reason = "The law lacks " + found +
             (search.lacks_something
                  ? "; a small residual remains, no larger than a slightly wrong form of that term would cause."
                  : "; what remains cannot be distinguished from noise.");
  return Verdict::kEffect;
}

void hold_to_own_logs(const Preparation& p, const JointFile& law, Diagnosis& d) {
  const double known = noise_known(p, law);
  if (d.verdict == Verdict::kNothingMissing && d.before.rmse > kAboveFloor * known) {
    refuse_completeness(
        "The law leaves " + rounded(d.before.rmse / known, 2) +
            " times the error on its own logs: an effect has appeared, and this log does not show which.",
        d);
  }
}

void bound_floor_by(const JointFile& law, const Preparation& p, Diagnosis& d) {
  const double known = noise_known(p, law);
  if (known < d.noise_floor) {
    d.noise_floor = known;
    d.floor_from = "law";
  }
}

auto names_of(const std::vector<AddedEffect>& effects) -> std::string {
  std::vector<std::string> names;
  std::transform(effects.begin(), effects.end(), std::back_inserter(names), [](const auto& one) { return one.name; });
  return joined(names, " and ");
}

auto what_the_law_lacks(const std::vector<AddedEffect>& effects) -> std::string {
  return "The law lacks " + names_of(effects);
}

auto axis_of_probe(const std::string& probe) -> std::optional<int> {
  const auto slash = probe.find('/');
  const bool is_column = probe.starts_with("axis") && slash != std::string::npos;
  return is_column ? std::optional(std::stoi(probe.substr(4, slash - 4))) : std::nullopt;
}

auto reason_without_name(const std::string& unlisted, const std::string& held_as) -> std::string {
  const std::string reason = "Something is missing from the law, and nothing in the catalogue explains it";
  if (unlisted.empty()) {
    return reason + ".";
  }
  return reason + "; it is most like " + unlisted + ", which " +
         (held_as.empty() ? "this version can not add." : "the delivered law holds as " + held_as + ".");
}

auto gains_nothing(const Preparation& p, const Diagnosis& d) -> bool {
  const double before = error_of_known_direction(p, d.traces.before);
  const double after = error_of_known_direction(p, d.traces.after);
  return after * after > (1.0 - kMatters) * before * before;
}

void reconcile(const Preparation& p, const Search& search, const LawChoice& choice, Diagnosis& d) {
  const bool more_than_named = choice.status == LawStatus::kProvisional;
  if (d.verdict == Verdict::kEffect && (more_than_named || d.after.rmse > kAboveFloor * d.noise_floor)) {
    d.reason = what_the_law_lacks(search.effects);
    if (d.found && late_direction_weighs_most(p, d, estimates(p.logs, p.causal, *d.found))) {
      d.reason += "; " + late_direction(p) + ".";
    } else if (more_than_named) {
      d.verdict = Verdict::kEffectPlusUnlisted;
      d.reason += kMoreThanNamed;
    } else {
      d.reason += "; no effect of the catalogue lowers the error further.";
    }
  } else if (d.verdict == Verdict::kNothingMissing && more_than_named) {
    refuse_completeness(kAnotherPredictsBetter, d);
  } else if (d.verdict == Verdict::kNothingMissing) {
    check_completeness(p, d);
  }
  if (choice.is_named && !d.effects.empty() && d.ratio_ci95[1] >= 1.0) {
    d.warnings.push_back("the running estimate gains little: " + late_direction(p));
  }
}

auto unnamed_part(const Preparation& p, const LawChoice& choice, const Diagnosis& d) -> std::optional<UnnamedPart> {
  if (choice.status != LawStatus::kProvisional) {
    return std::nullopt;
  }
  const std::string axis = d.target.substr(0, d.target.find('/'));
  const LawCandidate law = candidate_of(form_of(choice.law));
  std::vector<std::string> signals, forms;
  const auto add = [&](const Dependence& one) {
    if (std::find(signals.begin(), signals.end(), one.signal) == signals.end()) {
      signals.push_back(one.signal);
    }
    if (std::find(forms.begin(), forms.end(), one.form) == forms.end()) {
      forms.push_back(one.form);
    }
  };
  if (!law.plays.empty()) {
    add({axis + "/q1", "hysteresis"});
  }
  for (const auto& choice_of_term : law.terms) {
    if (!d.base.has(choice_of_term.term)) {
      add(dependence_of(choice_of_term, p, axis));
    }
  }
  if (signals.empty()) {
    return std::nullopt;
  }
  const double left = d.before.rmse > 0.0 ? d.after.rmse / d.before.rmse : 1.0;
  const double share = std::max(0.0, 1.0 - left * left);
  UnnamedPart part{signals, joined(forms, " + "), share, std::sqrt(share) * d.before.rmse, {}};
  part.sentence = "What the base law leaves depends on " + joined(signals, " and ") + " (" + joined(forms, ", ") +
                  "); that takes away " + rounded(100.0 * share, 3) + " % of its energy on rows set aside.";
  return part;
}

auto candidate_shares(const Search& search) -> std::vector<CandidateShare> {
  constexpr std::size_t kMost = 5;
  std::vector<CandidateShare> shares;
  if (search.rounds.empty()) {
    return shares;
  }
  for (const auto& ranked : search.rounds.front().ranking) {
    if (ranked.in_catalogue && ranked.explained > 0.0) {
      shares.push_back({ranked.name, ranked.explained});
    }
  }
  std::stable_sort(shares.begin(), shares.end(), [](const auto& a, const auto& b) { return a.share > b.share; });
  shares.resize(std::min(shares.size(), kMost));
  return shares;
}

}  // namespace capstan::tools
