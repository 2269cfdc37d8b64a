// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/diagnose/proposal.hpp"

#include <algorithm>

namespace capstan::tools {
namespace {

/// Whether every term of the law has a coefficient other than zero in the joint fit.
auto all_present(const Preparation& p, const LawForm& law, const Blocks& learned, const std::vector<Proposal>& added)
    -> bool {
  const LinearFit fit = fit_law(p.noncausal, p.target, learned, law);
  Eigen::Index column = 0;
  for (const auto& term : *law.catalogue) {
    if (!law.has(term.name)) {
      continue;
    }
    bool present = term.acts_on_output;
    for (std::size_t i = 0; i < term.coefficients.size(); ++i, ++column) {
      present = present || fit.theta[column] != 0.0;
    }
    const bool is_new = std::any_of(added.begin(), added.end(), [&](const auto& one) { return one.name == term.name; });
    if (is_new && !present) {
      return false;
    }
  }
  return true;
}

}  // namespace

auto proposal(const Round& round, std::size_t candidate, std::size_t variant) -> Proposal {
  const Candidate& effect = round.evidence.candidates[candidate];
  const Shapes& shapes = effect.variants[variant].shapes;
  return {effect.name, shapes, !shapes.empty() && effect.searched == 0};
}

auto law_with(const Preparation& p, LawForm law, const std::vector<Proposal>& added) -> std::optional<LawForm> {
  const Blocks learned = p.certain();
  for (const auto& one : added) {
    law.terms.push_back(one.name);
    if (brings_offset(law, one.name)) {
      law.terms.emplace_back("offset");
    }
    if (one.held) {
      law.held.push_back(one.name);
    }
    law.set_shapes(law.catalogue->term(one.name), one.shapes);
  }
  law = refine_shapes(p.noncausal, p.target, learned, law);
  return shapes_at_limits(p.noncausal, law).empty() && all_present(p, law, learned, added) ? std::optional(law)
                                                                                           : std::nullopt;
}

auto law_without(LawForm law, const std::string& name) -> LawForm {
  law.terms.erase(std::find(law.terms.begin(), law.terms.end(), name));
  return law;
}

auto added_effect(const Round& round, const CandidateTrial& trial, const std::vector<std::size_t>& confusable)
    -> AddedEffect {
  return {round.evidence.candidates[trial.candidate].name,
          names_of(round, confusable),
          std::min(1.0, 2.0 * std::min(trial.p_value, trial.p_sieve)),
          trial.log_e_value,
          evidence_needed(round.evidence),
          trial.log_likelihood,
          trial.explained,
          trial.explained_t,
          trial.absorbed};
}

}  // namespace capstan::tools
