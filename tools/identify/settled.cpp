// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/identify/settled.hpp"

#include <algorithm>

namespace capstan::tools {

auto settled_rows(const Eigen::VectorXd& q1, const Blocks& logs, const SettlingRule& rule) -> Blocks {
  Blocks settled;
  for (const RowRange& log : logs) {
    const auto motion = q1.segment(log.begin, log.size());
    if (motion.size() == 0) {
      settled.push_back(log);
      continue;
    }
    const double enough = rule.share_of_range * (motion.maxCoeff() - motion.minCoeff());
    double least = motion[0];
    double most = motion[0];
    Eigen::Index row = 0;
    for (; row < motion.size() && most - least < enough; ++row) {
      least = std::min(least, motion[row]);
      most = std::max(most, motion[row]);
    }
    const auto latest = static_cast<Eigen::Index>(rule.most_share_of_rows * static_cast<double>(log.size()));
    settled.push_back({log.begin + std::min(row, latest), log.end});
  }
  return settled;
}

}  // namespace capstan::tools
