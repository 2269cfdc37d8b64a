// SPDX-License-Identifier: Apache-2.0
#include "tools/identify/term_catalogue.hpp"

#include <algorithm>
#include <stdexcept>

namespace capstan::tools {
namespace {

template <typename Term>
auto make_term(double period_s, const Shapes& shapes) -> Term {
  std::array<double, kShapesOf<Term>> shape{};
  for (std::size_t i = 0; i < shape.size(); ++i) {
    shape[i] = shapes.at(i);
  }
  return Term(SamplePeriod<double>(period_s), shape);
}

template <typename Term>
auto describe() -> CatalogueTerm {
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

template <typename Term>
auto sum_columns(const Samples& samples, double period_s, const Shapes& shapes) -> Eigen::MatrixXd {
  constexpr auto kColumns = static_cast<Eigen::Index>(kCoefficientsOf<Term>);
  Eigen::MatrixXd columns(static_cast<Eigen::Index>(samples.size()), kColumns);
  Term term = make_term<Term>(period_s, shapes);
  for (Eigen::Index row = 0; row < columns.rows(); ++row) {
    const auto regressors = term.update(samples[static_cast<std::size_t>(row)]);
    for (Eigen::Index i = 0; i < kColumns; ++i) {
      columns(row, i) = regressors[static_cast<std::size_t>(i)];
    }
  }
  return columns;
}

template <typename Term>
auto pass_through(const Eigen::VectorXd& signal, double period_s, const Shapes& shapes) -> Eigen::VectorXd {
  Eigen::VectorXd result(signal.size());
  Term term = make_term<Term>(period_s, shapes);
  for (Eigen::Index row = 0; row < signal.size(); ++row) {
    result[row] = term.update(signal[row]);
  }
  return result;
}

auto build_catalogue() -> std::vector<CatalogueTerm> {
  std::vector<CatalogueTerm> terms;
  std::size_t coefficient = 0;
  std::size_t shape = 0;
  auto add = [&](CatalogueTerm term) {
    term.first_coefficient = coefficient;
    term.first_shape = shape;
    coefficient += term.coefficients.size();
    shape += term.shapes.size();
    terms.push_back(std::move(term));
  };
  SumTerms::for_each<double>([&]<typename Term>() {
    CatalogueTerm term = describe<Term>();
    term.columns = sum_columns<Term>;
    add(std::move(term));
  });
  OutputTerms::for_each<double>([&]<typename Term>() {
    CatalogueTerm term = describe<Term>();
    term.acts_on_output = true;
    term.apply = pass_through<Term>;
    add(std::move(term));
  });
  return terms;
}

}  // namespace

auto CatalogueTerm::initial_shapes() const -> Shapes {
  Shapes initial;
  for (const auto& shape : shapes) {
    initial.push_back(shape.initial);
  }
  return initial;
}

auto term_catalogue() -> const std::vector<CatalogueTerm>& {
  static const std::vector<CatalogueTerm> kTerms = build_catalogue();
  return kTerms;
}

auto in_catalogue(const std::string& name) -> bool {
  return std::any_of(term_catalogue().begin(), term_catalogue().end(),
                     [&](const auto& term) { return term.name == name; });
}

auto catalogue_term(const std::string& name) -> const CatalogueTerm& {
  const auto& terms = term_catalogue();
  const auto found = std::find_if(terms.begin(), terms.end(), [&](const auto& term) { return term.name == name; });
  if (found == terms.end()) {
    throw std::logic_error("no term " + name + " in the catalogue");
  }
  return *found;
}

}  // namespace capstan::tools
