// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/diagnose/identifiability.hpp"

#include <algorithm>
#include <cmath>

#include "capstan/tools/identify/identify.hpp"
#include "capstan/tools/support/statistics.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

constexpr std::size_t kMostParameters = 40;
/// From this correlation on the log knows a sum or a difference of two parameters six times better than either:
/// sqrt((1 + r) / (1 - r)). No log chose it.
constexpr double kConfused = 0.95;

/// A parameter of a law with its regressor.
struct Regressor {
  const CatalogueTerm* term;
  const char* parameter;
  double value;
  std::optional<Interval> ci95;
  Eigen::VectorXd column;
};

auto name_of(const Regressor& one) -> std::string {
  return one.term->name + "." + one.parameter;
}

/// Inverse of the scalar products of columns of length one. What columns that depend on each other leave undetermined
/// comes out large, not infinite.
auto inverse_products(const std::vector<Regressor>& regressors) -> Eigen::MatrixXd {
  constexpr double kSmallest = 1e-12;
  const auto n = static_cast<Eigen::Index>(regressors.size());
  Eigen::MatrixXd gram(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto& a = regressors[static_cast<std::size_t>(i)].column;
    for (Eigen::Index k = 0; k <= i; ++k) {
      const auto& b = regressors[static_cast<std::size_t>(k)].column;
      const double size = a.norm() * b.norm();
      gram(i, k) = gram(k, i) = i == k ? 1.0 : (size > 0.0 ? a.dot(b) / size : 0.0);
    }
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(gram);
  const Eigen::VectorXd inverse = eigen.eigenvalues().cwiseMax(kSmallest).cwiseInverse();
  return eigen.eigenvectors() * inverse.asDiagonal() * eigen.eigenvectors().transpose();
}

auto confused(const Regressor& a, const Regressor& b, double correlation) -> ConfusedPair {
  ConfusedPair pair{name_of(a), name_of(b), {a.term->name, b.term->name}, correlation, {}};
  // Estimates that go together have a difference that is known.
  pair.sentence = "This log determines " + std::string(correlation > 0.0 ? "a difference" : "a sum") + " of " +
                  pair.first + " and " + pair.second + " far better than either (correlation " +
                  rounded(correlation, 3) + ")";
  std::string motion = a.term->exciting_motion;
  if (pair.terms[0] != pair.terms[1]) {
    motion += motion.empty() || b.term->exciting_motion.empty() ? "" : "; ";
    motion += b.term->exciting_motion;
  }
  pair.sentence += motion.empty() ? "." : "; this motion tells them apart: " + motion + ".";
  return pair;
}

auto told(const std::vector<Regressor>& regressors, const Eigen::VectorXd& target) -> Identifiability {
  Identifiability result;
  if (regressors.empty() || regressors.size() > kMostParameters) {
    return result;
  }
  const double size = rms((target.array() - target.mean()).matrix());
  const Eigen::MatrixXd inverse = inverse_products(regressors);
  const Eigen::VectorXd scale = inverse.diagonal().cwiseSqrt().cwiseInverse();
  result.correlation = scale.asDiagonal() * inverse * scale.asDiagonal();
  for (std::size_t i = 0; i < regressors.size(); ++i) {
    const Regressor& one = regressors[i];
    const auto at = static_cast<Eigen::Index>(i);
    ParameterExcitation excited{name_of(one), one.value, -1.0, 0.0, 1.0 / inverse(at, at), {}, 0.0};
    excited.half_width = one.ci95 ? 0.5 * ((*one.ci95)[1] - (*one.ci95)[0]) : -1.0;
    excited.share = size > 0.0 ? std::abs(one.value) * rms(one.column) / size : 0.0;
    for (std::size_t k = 0; k < regressors.size(); ++k) {
      const double alike = result.correlation(at, static_cast<Eigen::Index>(k));
      if (k != i && std::abs(alike) > std::abs(excited.correlation)) {
        excited.correlation = alike;
        excited.most_alike = name_of(regressors[k]);
      }
      if (k > i && std::abs(alike) > kConfused) {
        result.confused.push_back(confused(one, regressors[k], alike));
      }
    }
    result.parameters.push_back(std::move(excited));
  }
  std::sort(result.confused.begin(), result.confused.end(),
            [](const auto& x, const auto& y) { return std::abs(x.correlation) > std::abs(y.correlation); });
  return result;
}

}  // namespace

auto identifiability_of(const std::vector<AxisLog>& logs, const JointFile& law) -> Identifiability {
  if (law.has("preisach")) {
    return {};
  }
  const LawForm form = form_of(law);
  const LawDesign design = design_for(logs, form, law.parameters.conditioner);
  const Eigen::MatrixXd columns = law_columns(design, form);
  std::vector<Regressor> regressors;
  Eigen::VectorXd theta(columns.cols());
  Eigen::Index next = 0;
  for (const auto* term : ordered_terms(form)) {
    for (std::size_t i = 0; i < term->coefficients.size(); ++i, ++next) {
      const std::size_t at = term->first_coefficient + i;
      theta[next] = law.parameters.coefficients[at];
      if (theta[next] != 0.0) {  // else it is held at its bound, or was not chosen
        regressors.push_back(
            {term, term->coefficients[i].name, theta[next], law.coefficient_ci95[at], columns.col(next)});
      }
    }
  }
  const std::vector<TermShape> shapes = searched_shapes(form);
  const Eigen::MatrixXd changes = sensitivities(design, form, theta, shapes);
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const TermShape& shape = shapes[i];
    regressors.push_back({shape.term, shape.info().name, law.parameters.shapes[shape.index()],
                          law.shape_ci95[shape.index()], changes.col(static_cast<Eigen::Index>(i))});
  }
  return told(regressors, design.smoothed(stacked_target(logs)));
}

auto identifiability_of(const std::vector<AxisLog>& logs, const EffortLaw& law) -> Identifiability {
  const EffortDesign design(logs, law.view);
  const JointFile& joint = law.joint;
  std::vector<Regressor> regressors;
  for (const auto& term : *joint.catalogue) {
    if (!joint.has(term.name) || term.acts_on_output) {
      continue;
    }
    const auto first = joint.parameters.shapes.begin() + static_cast<std::ptrdiff_t>(term.first_shape);
    const Eigen::MatrixXd columns =
        design.columns(term, Shapes(first, first + static_cast<std::ptrdiff_t>(term.shapes.size())));
    for (std::size_t i = 0; i < term.coefficients.size(); ++i) {
      const std::size_t at = term.first_coefficient + i;
      const double value = joint.parameters.coefficients[at];
      if (value != 0.0) {
        regressors.push_back({&term, term.coefficients[i].name, value, joint.coefficient_ci95[at],
                              columns.col(static_cast<Eigen::Index>(i))});
      }
    }
  }
  return told(regressors, design.seen(stacked_target(logs)));
}

}  // namespace capstan::tools
