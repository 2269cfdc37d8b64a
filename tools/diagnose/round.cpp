// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/diagnose/round.hpp"

#include <algorithm>
#include <limits>

#include "capstan/tools/identify/force_catalogue.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

auto outcome_of(const Round& round, const CandidateTrial& trial, const CandidateTrial* chosen,
                const std::vector<std::size_t>& confusable) -> std::string {
  if (&trial == chosen) {
    return "explains the residual best";
  }
  if (round.evidence.candidates[trial.candidate].waits) {
    return "waits for " + joined(round.evidence.candidates[trial.candidate].builds_on, " or ");
  }
  if (!trial.possible) {
    return "ruled out: the data give a sign that is physically impossible";
  }
  if (chosen != nullptr && std::find(confusable.begin(), confusable.end(), trial.candidate) != confusable.end()) {
    return "this log cannot distinguish it from the best";
  }
  if (!passes(trial, round.evidence) && trial.absorbed > 0.99) {
    return "not identifiable beside the law on this motion";
  }
  if (!passes(trial, round.evidence)) {
    return trial.p_value > 0.5 * kAlpha ? "not detected" : "not confirmed on unseen rows";
  }
  return "ruled out: the best explains significantly more";
}

}  // namespace

auto residual_of(const Preparation& p, const LawForm& law) -> LawResidual {
  const Eigen::MatrixXd columns = law_columns(p.noncausal, law);
  const LinearFit fit = fit_columns(columns, p.target, p.certain(), law_signs(law));
  LawResidual residual;
  residual.fitted = columns * fit.theta;
  residual.error = p.coarse(p.target - residual.fitted);
  Eigen::MatrixXd base = with_sensitivities(p.noncausal, law, fit.theta, columns);
  if (law.has("preisach")) {
    // Relays that a stretch of the motion alone has switched would be anything when that stretch is held out.
    residual.adapted = p.coarse(columns);
    Eigen::MatrixXd error = residual.error;  // without the signs that the fit had to keep, as the effects are
    project_out(residual.adapted, p.split.learned(), error);
    residual.error = error;
    base.resize(columns.rows(), 2);
    base << Eigen::VectorXd::Ones(columns.rows()), residual.fitted;
  }
  const auto brought = [&](std::size_t which) -> Eigen::VectorXd {
    return which >= p.disturbed.size()
               ? Eigen::VectorXd::Zero(residual.error.size())
               : Eigen::VectorXd(p.coarse(law_columns(p.disturbed[which], law) * fit.theta - residual.fitted));
  };
  residual.resolution = brought(0) + p.coarse(hidden_by_grid(p.noncausal, law, residual.fitted));
  residual.torque_noise = brought(1);
  residual.base = p.coarse(base);
  residual.full_base = std::move(base);
  return residual;
}

auto hold_round(const Preparation& p, const LawForm& law) -> Round {
  Round round;
  round.residual = residual_of(p, law);
  round.evidence = gather_evidence(p, law, round.residual);
  const SieveResult luck = sieve(p, round.evidence);
  round.adequacy = judge_adequacy(p, round.evidence, luck);
  round.trials = try_candidates(p, round.evidence, luck);
  return round;
}

auto best_passing(const Round& round, bool catalogue_only) -> const CandidateTrial* {
  constexpr double kFarMore = 1.5;  // energy, of the least that any leaves
  std::vector<const CandidateTrial*> eligible;
  double least_left = std::numeric_limits<double>::infinity();
  for (const auto& trial : round.trials) {
    const bool listed = !catalogue_only || round.evidence.candidates[trial.candidate].in_catalogue;
    if (listed && passes(trial, round.evidence)) {
      eligible.push_back(&trial);
      least_left = std::min(least_left, trial.energies.sum());
    }
  }
  // A noise model may swallow a smooth misfit and be left with a fast, small one; energy tells which is large.
  eligible.erase(std::remove_if(eligible.begin(), eligible.end(),
                                [&](const auto* trial) { return trial->energies.sum() > kFarMore * least_left; }),
                 eligible.end());
  double likeliest = -std::numeric_limits<double>::infinity();
  for (const auto* trial : eligible) {
    likeliest = std::max(likeliest, trial->log_likelihood);
  }
  const CandidateTrial* best = nullptr;
  for (const auto* trial : eligible) {
    const bool as_likely =
        round.evidence.by_energy || trial->log_likelihood > likeliest - evidence_needed(round.evidence);
    if (as_likely && (best == nullptr || trial->explained > best->explained)) {
      best = trial;
    }
  }
  return best;
}

auto summary_of(const Round& round, const CandidateTrial* chosen, const std::vector<std::size_t>& confusable)
    -> RoundSummary {
  RoundSummary summary;
  summary.reducible_share = round.adequacy.reducible_share;
  summary.lack_of_fit_p = round.adequacy.lack_of_fit_p;
  summary.flexible_p = round.adequacy.flexible_p;
  summary.lacks_something = round.adequacy.lacks_something;
  for (const auto& trial : round.trials) {
    const auto& candidate = round.evidence.candidates[trial.candidate];
    if (candidate.wider && &trial != chosen) {
      continue;
    }
    summary.ranking.push_back({candidate.name, candidate.in_catalogue,
                               std::min(1.0, 2.0 * std::min(trial.p_value, trial.p_sieve)), trial.log_e_value,
                               trial.explained, trial.log_likelihood, outcome_of(round, trial, chosen, confusable)});
  }
  std::sort(summary.ranking.begin(), summary.ranking.end(),
            [](const auto& a, const auto& b) { return a.log_likelihood > b.log_likelihood; });
  return summary;
}

auto names_of(const Round& round, const std::vector<std::size_t>& candidates) -> std::vector<std::string> {
  std::vector<std::string> names;
  for (const std::size_t candidate : candidates) {
    const std::string& name = round.evidence.candidates[candidate].name;
    if (!is_one_of(names, name)) {  // an effect may be there in two forms
      names.push_back(name);
    }
  }
  return names;
}

auto trial_of(const Round& round, const std::string& name) -> const CandidateTrial* {
  for (const auto& trial : round.trials) {
    if (round.evidence.candidates[trial.candidate].name == name) {
      return &trial;
    }
  }
  return nullptr;
}

}  // namespace capstan::tools
