// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "capstan/tools/diagnose/base_choice.hpp"
#include "capstan/tools/diagnose/delivered_law.hpp"
#include "capstan/tools/diagnose/effort_delivery.hpp"
#include "capstan/tools/diagnose/free_run.hpp"
#include "capstan/tools/diagnose/held_terms.hpp"
#include "capstan/tools/diagnose/long_rests.hpp"
#include "capstan/tools/diagnose/loop_gauge.hpp"
#include "capstan/tools/diagnose/loop_without_torque.hpp"
#include "capstan/tools/diagnose/one_law.hpp"
#include "capstan/tools/diagnose/pretension_gauge.hpp"
#include "capstan/tools/diagnose/tested_log.hpp"
#include "capstan/tools/diagnose/verdict.hpp"
#include "capstan/tools/diagnose/weight_in_torque.hpp"
#include "capstan/tools/identify/force_catalogue.hpp"
#include "capstan/tools/identify/log_zeros.hpp"
#include "capstan/tools/identify/tendon_fit.hpp"
#include "capstan/tools/joint_file/width_limit.hpp"
#include "capstan/tools/select/deciding_numbers.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/statistics.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

auto stacked_signal(const std::vector<AxisLog>& logs, Eigen::VectorXd AxisLog::*signal) -> Eigen::VectorXd {
  Eigen::VectorXd all(total_samples(logs));
  Eigen::Index rows = 0;
  for (const auto& log : logs) {
    all.segment(rows, log.samples()) = log.*signal;
    rows += log.samples();
  }
  return all;
}

/// What a board can not hold is said before somebody finds out there.
void note_range(const AxisLog& log, std::vector<std::string>& warnings) {
  constexpr double kBoard = 128.0;      // Q24 in 32 bits
  constexpr double kFinestShare = 1e5;  // of a range: a threshold that small does not matter
  const std::string axis = log.target.substr(0, log.target.find('/'));
  const auto note = [&](const std::string& name, const Eigen::VectorXd& signal, const char* cure) {
    const double most = signal.size() > 0 ? signal.cwiseAbs().maxCoeff() : 0.0;
    if (most >= kBoard) {
      warnings.push_back(log.name + ": " + axis + name + " goes to " + rounded(most) +
                         ", beyond the range of a board's numbers, 128: the law is right for this log, but no board "
                         "can run it, and plays wider than 60 are not searched; " +
                         cure);
    }
  };
  const double range = log.q1_rad.maxCoeff() - log.q1_rad.minCoeff();
  const double finest = direction_thresholds({log}, AngleNoise{}).front();  // if the sensor were perfect
  if (range > 0.0 && range < kFinestShare * finest &&
      direction_thresholds({log}, motor_angle_noise({log})).front() <= finest) {
    warnings.push_back(
        log.name + ": " + axis + "/q1 moves by " + rounded(range) +
        " only, and a board's numbers tell directions from 1e-6 on: the sensor is finer than that, so the "
        "running law is late at reversals; log the angle before the gear, or scale it with --map");
  }
  note("/q1", log.q1_rad, "log the angle behind the gear, or scale it with --map");
  note("/q2", log.q2_rad, "log it in rad or m, or scale it with --map");
  note("/tau", log.tau_nm, "scale it with --map");
}

/// Nor a width that ends where no board could hold a wider one.
void note_widths(Diagnosis& d) {
  const auto widths = widths_at_limit(d.law);
  if (!widths.empty()) {
    d.warnings.push_back(joined(widths) + (widths.size() == 1 ? " is" : " are") +
                         " at the limit of a board's numbers, 60: wider plays are not searched, so the joint may have "
                         "more hysteresis than the law; log the angle behind the gear, or scale it with --map");
  }
}

void describe_logs(const std::vector<AxisLog>& logs, const DiagnoseOptions& options, Diagnosis& d) {
  d.target = logs.front().target;
  bool torque = true;
  for (const auto& log : logs) {
    d.samples += log.samples();
    d.warnings.insert(d.warnings.end(), log.warnings.begin(), log.warnings.end());
    torque = torque && log.has_torque;
    if (log.q2_rad.size() > 0) {  // efforts: board_effort_law
      note_range(log, d.warnings);
    }
  }
  d.rate_hz = logs.front().rate_hz();
  const char* usual = logs.front().motion_alone() ? kEffortModel : (torque ? kDefaultModel : "kinematic");
  d.base_model = options.base_model.empty() ? usual : options.base_model;
}

