// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/diagnose/left_to_choose.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "capstan/tools/support/statistics.hpp"

namespace capstan::tools {

auto left_to_choose(const Preparation& p, const LawForm& law) -> double {
  const Split fine = refined(p.split, p.factor);
  const Eigen::MatrixXd columns = law_columns(p.causal, law);
  const LinearFit fit = fit_columns(columns, p.target, fine.of(Role::kFit), law_signs(law));
  return rms(stacked(p.target - columns * fit.theta, fine.of(Role::kChoose)));
}

auto noise_of(const Preparation& p, const Search& search, double left_by_found) -> double {
  return p.repeats ? search.noise_floor : std::min(search.noise_floor, left_by_found);
}

auto noise_known(const Preparation& p, const JointFile& healthy) -> double {
  if (!healthy.fit) {
    return std::numeric_limits<double>::infinity();
  }
  const Eigen::Index rows = p.target.size() - 1;
  const Eigen::VectorXd steps = p.target.tail(rows) - p.target.head(rows);
  return std::max(healthy.fit->rmse, rms(steps) / std::sqrt(2.0));
}

}  // namespace capstan::tools
