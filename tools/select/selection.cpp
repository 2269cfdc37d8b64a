// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/select/selection.hpp"

#include <algorithm>
#include <cmath>

namespace capstan::tools {
namespace {

void add_new(const LawCandidate& law, double score, std::vector<JudgedLaw>& laws) {
  const bool known = std::any_of(laws.begin(), laws.end(), [&](const auto& one) { return one.law == law; });
  if (!known && std::isfinite(score)) {
    laws.push_back({.law = law, .score = score});
  }
}

void judge(ForwardScore& forward, std::vector<JudgedLaw>& laws) {
  const DecidingNumbers& numbers = forward.numbers();
  std::vector<std::size_t> judged;
  for (std::size_t i = 0; i < laws.size(); ++i) {
    if (std::isfinite(laws[i].score)) {
      judged.push_back(i);
    }
  }
  if (judged.empty()) {
    return;
  }
  Eigen::MatrixXd losses((numbers.parts - numbers.first_judged_part) * numbers.pieces_per_part,
                         static_cast<Eigen::Index>(judged.size()));
  for (std::size_t i = 0; i < judged.size(); ++i) {
    losses.col(static_cast<Eigen::Index>(i)) = forward.losses(laws[judged[i]].law);
  }
  const ConfidenceSet set = confidence_set(losses, numbers.confidence_level, numbers.resamplings, numbers.run);
  for (std::size_t i = 0; i < judged.size(); ++i) {
    laws[judged[i]].p_value = set.p_values[i];
    laws[judged[i]].in_set = set.in_set[i];
    const Eigen::Index half = losses.rows() / 2;
    const auto column = static_cast<Eigen::Index>(i);
    laws[judged[i]].halves = {losses.col(column).head(half).mean(), losses.col(column).tail(half).mean()};
  }
}

}  // namespace

auto select_law(ForwardScore& forward, const std::vector<LawCandidate>& given, const Vocabulary& vocabulary)
    -> Selection {
  Selection selection;
  for (const auto& law : given) {
    selection.laws.push_back({.law = law, .score = forward.score(law)});
  }
  for (const auto& step : grown_angle_laws(forward, vocabulary)) {
    add_new(step.law, step.score, selection.laws);
  }
  judge(forward, selection.laws);
  const auto best = std::min_element(selection.laws.begin(), selection.laws.end(),
                                     [](const auto& a, const auto& b) { return a.score < b.score; });
  selection.best = static_cast<std::size_t>(best - selection.laws.begin());
  return selection;
}

auto joint_of(SelectionData& data, const Blocks& rows, const LawCandidate& law,
              const ConditionerShape<double>& conditioner) -> JointFile {
  const Catalogue& catalogue = data.catalogue();
  const FittedCandidate fit = ForwardScore(data, rows).fitted(law);
  JointFile joint(catalogue);
  joint.parameters.conditioner = conditioner;
  Eigen::Index next = 0;
  double beta = 1.0;
  for (const auto& choice : fit.law.terms) {
    const CatalogueTerm& term = catalogue.term(choice.term);
    std::copy(choice.shapes.begin(), choice.shapes.end(),
              joint.parameters.shapes.begin() + static_cast<std::ptrdiff_t>(term.first_shape));
    for (std::size_t i = 0; i < term.coefficients.size(); ++i) {
      joint.parameters.coefficients[term.first_coefficient + i] = fit.theta[next++];
    }
    if (choice.term == "motor_angle") {
      beta = fit.theta[next - 1];
    }
  }
  if (!law.plays.empty()) {
    const CatalogueTerm& stage = catalogue.term("hysteresis");
    for (std::size_t i = 0; i < law.plays.size(); ++i) {
      joint.parameters.shapes[stage.first_shape + 2 * i] = law.plays[i];
      joint.parameters.shapes[stage.first_shape + 2 * i + 1] = fit.play_weights[static_cast<Eigen::Index>(i)] / beta;
    }
  }
  for (const auto& term : catalogue) {
    if (law.has(term.name) || (term.acts_on_input && !law.plays.empty())) {
      joint.terms.push_back(term.name);
    }
  }
  return joint;
}

}  // namespace capstan::tools
