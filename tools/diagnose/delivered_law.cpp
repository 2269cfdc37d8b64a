// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/diagnose/delivered_law.hpp"

#include <algorithm>

#include "capstan/tools/diagnose/free_run.hpp"
#include "capstan/tools/identify/tendon_fit.hpp"
#include "capstan/tools/select/deciding_numbers.hpp"
#include "capstan/tools/support/statistics.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

/// Of an effort or a torque: laws without names are grown apart, from logs that are looked at otherwise
/// (deliver_effort_law).
auto chosen_effort_law(const Preparation& p, const Diagnosis& d) -> LawChoice {
  const Eigen::VectorXd after = d.found ? estimates(p.logs, p.causal, *d.found) : d.traces.before;
  const bool lower = report_error(p, after).rmse < d.before.rmse;
  LawChoice choice = as_searched(d, d.found && (!d.effects.empty() || (is_refusal(d.verdict) && lower)));
  const Eigen::Index half = p.target.size() / 2;
  const auto left = [&](Eigen::Index begin, const Eigen::VectorXd& estimate) {
    return rms((p.target - estimate).segment(begin, half));
  };
  choice.halves_agree = 0;
  for (const Eigen::Index begin : {Eigen::Index{0}, p.target.size() - half}) {
    const bool wins = left(begin, after) <= left(begin, d.traces.before);
    choice.halves_agree += wins == choice.is_named || !d.found ? 1 : 0;
  }
  return choice;
}

/// Whether the law that the search ended with leaves no more than the noise as it runs.
auto leaves_noise(const Preparation& p, const Search& search, const Diagnosis& d, bool named) -> bool {
  if (named ? search.lacks_something : d.verdict != Verdict::kNothingMissing) {
    return false;
  }
  const JointFile& law = named ? *d.found : d.base;
  // Where the running switch is late, no law of this encoder knows better.
  const double left = error_of_known_direction(p, named ? estimates(p.logs, p.causal, law) : d.traces.before);
  return left <= kAboveFloor * d.noise_floor;
}

/// Whether no law that was grown beside it shows the noise to be less than what it leaves.
auto is_at_floor(const JudgedLaw& law, const Selection& selection) -> bool {
  return law.score <= kAboveFloor * kAboveFloor * selection.laws[selection.best].score;
}

}  // namespace

auto as_searched(const Diagnosis& d, bool named) -> LawChoice {
  LawChoice choice;
  choice.law = choice.learned = named ? *d.found : d.base;
  choice.status = choice.law.status = choice.learned.status = named ? LawStatus::kConfirmed : LawStatus::kBase;
  choice.is_named = named;
  choice.halves_agree = 2;
  return choice;
}

void warn_of_uncertain_gain(Diagnosis& d) {
  if (d.law.status == LawStatus::kProvisional && d.ratio_ci95[1] >= 1.0) {
    d.warnings.push_back("the law was best on the rows used to choose it; on the rows set aside its error is " +
                         rounded(d.ratio_ci95[0], 3) + " to " + rounded(d.ratio_ci95[1], 3) +
                         " times the base law's, so an improvement is not certain: test it on another log (--test)");
  }
}

void bound_floor(Diagnosis& d) {
  const double left = std::min(d.before.rmse, d.after.rmse);
  if (left < d.noise_floor) {
    d.noise_floor = left;
    d.floor_from = "law";
  }
}

auto chosen_law(const Preparation& p, const Search& search, const Diagnosis& d) -> LawChoice {
  if (d.base.catalogue->target() != TargetKind::kAngle) {
    return chosen_effort_law(p, d);
  }
  const bool named = d.verdict == Verdict::kEffect && d.found && !d.effects.empty();
  const bool complete = (p.repeats || d.base.has(kTendonModel)) && leaves_noise(p, search, d, named);
  if (complete && p.repeats) {
    return as_searched(d, named);
  }
  LawChoice choice = choose_law(p, d.base, d.found, is_refusal(d.verdict) ? Lacking::kSomething : Lacking::kNothing);
  const std::size_t own = named ? kFoundPlace : kBasePlace;
  return complete && is_at_floor(choice.selection.laws[own], choice.selection) ? as_searched(d, named) : choice;
}

}  // namespace capstan::tools
