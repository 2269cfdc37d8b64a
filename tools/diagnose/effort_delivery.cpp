// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/diagnose/effort_delivery.hpp"

#include <algorithm>
#include <cmath>

#include "capstan/tools/diagnose/delivered_law.hpp"
#include "capstan/tools/diagnose/free_run.hpp"
#include "capstan/tools/diagnose/pull_push_base.hpp"
#include "capstan/tools/diagnose/verdict.hpp"
#include "capstan/tools/identify/identify.hpp"
#include "capstan/tools/identify/law_fit.hpp"
#include "capstan/tools/select/deciding_numbers.hpp"
#include "capstan/tools/select/effort_catalogue.hpp"
#include "capstan/tools/support/statistics.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

/// The unseen rows in equal blocks, which are resampled whole.
auto unseen_blocks(const EffortSelection& selection) -> Blocks {
  constexpr Eigen::Index kBlocks = 20;
  const Eigen::Index rows = selection.measured.size() - selection.first_unseen;
  Blocks blocks;
  for (Eigen::Index i = 0; i < kBlocks; ++i) {
    const Eigen::Index begin = selection.first_unseen + i * rows / kBlocks;
    const Eigen::Index end = selection.first_unseen + (i + 1) * rows / kBlocks;
    if (end > begin) {
      blocks.push_back({begin, end});
    }
  }
  return blocks;
}

auto halves_won(const EffortSelection& selection) -> int {
  const Eigen::Index rows = (selection.measured.size() - selection.first_unseen) / 2;
  int won = 0;
  for (const Eigen::Index begin : {selection.first_unseen, selection.first_unseen + rows}) {
    const auto left = [&](const Eigen::VectorXd& estimate) {
      return rms((selection.measured - estimate).segment(begin, rows));
    };
    won += left(selection.by_law) <= left(selection.by_start) ? 1 : 0;
  }
  return won;
}

/// The search for names has found effects that leave nothing to choose: its law is delivered.
auto is_certain(const Diagnosis& d) -> bool {
  return d.verdict == Verdict::kEffect && d.law.status == LawStatus::kConfirmed;
}

/// Effects were named, and the law with them errs no more on the rows that it has not seen than the grown one on its
/// own. The grown law's motion is seen through 0.12 s, which fast motion does not survive: EMPS, 2.8 % named, 11 grown.
auto names_do_as_well(const Diagnosis& d, const EffortSelection& selection) -> bool {
  return !d.effects.empty() && d.after.relative_percent * selection.target_rms <= 100.0 * selection.after;
}

/// No law may be called complete where another errs so much less, for certain. A tenth, as of an effect that could hide
/// (check_completeness); chosen on no log.
constexpr double kClearlyLess = 0.9;

/// The grown law errs clearly less on rows that it has not seen than the named one, which has seen them, against an
/// effort seen as the grown law sees it, which averages noise away. Against one seen as the named law does, in which
/// fast motion survives, it errs clearly less too where it is given that motion; or, as it runs, not more for certain:
/// noise there hides how much less (psm_one's roll joint, 29 November 2026: 0.45 and 0.92 of the named law's error).
auto clearly_beats(const EffortSelection& selection, const EffortLaw& named, const std::vector<AxisLog>& logs) -> bool {
  const auto ratio = [&](const EffortView& seen, const EffortView& grown) {
    const Eigen::VectorXd measured = EffortDesign(logs, seen).seen(stacked_target(logs));
    const auto estimate = [&](EffortLaw law, const EffortView& view) {
      law.view = view;
      return run_effort_law(logs, law);
    };
    return ratio_interval(measured, unseen_blocks(selection), estimate(named, seen), estimate(selection.law, grown));
  };
  const EffortView& own = selection.law.view;
  return ratio(own, own)[1] < kClearlyLess &&
         (ratio(named.view, named.view)[1] < kClearlyLess || ratio(named.view, own)[0] < 1.0);
}

/// What the law has beside what it began with, by the names of effects.
auto beside_start(const EffortSelection& selection) -> std::vector<std::string> {
  std::vector<std::string> names;
  for (const auto& term : selection.law.joint.terms) {
    const std::string name = effect_name(term);
    if (!selection.start.joint.has(term) && std::find(names.begin(), names.end(), name) == names.end()) {
      names.push_back(name);
    }
  }
  return names;
}

/// The law holds nothing beside what it began with but what the names say: their own law, fitted through another view.
auto holds_only_names(const EffortSelection& selection, const Diagnosis& d) -> bool {
  const auto names = beside_start(selection);
  return std::all_of(names.begin(), names.end(), [&d](const std::string& name) {
    return std::any_of(d.effects.begin(), d.effects.end(), [&](const auto& effect) { return effect.name == name; });
  });
}

