// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>

#include "tools/diagnose/family.hpp"

namespace capstan::tools {
namespace {

constexpr std::size_t kGridPoints = 22;
constexpr std::size_t kFinePoints = 6;

/// Values from low to high in equal ratios.
auto geometric(double low, double high, std::size_t count) -> std::vector<double> {
  std::vector<double> values;
  for (std::size_t i = 0; i < count; ++i) {
    values.push_back(low * std::pow(high / low, static_cast<double>(i) / static_cast<double>(count - 1)));
  }
  return values;
}

/// Every combination of the shapes' grids; a term without shapes has one, empty.
auto shape_grid(const CatalogueTerm& term) -> std::vector<Shapes> {
  constexpr double kSmallestShare = 1.0 / 400.0;  // of the largest value, for shapes that may be zero
  const std::size_t points = term.shapes.size() > 1 ? 6 : kGridPoints;
  std::vector<Shapes> grid = {{}};
  for (const auto& info : term.shapes) {
    std::vector<Shapes> next;
    for (const auto& start : grid) {
      for (const double value : geometric(std::max(info.minimum, kSmallestShare * info.maximum), info.maximum, points)) {
        next.push_back(start);
        next.back().push_back(value);
      }
    }
    grid = std::move(next);
  }
  return grid;
}

/// A few settings around the best, closer than the grid.
auto fine_grid(const CatalogueTerm& term, const Shapes& best) -> std::vector<Shapes> {
  std::vector<Shapes> grid;
  for (std::size_t s = 0; s < best.size(); ++s) {
    const double reach = std::pow(term.shapes[s].maximum / std::max(term.shapes[s].minimum, term.shapes[s].maximum / 400.0),
                                  1.0 / static_cast<double>(kGridPoints - 1));
    for (const double value : geometric(best[s] / reach, best[s] * reach, kFinePoints + 2)) {
      if (value > term.shapes[s].minimum && value < term.shapes[s].maximum) {
        grid.push_back(best);
        grid.back()[s] = value;
      }
    }
  }
  return grid;
}

/// Residual energy on the rows that fit, once a variant is added and the law refitted beside it.
auto energy_left(const Variant& variant, const Family& family, const LawResidual& residual, const Blocks& rows) -> double {
  const Eigen::Index k = residual.base.cols();
  const Eigen::Index own = family.unit_coefficient ? 0 : variant.columns.cols();
  std::vector<Sign> signs(static_cast<std::size_t>(k), Sign::kAny);
  signs.insert(signs.end(), family.signs.begin(), family.signs.begin() + own);
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(k + own, k + own);
  Eigen::VectorXd rhs = Eigen::VectorXd::Zero(k + own);
  double energy = 0.0;
  for (const auto& block : rows) {
    Eigen::MatrixXd x(block.size(), k + own);
    x << residual.base.middleRows(block.begin, block.size()), variant.columns.middleRows(block.begin, block.size()).leftCols(own);
    Eigen::VectorXd y = residual.error.segment(block.begin, block.size());
    if (family.unit_coefficient) {
      y -= variant.columns.col(0).segment(block.begin, block.size());
    }
    gram.noalias() += x.transpose() * x;
    rhs.noalias() += x.transpose() * y;
    energy += y.squaredNorm();
  }
  return energy - solve_signed(gram, rhs, signs).dot(rhs);
}

class Builder {
 public:
  Builder(const Preparation& p, const LawForm& law, const LawResidual& residual)
      : p_(p), law_(law), residual_(residual), rows_(p.split.of(Role::kFit)) {}

  auto build(const CatalogueTerm& term) const -> Family {
    Family family;
    family.name = term.name;
    family.in_catalogue = true;
    family.unit_coefficient = term.acts_on_output;
    for (const auto& coefficient : term.coefficients) {
      family.signs.push_back(coefficient.sign);
    }
    if (term.acts_on_output) {
      family.signs = {Sign::kNonNegative};
    }
    add(term, shape_grid(term), family);
    if (!term.shapes.empty() && !family.variants.empty()) {
      add(term, fine_grid(term, best_of(family)), family);
    }
    return family;
  }

 private:
  void add(const CatalogueTerm& term, const std::vector<Shapes>& grid, Family& family) const {
    for (const auto& shapes : grid) {
      Eigen::MatrixXd columns = decimated(full_rate_columns(term, shapes), p_.factor);
      if (columns.cwiseAbs().maxCoeff() > 0.0) {
        family.variants.push_back({shapes, std::move(columns)});
      }
    }
  }

  auto full_rate_columns(const CatalogueTerm& term, const Shapes& shapes) const -> Eigen::MatrixXd {
    if (term.acts_on_output) {
      return p_.hindsight.apply(term, shapes, residual_.fitted) - residual_.fitted;
    }
    Eigen::MatrixXd columns = p_.hindsight.columns(term, shapes);
    for (const auto& other : term_catalogue()) {
      if (other.acts_on_output && law_.has(other.name)) {
        columns = p_.hindsight.apply(other, law_.shapes_of(other), columns);
      }
    }
    return columns;
  }

  auto best_of(const Family& family) const -> Shapes {
    double least = std::numeric_limits<double>::infinity();
    Shapes shapes;
    for (const auto& variant : family.variants) {
      const double energy = energy_left(variant, family, residual_, rows_);
      if (energy < least) {
        least = energy;
        shapes = variant.shapes;
      }
    }
    return shapes;
  }

  const Preparation& p_;
  const LawForm& law_;
  const LawResidual& residual_;
  Blocks rows_;
};

}  // namespace

auto catalogue_families(const Preparation& p, const LawForm& law, const LawResidual& residual) -> std::vector<Family> {
  const Builder builder(p, law, residual);
  std::vector<Family> families;
  for (const auto& term : term_catalogue()) {
    if (!law.has(term.name)) {
      Family family = builder.build(term);
      if (!family.variants.empty()) {  // a term of the torque shows nothing where no torque was logged
        families.push_back(std::move(family));
      }
    }
  }
  return families;
}

}  // namespace capstan::tools
