// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/diagnose/free_run.hpp"

#include <algorithm>
#include <cmath>

#include "capstan/tools/identify/known_direction.hpp"
#include "capstan/tools/support/random.hpp"
#include "capstan/tools/support/statistics.hpp"

namespace capstan::tools {

auto causal_law(const Preparation& p, const LawForm& form) -> JointFile {
  const Blocks learned = refined(p.split, p.factor).learned();
  auto conditioner = choose_rate_filter(p.logs, p.target, learned, form, p.conditioner);
  if (form.has("tendon_elongation")) {  // what an effect takes away a late switch need not make up for
    conditioner = choose_direction_threshold(p.logs, p.target, learned, form, conditioner);
  }
  const bool same = conditioner.rate_time_constant_s == p.conditioner.rate_time_constant_s &&
                    conditioner.direction_threshold_rad == p.conditioner.direction_threshold_rad;
  const LawDesign causal = same ? p.causal : LawDesign(p.logs, conditioner);
  const LawForm settled = refine_shapes(causal, p.target, learned, form);
  const LawDesign known = of_known_direction(p.logs, causal, settled, conditioner);
  const Eigen::VectorXd taught = known.lined(p.target);
  const Eigen::MatrixXd columns = law_columns(known, settled);
  const LinearFit fit = fit_columns(columns, taught, learned, law_signs(settled));
  const Blocks blocks = interval_blocks(unbroken(learned), taught - columns * fit.theta);
  JointFile joint = law_with_intervals(known, taught, blocks, settled, conditioner);
  describe_logs(p.logs, causal, p.target, estimates(p.logs, causal, joint), joint);
  return joint;
}

auto error_summary(const Eigen::VectorXd& measured, const Eigen::VectorXd& estimate) -> ErrorSummary {
  const double error = rms(measured - estimate);
  const double size = rms(measured);
  return {error, size > 0.0 ? 100.0 * error / size : 0.0, goodness_of_fit_percent(measured, estimate)};
}

auto report_error(const Preparation& p, const Eigen::VectorXd& estimate) -> ErrorSummary {
  const Blocks rows = refined(p.split, p.factor).of(Role::kReport);
  return error_summary(stacked(p.target, rows), stacked(estimate, rows));
}

namespace {

/// Where the running direction switch agrees with the noncausal one, row by row of all logs.
auto rows_of_known_direction(const Preparation& p) -> std::vector<bool> {
  std::vector<bool> known;
  for (std::size_t log = 0; log < p.logs.size(); ++log) {
    const Samples& running = p.causal.samples()[log];
    std::transform(running.begin(), running.end(), p.noncausal.samples()[log].begin(), std::back_inserter(known),
                   [](const auto& now, const auto& later) { return now.forward == later.forward; });
  }
  return known;
}

/// rms over the rows set aside where that is so.
auto rms_of_known_direction(const Preparation& p, const Eigen::VectorXd& error) -> double {
  const std::vector<bool> known = rows_of_known_direction(p);
  double squares = 0.0;
  Eigen::Index count = 0;
  for (const auto& rows : refined(p.split, p.factor).of(Role::kReport)) {
    for (Eigen::Index i = rows.begin; i < rows.end; ++i) {
      if (known[static_cast<std::size_t>(i)]) {
        squares += error[i] * error[i];
        ++count;
      }
    }
  }
  return count > 0 ? std::sqrt(squares / static_cast<double>(count)) : 0.0;
}

}  // namespace

auto error_of_known_direction(const Preparation& p, const Eigen::VectorXd& estimate) -> double {
  return rms_of_known_direction(p, p.target - estimate);
}

auto share_late_by_one_row(const Preparation& p) -> double {
  std::vector<bool> known = rows_of_known_direction(p);
  known.push_back(true);
  int late = 0;
  int by_one_row = 0;
  for (std::size_t i = 0, row = 0; i < known.size(); ++i) {
    row = known[i] ? 0 : row + 1;
    if (row > 0 && known[i + 1]) {
      ++late;
      by_one_row += row == 1 ? 1 : 0;
    }
  }
  return late > 0 ? static_cast<double>(by_one_row) / late : 0.0;
}

auto noise_of_running(const Preparation& p, const LawForm& form) -> double {
  const Eigen::MatrixXd running = law_columns(p.causal, form);
  const LinearFit fit = fit_columns(running, p.target, refined(p.split, p.factor).learned(), law_signs(form));
  return rms_of_known_direction(p, (running - law_columns(p.noncausal, form)) * fit.theta);
}

auto ratio_interval(const Eigen::VectorXd& target, const Blocks& blocks, const Eigen::VectorXd& before,
                    const Eigen::VectorXd& after) -> Interval {
  constexpr int kResamplings = 1000;
  constexpr std::size_t kFewestBlocks = 8;  // as of parameters' intervals; resampled alone one has no width
  const Blocks rows = blocks.size() < kFewestBlocks ? even_parts(blocks, kFewestBlocks) : blocks;
  const auto n = static_cast<Eigen::Index>(rows.size());
  Eigen::VectorXd energy_before(n);
  Eigen::VectorXd energy_after(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto& block = rows[static_cast<std::size_t>(i)];
    energy_before[i] = (target - before).segment(block.begin, block.size()).squaredNorm();
    energy_after[i] = (target - after).segment(block.begin, block.size()).squaredNorm();
  }
  Random random(0xB00);
  Eigen::VectorXd ratios(kResamplings);
  for (double& ratio : ratios) {
    double e0 = 0.0;
    double e1 = 0.0;
    for (Eigen::Index i = 0; i < n; ++i) {
      const auto at = std::min(n - 1, static_cast<Eigen::Index>(random.uniform() * static_cast<double>(n)));
      e0 += energy_before[at];
      e1 += energy_after[at];
    }
    ratio = e0 > 0.0 ? std::sqrt(e1 / e0) : 1.0;
  }
  return {quantile(ratios, 0.025), quantile(ratios, 0.975)};
}

auto ratio_interval(const Preparation& p, const Eigen::VectorXd& before, const Eigen::VectorXd& after) -> Interval {
  return ratio_interval(p.target, refined(p.split, p.factor).of(Role::kReport), before, after);
}

auto holds_on_unseen_rows(const Preparation& p, const LawForm& base, const LawForm& law) -> bool {
  const Eigen::VectorXd target = p.coarse(p.target);
  auto estimate = [&](const LawForm& form) -> Eigen::VectorXd {
    const Eigen::MatrixXd columns = p.coarse(law_columns(p.noncausal, form));
    return columns * fit_columns(columns, target, p.split.learned(), law_signs(form)).theta;
  };
  return ratio_interval(target, p.split.of(Role::kReport), estimate(base), estimate(law))[1] < 1.0;
}

}  // namespace capstan::tools