/// The effects are taken back where the law with them errs no less than the base for certain.
void take_back(const Search& search, Diagnosis& d) {
  const bool missing = search.base_reducible > 0.05;
  d.reason = "On rows that took no part in the choice it is not certain that " + search.effects.front().name +
             " lowers the error, so it is not named.";
  d.verdict = missing ? Verdict::kUnknown : Verdict::kNothingMissing;
  d.effects.clear();
}

/// The law with the effects that were found, where there are any; effects that do not lower the error are taken back.
auto found_law(const Preparation& p, const Search& search, const LawForm& base, Diagnosis& d)
    -> std::optional<JointFile> {
  if (search.effects.empty()) {
    return std::nullopt;
  }
  JointFile found = causal_law(p, search.law);
  if (!is_refusal(d.verdict)) {
    d.effects = search.effects;
    const Interval ratio = ratio_interval(p, d.traces.before, estimates(p.logs, p.causal, found));
    // A running estimate of an angle is late at reversals, and no effect mends that. What the torque shows need not be
    // in the angle: tendons that are taut carry it.
    const bool of_torque = base.catalogue->target() == TargetKind::kForce;
    if (!search.by_torque && (ratio[of_torque ? 1 : 0] >= 1.0 || !holds_on_unseen_rows(p, base, search.law))) {
      take_back(search, d);
    }
  }
  return found;
}

/// A law is nearer to the rows that it was fitted to than to others, the more so the more it was chosen from.
void widen_error_bar(double unseen_rms, FitSummary& fit) {
  if (fit.error_bar && fit.rmse > 0.0) {
    const double times = std::max(1.0, unseen_rms / fit.rmse);
    auto& [steady, turning, turn, from, to, torque] = fit.error_bar->values;
    steady *= times;
    turning *= times;
  }
}

/// The law that is delivered, and its error on rows that chose nothing.
void deliver(const Preparation& p, const LawChoice& choice, Diagnosis& d) {
  d.law = choice.law;
  d.halves_agree = choice.halves_agree;
  d.traces.after = estimates(p.logs, p.causal, choice.learned);
  d.after = report_error(p, d.traces.after);
  d.ratio_ci95 = ratio_interval(p, d.traces.before, d.traces.after);
  if (d.law.fit) {  // both measures are of laws fitted to fewer rows than the delivered one, so the smaller is nearer
    widen_error_bar(choice.unseen_rms > 0.0 ? std::min(d.after.rmse, choice.unseen_rms) : d.after.rmse, *d.law.fit);
  }
}

/// Why a law that was grown is not delivered.
constexpr const char* kNotBetterUnseen =
    "laws without a name fit the log better but had larger errors than the base law on the rows set aside, so none is "
    "delivered; a longer log may help";

/// Chooses the law that is delivered and measures its error, on rows that chose nothing; a law without a name that does
/// no better there than the base law, for certain, or worse by more than a floor may be off, is none that the log
/// supports: it has learned what does not come again, as from a slip while the log was taken. Nor is one with a drift
/// that errs more over the whole log, the rows included that no fit has seen.
void report(const Preparation& p, const Search& search, const LawForm& base, const std::optional<JointFile>& healthy,
            Diagnosis& d) {
  d.base = causal_law(p, base);
  d.base.status = LawStatus::kBase;
  d.traces.before = estimates(p.logs, p.causal, d.base);
  d.before = report_error(p, d.traces.before);
  d.noise_floor = std::hypot(d.noise_floor, noise_of_running(p, search.law));
  d.found = found_law(p, search, base, d);
  if (healthy) {
    hold_to_own_logs(p, *healthy, d);
  }
  LawChoice choice = chosen_law(p, search, d);
  deliver(p, choice, d);
  // A first stroke may be another one than later ones, but what goes by the time since the start has to hold from
  // there.
  const auto begins_wrong = [&](const JointFile& law) {
    return law.has("thermal_drift") &&
           rms(p.target - estimates(p.logs, p.causal, law)) > rms(p.target - d.traces.before);
  };
  const auto is_no_better = [&] {
    const bool without_name = choice.status == LawStatus::kProvisional || (choice.is_named && d.effects.empty());
    return without_name &&
           (d.ratio_ci95[0] >= 1.0 || d.after.rmse > kAboveFloor * d.before.rmse || begins_wrong(choice.law));
  };
  if (is_no_better() && !choice.is_named && d.base.catalogue->target() == TargetKind::kAngle) {
    choice = choose_small_law(p, d.base);  // few rows may support one where they mislead what is grown further
    deliver(p, choice, d);
  }
  if (is_no_better()) {
    choice = as_searched(d, d.found && d.verdict == Verdict::kEffect && !d.effects.empty());
    deliver(p, choice, d);
    d.warnings.emplace_back(kNotBetterUnseen);
  }
  if (d.verdict == Verdict::kNothingMissing && choice.status == LawStatus::kProvisional && gains_nothing(p, d)) {
    choice = as_searched(d, false);
    deliver(p, choice, d);
  }
  if (choice.is_named && (d.effects.empty() || d.verdict == Verdict::kAmbiguous)) {
    d.law.status = LawStatus::kProvisional;  // it predicts best, and what it is made of is not certain
  }
  bound_floor(d);
  if (healthy) {
    bound_floor_by(*healthy, p, d);
  }
  d.undetermined = choice.is_named ? undetermined(p, search.law) : std::vector<std::string>{};
  reconcile(p, search, choice, d);
  if (d.law.status == LawStatus::kProvisional) {
    d.candidates = candidate_shares(search);
    d.unnamed = unnamed_part(p, choice, d);
  }
  if (!d.undetermined.empty()) {
    d.warnings.push_back("this log cannot determine " + joined(d.undetermined) +
                         ": other values would fit as well, so the law holds for motions like this one only");
  }
}

