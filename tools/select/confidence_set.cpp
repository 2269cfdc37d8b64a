// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/select/confidence_set.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "capstan/tools/support/random.hpp"

namespace capstan::tools {
namespace {

/// Mean loss of every model in each resampled log, a row per log: runs of pieces, drawn with replacement, the log's end
/// followed by its beginning.
auto resampled_means(const Eigen::MatrixXd& losses, int resamplings, Eigen::Index run) -> Eigen::MatrixXd {
  Random random(0x5E1EC7);
  const Eigen::Index pieces = losses.rows();
  Eigen::MatrixXd means(resamplings, losses.cols());
  for (int i = 0; i < resamplings; ++i) {
    Eigen::RowVectorXd sum = Eigen::RowVectorXd::Zero(losses.cols());
    for (Eigen::Index taken = 0; taken < pieces;) {
      const auto first = static_cast<Eigen::Index>(random.uniform() * static_cast<double>(pieces));
      for (Eigen::Index k = 0; k < run && taken < pieces; ++k, ++taken) {
        sum += losses.row((first + k) % pieces);
      }
    }
    means.row(i) = sum / static_cast<double>(pieces);
  }
  return means;
}

/// The worst of the models left and how often luck alone would part one from the mean as far.
struct Elimination {
  std::size_t worst = 0;
  double p_value = 1.0;
};

auto test_equal(const Eigen::RowVectorXd& mean, const Eigen::MatrixXd& resampled, const std::vector<Eigen::Index>& left)
    -> Elimination {
  const Eigen::RowVectorXd own = mean(left).array() - mean(left).mean();
  Eigen::MatrixXd draws = resampled(Eigen::all, left);
  draws.colwise() -= draws.rowwise().mean().eval();
  draws.rowwise() -= own;
  const Eigen::RowVectorXd spread =
      (draws.cwiseAbs2().colwise().mean().cwiseSqrt().array()).max(1e-12 * mean(left).cwiseAbs().maxCoeff() + 1e-300);
  const Eigen::RowVectorXd t = own.cwiseQuotient(spread);
  Elimination result;
  Eigen::Index at = 0;
  const double largest = t.maxCoeff(&at);
  result.worst = static_cast<std::size_t>(at);
  Eigen::Index luckier = 0;
  for (Eigen::Index i = 0; i < draws.rows(); ++i) {
    luckier += draws.row(i).cwiseQuotient(spread).maxCoeff() >= largest ? 1 : 0;
  }
  result.p_value = static_cast<double>(luckier) / static_cast<double>(draws.rows());
  return result;
}

}  // namespace

auto confidence_set(const Eigen::MatrixXd& losses, double level, int resamplings, Eigen::Index run) -> ConfidenceSet {
  const auto models = static_cast<std::size_t>(losses.cols());
  ConfidenceSet set{std::vector<bool>(models, true), std::vector<double>(models, 1.0)};
  const Eigen::RowVectorXd mean = losses.colwise().mean();
  const Eigen::MatrixXd resampled = resampled_means(losses, resamplings, run);
  std::vector<Eigen::Index> left(models);
  std::iota(left.begin(), left.end(), Eigen::Index{0});
  double p_value = 0.0;
  while (left.size() > 1) {
    const Elimination test = test_equal(mean, resampled, left);
    p_value = std::max(p_value, test.p_value);
    const auto worst = static_cast<std::size_t>(left[test.worst]);
    set.p_values[worst] = p_value;
    set.in_set[worst] = p_value >= level;
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(test.worst));
  }
  return set;
}

}  // namespace capstan::tools