/// What the law corrects without a name for it.
auto unnamed_of(const EffortSelection& selection, const std::vector<std::string>& effects, const Diagnosis& d)
    -> UnnamedPart {
  UnnamedPart part;
  const std::string axis = d.target.substr(0, d.target.find('/'));
  part.signals = {axis + "/q1"};
  for (const auto& term : selection.law.joint.terms) {
    const auto& of_axis = selection.law.joint.catalogue->term(term).of_axis;
    if (of_axis) {
      const std::string other = "axis" + std::to_string(*of_axis) + "/q1";
      if (std::find(part.signals.begin(), part.signals.end(), other) == part.signals.end()) {
        part.signals.push_back(other);
      }
    }
  }
  part.form = joined(effects);
  const double energy = d.before.rmse * d.before.rmse;
  part.share = energy > 0.0 ? std::max(0.0, 1.0 - d.after.rmse * d.after.rmse / energy) : 0.0;
  part.rmse = std::sqrt(part.share * energy);
  part.sentence = "the law corrects " + std::to_string(std::lround(100.0 * part.share)) +
                  " % of the energy that the base law leaves, by " + part.form +
                  "; which of these the machine has is not certain, so their numbers and intervals are this law's";
  return part;
}

void replace_traces(const std::vector<AxisLog>& logs, const Eigen::VectorXd& measured, const Eigen::VectorXd& before,
                    const Eigen::VectorXd& after, Traces& traces) {
  const Eigen::Index rows = measured.size();
  const bool of_gear = !logs.front().motion_alone();
  traces.time_s.resize(rows);
  traces.q1.resize(rows);
  traces.load.resize(of_gear ? rows : 0);
  Eigen::Index row = 0;
  for (const auto& log : logs) {
    traces.time_s.segment(row, log.samples()) = log.time_s;
    traces.q1.segment(row, log.samples()) = log.q1_rad;
    if (of_gear) {
      traces.load.segment(row, log.samples()) = log.tau_nm;
    }
    row += log.samples();
  }
  traces.measured = measured;
  traces.before = before;
  traces.after = after;
}

/// Names that the delivered law has no term for are taken back: it explains by others what they stood for.
/// @param more_than_named  the delivered law certainly errs less than that with the names
void keep_held_names(const EffortSelection& selection, bool more_than_named, Diagnosis& d) {
  if (d.effects.empty()) {
    return;
  }
  const auto& terms = selection.law.joint.terms;
  const auto is_held = [&](const std::string& name) {
    return std::any_of(terms.begin(), terms.end(), [&](const auto& term) { return effect_name(term) == name; });
  };
  std::vector<AddedEffect> held;
  std::copy_if(d.effects.begin(), d.effects.end(), std::back_inserter(held), [&](const auto& effect) {
    return is_held(effect.name) || std::any_of(effect.alternatives.begin(), effect.alternatives.end(), is_held);
  });
  if (held.empty()) {
    say({Verdict::kUnknown,
         "Something is missing from the law, and the law that is delivered explains it by other terms than " +
             names_of(d.effects) + ", so it is not named.",
         kEverything},
        d);
  } else if ((more_than_named && d.verdict != Verdict::kAmbiguous) || held.size() < d.effects.size()) {
    d.verdict = Verdict::kEffectPlusUnlisted;
    d.reason = what_the_law_lacks(held) + kMoreThanNamed;
  }
  d.effects = std::move(held);
}

/// Share of the energy that rounds to a percent.
constexpr double kSaid = 0.005;

/// Law, errors and traces of the selection in the place of what the search for names ended with.
void take_selection(const std::vector<AxisLog>& logs, EffortSelection& selection, const Interval& ratio, Diagnosis& d) {
  const std::vector<std::string> effects = beside_start(selection);
  set_status(effects.empty() ? LawStatus::kBase : LawStatus::kProvisional, selection.law);
  const Eigen::Index unseen = selection.measured.size() - selection.first_unseen;
  const Eigen::VectorXd measured = selection.measured.tail(unseen);
  d.before = error_summary(measured, selection.by_start.tail(unseen));
  d.after = error_summary(measured, selection.by_law.tail(unseen));
  d.ratio_ci95 = ratio;
  bound_floor(d);
  d.halves_agree = halves_won(selection);
  d.unnamed = effects.empty() ? std::nullopt : std::optional(unnamed_of(selection, effects, d));
  if (d.unnamed && d.unnamed->share < kSaid) {
    d.unnamed.reset();
  }
  d.base = selection.start.joint;
  d.law = selection.law.joint;
  d.undetermined.clear();  // of the law that this one replaces
  d.effort_law = selection.law;
  replace_traces(logs, selection.measured, selection.by_start, selection.by_law, d.traces);
}