/// Where nothing can be fitted there is a law without terms, which leaves the whole target.
void take_no_law(const std::vector<AxisLog>& logs, const Catalogue& catalogue, Diagnosis& d) {
  d.base = JointFile(catalogue);
  d.base.status = LawStatus::kBase;
  d.law = d.base;
  const Eigen::VectorXd target = stacked_target(logs);
  d.before = d.after = {rms(target), target.isZero(0.0) ? 0.0 : 100.0, 0.0};
}

/// The base law to start from; empty, with verdict and cure written, where the logs are not fit for it.
auto base_law(const std::vector<AxisLog>& logs, const DiagnoseOptions& options, Diagnosis& d)
    -> std::optional<LawForm> {
  std::string why = reason_unfit(logs);
  if (why.empty()) {
    try {
      return options.base_law ? base_of(*options.base_law) : form_of_model(d.base_model, logs);
    } catch (const Refusal& refusal) {  // a force law has to be fitted to know where its search begins
      why = refusal.what();
    }
  }
  say(unfit("a diagnosis", why), d);
  return std::nullopt;
}

/// What the log itself says against the law and its names: that no one law holds over all of it, or that its torque
/// shows no weight.
void ask_the_log(const Preparation& p, const Search& search, const LawForm& base, Diagnosis& d) {
  if (const auto changed = joint_that_changed(p, {base, search.law, form_of(d.law)})) {
    if (d.law.status == LawStatus::kConfirmed) {
      d.candidates = candidate_shares(search);
    }
    say_changed(p, *changed, d);
  }
  doubt_weight(p, d);
}

/// Searches, judges and reports. Where no base law was asked for, that of two tendons takes the usual one's place if it
/// predicts better than that with its effects.
void examine(Preparation p, LawForm base, const DiagnoseOptions& options, const std::optional<Nameless>& why,
             Diagnosis& d) {
  const auto by_its_loop = options.base_law ? by_loop(p, *options.base_law, base, options.progress) : std::nullopt;
  Search search = by_its_loop ? *by_its_loop : search_effects(p, base, options.progress);
  double form_error = 0.0;
  if (d.base_model == kDefaultModel && options.base_model.empty() && !options.base_law) {
    options.progress("trying the law of two tendons");
    if (const auto tendons = better_base(p, base, search)) {
      p = with_rate_filter(std::move(p), tendons->rate_filter_s);
      base = tendons->law;
      form_error = tendons->form_error;
      d.base_model = kTendonModel;
      search = search_effects(p, base, options.progress);
    }
  }
  if (base.has(kTendonModel) && !by_its_loop) {
    search = without_form_error(p, {base, form_error}, std::move(search));
  }
  d.rounds = search.rounds;
  d.explained_share = search.share.value;
  d.explained_share_lower = search.share.lower;
  d.noise_floor = search.noise_floor;
  d.floor_from = p.repeats ? "repeats" : "flexible model";
  d.detectable = search.detectable;
  d.sizes = search.sizes;
  if (why) {
    search.effects.clear();
    say(*why, d);
  } else {
    d.verdict = judge(search, d);
  }
  options.progress("measuring the error on rows set aside");
  d.traces.time_s = stacked_signal(p.logs, &AxisLog::time_s);
  d.traces.q1 = stacked_signal(p.logs, &AxisLog::q1_rad);
  d.traces.measured = p.target;
  d.traces.load = stacked_signal(p.logs, &AxisLog::tau_nm);
  report(p, search, base, options.base_law, d);
  if (options.base_law) {
    keep_what_is_not_asked(p, *options.base_law, d.base);
    keep_what_is_not_asked(p, *options.base_law, d.law);
  }
  if (!why && d.base.catalogue->target() == TargetKind::kAngle) {
    options.progress("checking whether one law holds over the whole log");
    ask_the_log(p, search, base, d);
  }
  gauge_pretension(p, options, search.loop, d);
  doubt_loop_without_torque(p, d);
  if (!d.effects.empty() && !p.repeats) {
    d.warnings.push_back(
        "the motion does not repeat, so the noise had to be judged from the residual: take the verdict as a hint, " +
        std::string("and confirm it with a log of four equal cycles"));
  }
}

