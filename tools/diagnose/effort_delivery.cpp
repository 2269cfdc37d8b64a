// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/diagnose/effort_delivery.hpp"

#include <algorithm>
#include <cmath>

#include "capstan/tools/diagnose/delivered_law.hpp"
#include "capstan/tools/diagnose/free_run.hpp"
#include "capstan/tools/diagnose/verdict.hpp"
#include "capstan/tools/identify/identify.hpp"
#include "capstan/tools/identify/law_fit.hpp"
#include "capstan/tools/select/deciding_numbers.hpp"
#include "capstan/tools/select/effort_catalogue.hpp"
#include "capstan/tools/support/statistics.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

auto summary_of(const Eigen::VectorXd& measured, const Eigen::VectorXd& estimate) -> ErrorSummary {
  const double error = rms(measured - estimate);
  const double size = rms(measured);
  return {error, size > 0.0 ? 100.0 * error / size : 0.0, goodness_of_fit_percent(measured, estimate)};
}

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

/// The grown law errs clearly less on rows that it has not seen than the named one, which has seen them: through its
/// own view, which averages noise away, and through the named law's, in which fast motion survives.
auto clearly_beats(const EffortSelection& selection, const EffortLaw& named, const std::vector<AxisLog>& logs) -> bool {
  const auto beats = [&](const EffortView& view) {
    const Eigen::VectorXd measured = EffortDesign(logs, view).seen(stacked_target(logs));
    const auto estimate = [&](EffortLaw law) {
      law.view = view;
      return run_effort_law(logs, law);
    };
    return ratio_interval(measured, unseen_blocks(selection), estimate(named), estimate(selection.law))[1] <
           kClearlyLess;
  };
  return beats(selection.law.view) && beats(named.view);
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

void replace_traces(const std::vector<AxisLog>& logs, const EffortSelection& selection, Traces& traces) {
  const Eigen::Index rows = selection.measured.size();
  traces.time_s.resize(rows);
  traces.q1.resize(rows);
  traces.load.resize(selection.law.of_gear() ? rows : 0);
  Eigen::Index row = 0;
  for (const auto& log : logs) {
    traces.time_s.segment(row, log.samples()) = log.time_s;
    traces.q1.segment(row, log.samples()) = log.q1_rad;
    if (traces.load.size() > 0) {
      traces.load.segment(row, log.samples()) = log.tau_nm;
    }
    row += log.samples();
  }
  traces.measured = selection.measured;
  traces.before = selection.by_start;
  traces.after = selection.by_law;
}

auto tested(const AxisLog& log, const EffortSelection& selection) -> TestedLog {
  const Eigen::VectorXd measured = EffortDesign({log}, selection.law.view).seen(log.effort);
  return {log.name, summary_of(measured, run_effort_law({log}, selection.start)),
          summary_of(measured, run_effort_law({log}, selection.law))};
}

/// Law, errors and traces of the selection in the place of what the search for names ended with.
void take_selection(const std::vector<AxisLog>& logs, const DiagnoseOptions& options, EffortSelection& selection,
                    const Interval& ratio, Diagnosis& d) {
  const std::vector<std::string> effects = beside_start(selection);
  set_status(effects.empty() ? LawStatus::kBase : LawStatus::kProvisional, selection.law);
  const Eigen::Index unseen = selection.measured.size() - selection.first_unseen;
  const Eigen::VectorXd measured = selection.measured.tail(unseen);
  d.before = summary_of(measured, selection.by_start.tail(unseen));
  d.after = summary_of(measured, selection.by_law.tail(unseen));
  d.ratio_ci95 = ratio;
  bound_floor(d);
  d.halves_agree = halves_won(selection);
  d.unnamed = effects.empty() ? std::nullopt : std::optional(unnamed_of(selection, effects, d));
  d.base = selection.start.joint;
  d.law = selection.law.joint;
  d.undetermined.clear();  // of the law that this one replaces
  d.effort_law = selection.law;
  replace_traces(logs, selection, d.traces);
  d.tested.clear();
  std::transform(options.test_logs.begin(), options.test_logs.end(), std::back_inserter(d.tested),
                 [&](const auto& log) { return tested(log, selection); });
}

}  // namespace

auto has_effort_law(const std::vector<AxisLog>& logs, const Diagnosis& d) -> bool {
  return logs.front().effort.size() > 0 && d.base_model != "preisach" && can_select_effort_law(logs);
}

void deliver_effort_law(const std::vector<AxisLog>& logs, const DiagnoseOptions& options, Diagnosis& d) {
  const bool of_effort = logs.front().motion_alone();
  const bool leaves_much = d.after.rmse > kAboveFloor * d.noise_floor;
  // The search knows another axis's angle and torque, and its floor not even those. What the axis's speed and mass ask
  // of this motor only a law that is grown shows.
  if (is_certain(d) && of_effort && !leaves_much && axes_beside(logs).empty()) {
    d.effort_law = runnable_law(d.law, logs);  // without growing another
    return;
  }
  EffortSelection selection = select_effort_law(logs, d.base_model == kInertiaModel);
  const auto of_names = [&] {  // no file of this form holds a force law
    return of_effort ? runnable_law(d.law, logs) : selection.law;
  };
  const bool more_than_named = is_certain(d) && of_effort && clearly_beats(selection, of_names(), logs);
  if (!more_than_named && (is_certain(d) || (of_effort && names_do_as_well(d, selection)))) {
    d.effort_law = of_names();
    return;
  }
  const Interval ratio =
      ratio_interval(selection.measured, unseen_blocks(selection), selection.by_start, selection.by_law);
  if (d.verdict == Verdict::kNothingMissing && (ratio[1] > kClearlyLess || !of_effort)) {
    d.effort_law = of_names();
    return;
  }
  if (more_than_named) {
    d.verdict = Verdict::kEffectPlusUnlisted;
    d.reason = what_the_law_lacks(d.effects) + kMoreThanNamed;
  }
  if (d.verdict == Verdict::kNothingMissing) {
    d.verdict = Verdict::kUnknown;
    d.reason =
        "Something is missing from the law: another law certainly predicts unseen rows better, but this log does not "
        "show which effect it is.";
  }
  take_selection(logs, options, selection, ratio, d);
}

}  // namespace capstan::tools
