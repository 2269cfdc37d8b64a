// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/diagnose/profile.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace capstan::tools {
namespace {

/// The model's free columns with what they have to explain behind them, rows stacked; `local` are the blocks' places
/// there.
auto gathered(const Eigen::MatrixXd& columns, const Layout& layout, const ColumnModel& model, const Blocks& rows,
              Blocks& local) -> Eigen::MatrixXd {
  const auto n = static_cast<Eigen::Index>(model.free.size());
  Eigen::MatrixXd result(rows_in(rows), n + 1);
  Eigen::Index row = 0;
  for (const auto& block : rows) {
    for (Eigen::Index i = 0; i < n; ++i) {
      result.col(i).segment(row, block.size()) =
          columns.col(model.free[static_cast<std::size_t>(i)]).segment(block.begin, block.size());
    }
    auto wanted = result.col(n).segment(row, block.size());
    wanted = columns.col(layout.error()).segment(block.begin, block.size());
    if (model.fixed >= 0) {
      wanted -= columns.col(model.fixed).segment(block.begin, block.size());
    }
    local.push_back({row, row + block.size()});
    row += block.size();
  }
  return result;
}

auto least_squares(const Eigen::MatrixXd& x, const std::vector<Sign>& signs) -> Eigen::VectorXd {
  const Eigen::Index n = x.cols() - 1;
  const Eigen::MatrixXd gram = x.leftCols(n).transpose() * x.leftCols(n);
  const Eigen::VectorXd rhs = x.leftCols(n).transpose() * x.col(n);
  return solve_signed(gram, rhs, signs);
}

}  // namespace

auto fit_profile(const Eigen::MatrixXd& columns, const Layout& layout, const ColumnModel& model, const Blocks& rows,
                 const AutoregressiveNoise* known) -> Profile {
  Blocks local;
  const Eigen::MatrixXd x = gathered(columns, layout, model, rows, local);
  const Eigen::Index n = x.cols() - 1;
  if (known != nullptr) {
    return {least_squares(whitened(x, local, *known), model.signs), *known};
  }
  Profile profile{least_squares(x, model.signs), {}};
  constexpr int kAlternations = 3;
  for (int i = 0; i < kAlternations; ++i) {
    profile.noise = fit_noise(x.col(n) - x.leftCols(n) * profile.theta, local, kLargestNoiseOrder);
    profile.theta = least_squares(whitened(x, local, profile.noise), model.signs);
  }
  profile.noise = fit_noise(x.col(n) - x.leftCols(n) * profile.theta, local, kLargestNoiseOrder);
  return profile;
}

auto log_likelihood(const Eigen::MatrixXd& columns, const Layout& layout, const ColumnModel& model,
                    const Profile& profile, const Blocks& rows) -> Eigen::VectorXd {
  Blocks local;
  const Eigen::MatrixXd x = gathered(columns, layout, model, rows, local);
  const Eigen::Index n = x.cols() - 1;
  const Eigen::VectorXd innovations = whitened(x.col(n) - x.leftCols(n) * profile.theta, local, profile.noise);
  const double variance = profile.noise.innovation_variance;
  Eigen::VectorXd result(static_cast<Eigen::Index>(rows.size()));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    // The same rows for every order: likelihoods of different rows can not be compared.
    const Eigen::Index judged = std::max<Eigen::Index>(0, rows[i].size() - kLargestNoiseOrder);
    const auto count = static_cast<double>(judged);
    const double energy = innovations.segment(local[i].end - judged, judged).squaredNorm();
    result[static_cast<Eigen::Index>(i)] =
        -0.5 * count * std::log(2.0 * std::numbers::pi * variance) - 0.5 * energy / variance;
  }
  return result;
}

}  // namespace capstan::tools
