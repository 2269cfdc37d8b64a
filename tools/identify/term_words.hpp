// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "capstan/tools/identify/term_catalogue.hpp"

namespace capstan::tools {

/// What a term says of itself, its coefficients and its shapes; how it acts is left to who asks.
template <typename Term>
auto words_of_term() -> CatalogueTerm {
  CatalogueTerm term;
  term.name = Term::kInfo.name;
  term.equation = Term::kInfo.equation;
  term.source = Term::kInfo.source;
  term.confusable_with = Term::kInfo.confusable_with;
  term.exciting_motion = Term::kInfo.exciting_motion;
  term.coefficients.assign(Term::kInfo.coefficients.begin(), Term::kInfo.coefficients.end());
  term.shapes.assign(Term::kInfo.shapes.begin(), Term::kInfo.shapes.end());
  return term;
}

/// A term with its shapes. @pre as many as it has
template <typename Term>
auto make_term(double period_s, const Shapes& shapes) -> Term {
  std::array<double, kShapesOf<Term>> shape{};
  for (std::size_t i = 0; i < shape.size(); ++i) {
    shape[i] = shapes.at(i);
  }
  return Term(SamplePeriod<double>(period_s), shape);
}

/// What a term makes of each sample: a column for each coefficient.
template <typename Term>
auto columns_of_term(const Samples& samples, double period_s, const Shapes& shapes) -> Eigen::MatrixXd {
  // Samples are so far apart that no processor fetches ahead by itself, and most terms would only wait for them
  // (diagnoses of 600,000 rows: 41 to 25 and 31 s).
  constexpr Eigen::Index kFetchedAhead = 24;
  constexpr auto kColumns = static_cast<Eigen::Index>(kCoefficientsOf<Term>);
  Eigen::MatrixXd columns(static_cast<Eigen::Index>(samples.size()), kColumns);
  Term term = make_term<Term>(period_s, shapes);
  constexpr bool kOneAtATime = one_at_a_time<Term>();
  if constexpr (kOneAtATime) {
    columns.setZero();
  }
  for (Eigen::Index row = 0; row < columns.rows(); ++row) {
    __builtin_prefetch(samples.data() + std::min(row + kFetchedAhead, columns.rows() - 1));
    const auto regressors = term.update(samples[static_cast<std::size_t>(row)]);
    if constexpr (kOneAtATime) {  // all but two are nothing
      const auto at = static_cast<Eigen::Index>(regressors.at);
      columns(row, at) = regressors.rest;
      columns(row, at + 1) = regressors.share;
    } else {
      for (Eigen::Index i = 0; i < kColumns; ++i) {
        columns(row, i) = regressors[static_cast<std::size_t>(i)];
      }
    }
  }
  return columns;
}

}  // namespace capstan::tools