/// The base law in the place of what the search ended with, its errors those of a board that runs it.
void take_base(const std::vector<AxisLog>& logs, const PullPushBase& base, Eigen::Index first_unseen, Diagnosis& d) {
  const Eigen::VectorXd measured = stacked_target(logs);
  const Eigen::Index unseen = measured.size() - first_unseen;
  if (!d.effects.empty()) {
    d.warnings.push_back("no file holds a pull-push law with " + names_of(d.effects) +
                         ", so the law is delivered without; on rows set aside the search's law left " +
                         rounded(d.before.rmse, 3) + " Nm without and " + rounded(d.after.rmse, 3) + " Nm with it");
  }
  d.base = d.law = base.joint;
  d.pull_push = base.fit;
  d.before = d.after = error_summary(measured.tail(unseen), base.estimate.tail(unseen));
  d.ratio_ci95 = {1.0, 1.0};
  bound_floor(d);
  d.unnamed.reset();
  d.candidates.clear();
  d.undetermined.clear();
  replace_traces(logs, measured, base.estimate, base.estimate, d.traces);
}

/// Of the torque behind a gear: what was asked for, unless a law that is grown errs clearly less on the rows that
/// neither has seen. Where the logs do not determine what was asked for, no file holds it, and the grown one takes its
/// place if it is not certain to err more.
void deliver_gear_law(const std::vector<AxisLog>& logs, Diagnosis& d) {
  EffortSelection selection = select_effort_law(logs);
  const auto base = pull_push_base(logs, d.base, selection.first_unseen);
  if (base) {
    selection.start.joint = base->joint;
    selection.by_start = EffortDesign(logs, selection.law.view).seen(base->estimate);
  } else {
    d.base_model = joined(selection.start.joint.terms, " + ");
  }
  const Interval ratio =
      ratio_interval(selection.measured, unseen_blocks(selection), selection.by_start, selection.by_law);
  const bool is_better = ratio[1] < kClearlyLess;
  if (base && base->fit && !is_better) {
    take_base(logs, *base, selection.first_unseen, d);
    d.halves_agree = 2 - halves_won(selection);
    return;
  }
  if (base && !is_better) {
    const bool is_worse = ratio[0] > 1.0;
    d.warnings.push_back(
        (is_worse ? "no file holds the pull-push law of these logs: " : "the pull-push law is not delivered: ") +
        base->undetermined);
    if (is_worse) {  // the search's law stays, which is told and not written
      return;
    }
  }
  if (base) {
    d.pull_push = base->fit;
  }
  if (d.verdict == Verdict::kNothingMissing && is_better) {
    say({Verdict::kUnknown, kAnotherPredictsBetter, kEverything}, d);
  }
  keep_held_names(selection, is_better, d);
  take_selection(logs, selection, ratio, d);
}

}  // namespace

auto has_effort_law(const std::vector<AxisLog>& logs, const Diagnosis& d) -> bool {
  return logs.front().effort.size() > 0 && d.base_model != "preisach" && can_select_effort_law(logs);
}

void deliver_effort_law(const std::vector<AxisLog>& logs, Diagnosis& d) {
  if (!logs.front().motion_alone()) {
    deliver_gear_law(logs, d);
    return;
  }
  const bool leaves_much = d.after.rmse > kAboveFloor * d.noise_floor;
  // The search knows another axis's angle and torque, and its floor not even those. What the axis's speed and mass ask
  // of this motor only a law that is grown shows.
  if (is_certain(d) && !leaves_much && axes_beside(logs).empty()) {
    d.effort_law = runnable_law(d.law, logs);  // without growing another
    return;
  }
  EffortSelection selection = select_effort_law(logs, d.base_model == kInertiaModel);
  const auto named = [&] { return runnable_law(d.law, logs); };
  const bool more_than_named = is_certain(d) && clearly_beats(selection, named(), logs);
  const Interval ratio =
      ratio_interval(selection.measured, unseen_blocks(selection), selection.by_start, selection.by_law);
  const bool names_stand = !more_than_named && (is_certain(d) || names_do_as_well(d, selection));
  if (names_stand || (d.verdict == Verdict::kNothingMissing && ratio[1] > kClearlyLess)) {
    d.effort_law = named();
    return;
  }
  if (d.verdict == Verdict::kNothingMissing) {
    d.verdict = Verdict::kUnknown;
    d.reason = kAnotherPredictsBetter;
  }
  const bool same_effects = more_than_named && holds_only_names(selection, d);
  keep_held_names(selection, more_than_named && !same_effects, d);
  take_selection(logs, selection, ratio, d);
  if (same_effects && d.verdict == Verdict::kEffect) {
    set_status(LawStatus::kConfirmed, *d.effort_law);
    d.law.status = LawStatus::kConfirmed;
    d.unnamed.reset();
  }
}

}  // namespace capstan::tools