/// What the base law lacks, by name where it has one, and the law that is delivered.
auto diagnosed(const std::vector<AxisLog>& recorded, const DiagnoseOptions& options) -> Diagnosis {
  Diagnosis d;
  describe_logs(recorded, options, d);
  const Catalogue& catalogue =
      options.base_law ? *options.base_law->catalogue : catalogue_of_model(d.base_model, recorded);
  d.unit = catalogue.target_unit();
  d.motion_unit = catalogue.motion_unit();
  take_no_law(recorded, catalogue, d);
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
  Preparation p = prepare(std::move(logs), *base);
  if (options.base_law && base->has(kTendonModel)) {  // they are known with their own
    p = with_rate_filter(std::move(p), options.base_law->parameters.conditioner.rate_time_constant_s);
  }
  LawForm law = settled_base(p, *base);
  if (options.base_law && catalogue.target() == TargetKind::kAngle && !law.has(kTendonModel)) {
    // They may have moved as its coefficients may.
    law = refine_shapes(p.noncausal, p.target, p.certain(), std::move(law));
  }
  d.notes = p.notes;
  d.repeats = p.repeats ? p.repeats->count : 1;
  const std::optional<Nameless> why = nameless(p, law);
  if (why && (catalogue.target() != TargetKind::kAngle || !options.base_model.empty() || options.base_law)) {
    say(*why, d);  // the law of an effort is grown apart, and what was asked for is not replaced
    return d;
  }
  examine(std::move(p), law, options, why, d);
  return d;
}

/// The diagnosis of logs whose joint angles may each have a zero of their own, which is taken off them.
auto from_one_zero(std::vector<AxisLog>& logs, const DiagnoseOptions& options) -> Diagnosis {
  const auto zeros = count_from_one_zero(
      logs, [&](const std::vector<AxisLog>& all) { return left_by(diagnosed(all, options).law, all); });
  Diagnosis d = diagnosed(logs, options);
  d.warnings.insert(d.warnings.end(), zeros.begin(), zeros.end());
  return d;
}

}  // namespace

auto diagnose(const std::vector<AxisLog>& recorded, const DiagnoseOptions& options) -> Diagnosis {
  std::vector<AxisLog> logs;
  std::transform(recorded.begin(), recorded.end(), std::back_inserter(logs), without_long_rests);
  Diagnosis d = from_one_zero(logs, options);
  if (total_samples(logs) < total_samples(recorded) && goes_by_time(d)) {
    options.progress("repeating it with the rests included");
    logs = recorded;
    d = from_one_zero(logs, options);
  }
  if (d.changed_at && logs.size() == 1 && !options.base_law) {
    options.progress("diagnosing the longer part alone");
    const AxisLog part = longer_part(logs.front(), *d.changed_at);
    take_law_of_part(diagnosed({part}, options), part, d);
  }
  if (has_effort_law(logs, d)) {
    options.progress("choosing the law of the effort");
    deliver_effort_law(logs, d);
  } else if (logs.front().motion_alone() && !d.law.terms.empty()) {
    d.effort_law = runnable_law(d.law, logs);
  }
  say_what_is_held(d);
  warn_of_uncertain_gain(d);
  note_widths(d);
  if (d.traces.after.size() > 0) {
    const MapSignals signals{d.traces.time_s, d.traces.q1, d.traces.load};
    d.map_before = residual_map(signals, d.traces.measured - d.traces.before);
    d.map_after = residual_map(signals, d.traces.measured - d.traces.after);
    const bool grown = d.effort_law && d.effort_law->joint.terms == d.law.terms;
    d.told = grown ? identifiability_of(logs, *d.effort_law) : identifiability_of(logs, d.law);
    for (const auto& log : options.test_logs) {
      d.tested.push_back(tested_log(without_long_rests(log), logs, d));
    }
  }
  return d;
}

}  // namespace capstan::tools
