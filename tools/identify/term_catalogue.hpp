// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <functional>
#include <string>
#include <vector>

#include "model/catalogue.hpp"

namespace capstan::tools {

using Shapes = std::vector<double>;
using Samples = std::vector<Sample<double>>;

/// One term of the catalogue, as data: what the terms know at compile time, for programs that loop over them.
struct CatalogueTerm {
  std::string name, equation, source, confusable_with, exciting_motion;
  std::vector<CoefficientInfo> coefficients;
  std::vector<ShapeInfo> shapes;
  std::size_t first_coefficient = 0;  ///< in LawParameters::coefficients
  std::size_t first_shape = 0;        ///< in LawParameters::shapes
  bool acts_on_output = false;

  /// Sum terms: one column per coefficient over consecutive samples of one log, by the term's own update().
  std::function<Eigen::MatrixXd(const Samples&, double period_s, const Shapes&)> columns;
  /// Output terms: a signal of one log passed through the term. It is linear, so the columns of a fit may be passed
  /// instead.
  std::function<Eigen::VectorXd(const Eigen::VectorXd&, double period_s, const Shapes&)> apply;

  [[nodiscard]] auto initial_shapes() const -> Shapes;
};

/// All terms, in the order of SumTerms, then OutputTerms.
auto term_catalogue() -> const std::vector<CatalogueTerm>&;
/// @pre the name is in the catalogue
auto catalogue_term(const std::string& name) -> const CatalogueTerm&;
auto in_catalogue(const std::string& name) -> bool;

}  // namespace capstan::tools
