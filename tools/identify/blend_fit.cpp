// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "capstan/tools/identify/force_fit.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

constexpr Eigen::Index kBlendBlocks = 16;
constexpr double kEnough = 0.25;     // half of a weight's 95 % interval; wider, it is not known
constexpr double kMostWeight = 2.0;  // that a board takes
constexpr double kLeastTolerance = 1e-4;

/// What both laws say of all logs where both are known, and the joint's torque there.
struct BothLaws {
  Eigen::MatrixXd columns;  ///< pull, pull_push
  Eigen::VectorXd torque_nm;
  std::vector<Eigen::Index> log_rows;
};

auto parameters_of(const PullPushFit& fit, ForceLawKind kind) -> ForceLawParameters<double> {
  return {
      .kind = kind, .pull_push = fit.law, .friction_nm = std::max(fit.friction_nm, 0.0), .offset_nm = fit.offset_nm};
}

auto run_both(const std::vector<AxisLog>& logs, const PullPushFit& fit) -> BothLaws {
  using Law = ForceLaw<double, 2, 4>;
  const Law::Grid::Table none{};
  BothLaws both;
  std::vector<std::array<double, 3>> rows;
  for (const AxisLog& log : logs) {
    Law pull;
    Law pull_push;
    pull.become(parameters_of(fit, ForceLawKind::kPull), none);
    pull_push.become(parameters_of(fit, ForceLawKind::kPullPush), none);
    const auto before = static_cast<Eigen::Index>(rows.size());
    for (Eigen::Index i = 0; i < log.samples(); ++i) {
      const auto a = pull.update(log.tau_nm[i]);
      const auto b = pull_push.update(log.tau_nm[i]);
      if (a.known && b.known) {
        rows.push_back({a.force, b.force, log.effort[i]});
      }
    }
    both.log_rows.push_back(static_cast<Eigen::Index>(rows.size()) - before);
  }
  both.columns.resize(static_cast<Eigen::Index>(rows.size()), 2);
  both.torque_nm.resize(both.columns.rows());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    both.columns.row(row) << rows[i][0], rows[i][1];
    both.torque_nm[row] = rows[i][2];
  }
  return both;
}

auto weigh(const BothLaws& both, const Blocks& blocks) -> LinearFit {
  return fit_columns(both.columns, both.torque_nm, blocks, {Sign::kNonNegative, Sign::kNonNegative});
}

auto rms_in(const BothLaws& both, const Eigen::Vector2d& weights, const Blocks& blocks) -> double {
  return std::sqrt(stacked(both.torque_nm - both.columns * weights, blocks).squaredNorm() /
                   static_cast<double>(rows_in(blocks)));
}

/// Each half of the blocks by the weights of the other.
auto unseen_sentence(const BothLaws& both, const Blocks& blocks) -> std::string {
  std::array<Blocks, 2> halves;
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    halves[i % 2].push_back(blocks[i]);
  }
  const auto unseen = [&](std::size_t i) { return rms_in(both, weigh(both, halves[1 - i]).theta, halves[i]); };
  const double blend = std::hypot(unseen(0), unseen(1)) / std::sqrt(2.0);
  const double alone = rms_in(both, {0.0, 1.0}, blocks);
  return "on rows that the weights were not fitted to the blend leaves " + rounded(blend, 3) +
         " N m, the pull-push law alone " + rounded(alone, 3) + " N m" +
         (blend < alone ? "" : ": take --model pull_push");
}

}  // namespace

auto fit_blend(const std::vector<AxisLog>& logs) -> PullPushFit {
  PullPushFit fit = fit_pull_push(logs);
  const BothLaws both = run_both(logs, fit);
  const Blocks blocks = even_blocks(both.log_rows, kBlendBlocks);
  const LinearFit weights = weigh(both, blocks);
  fit.kind = ForceLawKind::kBlend;
  fit.law.pull_weight = weights.theta[0];
  fit.law.pull_push_weight = weights.theta[1];
  for (const auto& [i, name] : {std::pair{0, "pull_weight"}, std::pair{1, "pull_push_weight"}}) {
    fit.parameters.push_back({name, "1", weights.theta[i], half_interval(weights, i)});
    if (weights.tolerance[i] < kLeastTolerance || half_interval(weights, i) > kEnough ||
        weights.theta[i] > kMostWeight) {
      fit.undetermined.emplace_back(name);
    }
  }
  fit.notes.push_back(unseen_sentence(both, blocks));
  fit.rmse_nm = rms_in(both, weights.theta, blocks);
  fit.samples = static_cast<long>(both.torque_nm.size());
  fit.error_bar = force_error_bar(logs, parameters_of(fit, ForceLawKind::kBlend), {});
  return fit;
}

}  // namespace capstan::tools
