// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/thesis/hysteresis_laws.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "capstan/tools/identify/bounded_search.hpp"

namespace capstan::tools {
namespace {

using Kind = HysteresisLaw::Kind;
constexpr double kStep = 0.005;  // longest step of an input, share of the saturating one

/// Calls step(u, du) through an input and row(i, u) at each of its values.
template <typename Step, typename Row>
void along(const Eigen::VectorXd& input, Step&& step, Row&& row) {
  double u = -1.0;
  for (Eigen::Index i = 0; i < input.size(); ++i) {
    const auto parts = std::max<long>(1, std::lround(std::ceil(std::abs(input[i] - u) / kStep)));
    const double du = (input[i] - u) / static_cast<double>(parts);
    for (long k = 0; k < parts; ++k, u += du) {
      step(u + 0.5 * du, du);
    }
    u = input[i];
    row(i, u);
  }
}

/// Shapes: log z0, log n, g.
auto bouc_wen_columns(const Eigen::VectorXd& input, const Eigen::VectorXd& shapes) -> Eigen::MatrixXd {
  const double z0 = std::exp(shapes[0]);
  const double n = std::exp(shapes[1]);
  const double g = shapes[2];
  double z = -z0;
  Eigen::MatrixXd columns(input.size(), 3);
  along(
      input,
      [&](double, double du) {
        const double grip = std::pow(std::abs(z) / z0, n);
        z += du - grip * (g * std::abs(du) * (z < 0.0 ? -1.0 : 1.0) + (1.0 - g) * du);
        z = std::clamp(z, -2.0 * z0, 2.0 * z0);
      },
      [&](Eigen::Index i, double u) { columns.row(i) << 1.0, u, z; });
  return columns;
}

/// Shapes: log a, log k. The law is linear in its sources and in where it starts, so each has a column.
auto coleman_hodgdon_columns(const Eigen::VectorXd& input, const Eigen::VectorXd& shapes) -> Eigen::MatrixXd {
  const double a = std::exp(shapes[0]);
  const double k = std::exp(shapes[1]);
  using Sources = Eigen::Matrix<double, 6, 1>;
  Sources y = Sources::Zero();
  y[5] = 1.0;
  Eigen::MatrixXd columns(input.size(), y.size());
  along(
      input,
      [&](double u, double du) {
        const double bend = std::tanh(k * u);
        const double kept = std::exp(-a * std::abs(du));
        Sources pull, push;
        pull << 1.0, u, bend, 0.0, 0.0, 0.0;
        push << 0.0, 0.0, 0.0, du, (1.0 - bend * bend) * du, 0.0;
        y = kept * y + (1.0 - kept) * pull + push;
      },
      [&](Eigen::Index i, double) { columns.row(i) = y.transpose(); });
  return columns;
}

auto columns_of(Kind kind, const Eigen::VectorXd& input, const Eigen::VectorXd& shapes) -> Eigen::MatrixXd {
  return kind == Kind::kBoucWen ? bouc_wen_columns(input, shapes) : coleman_hodgdon_columns(input, shapes);
}

auto coefficients_of(const Eigen::MatrixXd& columns, const Eigen::VectorXd& output) -> Eigen::VectorXd {
  return columns.completeOrthogonalDecomposition().solve(output);
}

auto bounds_of(Kind kind) -> SearchBounds {
  if (kind == Kind::kBoucWen) {
    return {Eigen::Vector3d{std::log(0.01), std::log(0.2), 0.0}, Eigen::Vector3d{std::log(3.0), std::log(8.0), 1.0}};
  }
  return {Eigen::Vector2d{std::log(0.1), std::log(0.1)}, Eigen::Vector2d{std::log(100.0), std::log(20.0)}};
}

/// What the best coefficients leave, by the shapes.
class Left final : public SteppedResidual {
 public:
  Left(Kind kind, const Eigen::VectorXd& input, const Eigen::VectorXd& output)
      : kind_(kind), input_(input), output_(output) {}

 private:
  auto left_of(const Eigen::VectorXd& shapes) -> Eigen::VectorXd override {
    const Eigen::MatrixXd columns = columns_of(kind_, input_, shapes);
    return columns * coefficients_of(columns, output_) - output_;
  }

  Kind kind_;
  const Eigen::VectorXd& input_;
  const Eigen::VectorXd& output_;
};

}  // namespace

HysteresisLaw::HysteresisLaw(Kind kind, const Eigen::VectorXd& input, const Eigen::VectorXd& output) : kind_(kind) {
  constexpr int kStartsEachWay = 3;
  const SearchBounds bounds = bounds_of(kind);
  Left left(kind, input, output);
  double least = std::numeric_limits<double>::infinity();
  const auto dimensions = bounds.lower.size();
  const auto starts = static_cast<int>(std::lround(std::pow(kStartsEachWay, dimensions)));
  for (int start = 0; start < starts; ++start) {
    Eigen::VectorXd shapes = bounds.lower;
    for (int i = 0, rest = start; i < dimensions; ++i, rest /= kStartsEachWay) {
      const double share = (rest % kStartsEachWay + 0.5) / kStartsEachWay;
      shapes[i] += share * (bounds.upper[i] - bounds.lower[i]);
    }
    const SearchResult found = least_squares_within(bounds, shapes, left);
    if (found.squares < least) {
      least = found.squares;
      shapes_ = found.parameters;
    }
  }
  coefficients_ = coefficients_of(columns_of(kind, input, shapes_), output);
}

auto HysteresisLaw::estimate(const Eigen::VectorXd& input) const -> Eigen::VectorXd {
  return columns_of(kind_, input, shapes_) * coefficients_;
}

}  // namespace capstan::tools
