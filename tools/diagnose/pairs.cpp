// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/diagnose/pairs.hpp"

#include <algorithm>
#include <cmath>

namespace capstan::tools {
namespace {

/// Both models' columns beside the law. An output term's columns replace the law's; the other effect is then taken as
/// it is.
auto together(const Layout& layout, const Candidate& a, std::size_t variant_a, const Candidate& b,
              std::size_t variant_b) -> ColumnModel {
  ColumnModel model = model_of(layout, a.acts_on_output ? a : b, a.acts_on_output ? variant_a : variant_b);
  const Candidate& added = a.acts_on_output ? b : a;
  const ColumnModel other = model_of(layout, added, a.acts_on_output ? variant_b : variant_a);
  model.free.insert(model.free.end(), other.free.begin() + layout.law, other.free.end());
  model.signs.insert(model.signs.end(), other.signs.begin() + layout.law, other.signs.end());
  return model;
}

/// Variants to be tried in a pair: an output term has one exact variant.
auto variants_of(const Candidate& candidate) -> std::size_t {
  return candidate.acts_on_output ? 1 : candidate.variants.size();
}

/// Energy left on a sum of products by the best fit of a model; infinite if a sign forbids a part of it.
auto energy_left(const Eigen::MatrixXd& gram, const Layout& layout, const ColumnModel& model) -> double {
  const Eigen::Index error = layout.error();
  Eigen::VectorXd rhs = gram.col(error)(model.free);
  double energy = gram(error, error);
  if (model.fixed >= 0) {
    rhs -= gram.col(model.fixed)(model.free);
    energy += gram(model.fixed, model.fixed) - 2.0 * gram(error, model.fixed);
  }
  const Eigen::MatrixXd products = gram(model.free, model.free);
  return energy - solve_signed(products, rhs, model.signs).dot(rhs);
}

auto fit_pair(const Evidence& evidence, const Eigen::MatrixXd& fit_products, std::size_t a, std::size_t b)
    -> EffectPair {
  const Candidate& first = evidence.candidates[a];
  const Candidate& second = evidence.candidates[b];
  EffectPair pair{{a, b}, {0, 0}, {}};
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < variants_of(first); ++i) {
    for (std::size_t j = 0; j < variants_of(second); ++j) {
      const double energy = energy_left(fit_products, evidence.layout, together(evidence.layout, first, i, second, j));
      if (energy < least) {
        least = energy;
        pair.variant[0] = i;
        pair.variant[1] = j;
      }
    }
  }
  pair.energies = cross_validated(evidence.raw(), evidence.learned,
                                  together(evidence.layout, first, pair.variant[0], second, pair.variant[1]));
  return pair;
}

/// Whether each effect of a pair is one of the other pair's, or a special case of it.
auto is_within(const Evidence& evidence, const EffectPair& pair, const EffectPair& general) -> bool {
  const auto is_case_of = [&evidence](std::size_t one, std::size_t other) {
    const auto& special = evidence.candidates[other].special_cases;
    return one == other || std::find(special.begin(), special.end(), evidence.candidates[one].name) != special.end();
  };
  const auto& [a, b] = pair.candidate;
  const auto& [c, d] = general.candidate;
  return (is_case_of(a, c) && is_case_of(b, d)) || (is_case_of(a, d) && is_case_of(b, c));
}

auto names_as_double(const CatalogueTerm& a, const CatalogueTerm& b) -> bool {
  return std::find(a.doubles.begin(), a.doubles.end(), b.name) != a.doubles.end();
}

/// Effects that pass for each other alone bend, as a pair, into almost anything of their kind; and one that waits comes
/// with what it waits for or not at all.
auto may_pair(const Catalogue& catalogue, const Candidate& a, const Candidate& b) -> bool {
  const auto stands = [](const Candidate& one, const Candidate& other) {
    return !one.waits || std::find(one.builds_on.begin(), one.builds_on.end(), other.name) != one.builds_on.end();
  };
  if (a.wider || b.wider || !a.in_catalogue || !b.in_catalogue || (a.acts_on_output && b.acts_on_output) ||
      !stands(a, b) || !stands(b, a)) {
    return false;
  }
  const CatalogueTerm& first = catalogue.term(a.name);
  const CatalogueTerm& second = catalogue.term(b.name);
  return !names_as_double(first, second) && !names_as_double(second, first);
}

}  // namespace

auto pair_of(const Evidence& evidence, const std::vector<std::string>& names) -> std::optional<EffectPair> {
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < evidence.candidates.size(); ++i) {
    if (std::find(names.begin(), names.end(), evidence.candidates[i].name) != names.end()) {
      found.push_back(i);
    }
  }
  return found.size() != 2 ? std::nullopt
                           : std::optional(fit_pair(evidence, evidence.raw().sum(evidence.fit), found[0], found[1]));
}

auto best_pair(const Evidence& evidence, const Catalogue& catalogue) -> std::optional<EffectPair> {
  const Eigen::MatrixXd fit_products = evidence.raw().sum(evidence.fit);
  std::vector<EffectPair> pairs;
  for (std::size_t a = 0; a < evidence.candidates.size(); ++a) {
    for (std::size_t b = a + 1; b < evidence.candidates.size(); ++b) {
      if (may_pair(catalogue, evidence.candidates[a], evidence.candidates[b])) {
        pairs.push_back(fit_pair(evidence, fit_products, a, b));
      }
    }
  }
  auto best = std::min_element(pairs.begin(), pairs.end(),
                               [](const auto& x, const auto& y) { return x.energies.sum() < y.energies.sum(); });
  if (best == pairs.end()) {
    return std::nullopt;
  }
  const auto as_well = [&](const EffectPair& other) { return !clearly_positive(other.energies - best->energies); };
  for (auto other = pairs.begin(); other != pairs.end(); ++other) {
    if (other != best && as_well(*other) && is_within(evidence, *other, *best)) {
      best = other;  // what the log does not ask for is not named
      other = pairs.begin();
    }
  }
  for (const auto& other : pairs) {
    if (as_well(other) && !is_within(evidence, *best, other)) {
      return std::nullopt;
    }
  }
  return *best;
}

}  // namespace capstan::tools
