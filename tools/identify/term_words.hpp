// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <iterator>

#include "capstan/tools/identify/term_catalogue.hpp"

namespace capstan::tools {

/// A sample, on a pass over all of them; one further on is asked for. They are so far apart that no processor fetches
/// ahead by itself, and most terms would only wait for them (diagnoses of 600,000 rows: 41 to 25 and 31 s).
inline auto sample_on_the_way(const Samples& samples, Eigen::Index row) -> const Sample<double>& {
  constexpr Eigen::Index kAhead = 24;
  __builtin_prefetch(samples.data() + std::min(row + kAhead, std::ssize(samples) - 1));
  return samples[static_cast<std::size_t>(row)];
}

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

}  // namespace capstan::tools
