// SPDX-License-Identifier: Apache-2.0
#include "capstan/tests/tools/diagnose/small_evidence.hpp"

#include <random>

namespace capstan::tools::test {

auto equal_blocks(Eigen::Index count, Eigen::Index size) -> Blocks {
  Blocks blocks;
  for (Eigen::Index i = 0; i < count; ++i) {
    blocks.push_back({i * size, (i + 1) * size});
  }
  return blocks;
}

auto split_of(Eigen::Index count, Eigen::Index size, const std::vector<Role>& pattern) -> Split {
  Split split;
  const Blocks blocks = equal_blocks(count, size);
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    split.blocks.push_back({blocks[i], pattern[i % pattern.size()]});
  }
  return split;
}

auto candidate_named(const std::string& name, const Eigen::MatrixXd& columns, Sign sign) -> Candidate {
  Candidate candidate;
  candidate.name = name;
  candidate.in_catalogue = true;
  candidate.signs.assign(static_cast<std::size_t>(columns.cols()), sign);
  candidate.variants.push_back({{}, columns, 0});
  return candidate;
}

auto evidence_of(const SmallEvidence& small, const Split& split) -> Evidence {
  Evidence evidence;
  evidence.candidates = small.candidates;
  evidence.layout.law = small.law.cols();
  std::vector<Eigen::MatrixXd> parts = {small.law, small.error};
  Eigen::Index next = small.law.cols() + 1;
  for (auto& candidate : evidence.candidates) {
    for (auto& variant : candidate.variants) {
      variant.first = next;
      next += variant.columns.cols();
      parts.push_back(variant.columns);
    }
  }
  evidence.layout.flexible = next;
  parts.push_back(small.flexible);
  evidence.layout.total = next + small.flexible.cols();
  evidence.columns.resize(small.error.size(), evidence.layout.total);
  Eigen::Index at = 0;
  for (const auto& part : parts) {
    if (part.cols() > 0) {
      evidence.columns.middleCols(at, part.cols()) = part;
      at += part.cols();
    }
  }
  evidence.noise.innovation_variance = evidence.innovation_variance = small.variance;
  std::size_t next_block = 0;
  for (const auto& block : split.blocks) {
    if (block.role != Role::kReport) {
      (block.role == Role::kFit ? evidence.fit : evidence.choose).push_back(next_block);
      evidence.learned.push_back(next_block++);
    }
  }
  evidence.error = evidence.white_error = small.error;
  evidence.sensing = evidence.white_sensing = Eigen::MatrixXd::Zero(small.error.size(), 2);
  evidence.raw_white.assign(2, BlockGrams(evidence.columns, evidence.layout, split.learned()));
  return evidence;
}

auto preparation_of(Samples samples, const Eigen::VectorXd& target, const Split& split, double period_s)
    -> Preparation {
  AxisLog log;
  log.q1_rad.resize(target.size());
  log.tau_nm.resize(target.size());
  for (Eigen::Index i = 0; i < target.size(); ++i) {
    log.q1_rad[i] = samples[static_cast<std::size_t>(i)].q1;
    log.tau_nm[i] = samples[static_cast<std::size_t>(i)].tau;
  }
  const LawDesign design({std::move(samples)}, {period_s});
  log.period_s = period_s;
  log.time_s = Eigen::VectorXd::LinSpaced(target.size(), 0.0, period_s * static_cast<double>(target.size() - 1));
  log.q2_rad = target;
  Preparation p{{log}, {}, {}, design, design, {}, target, 1, 0, period_s, {{0, target.size()}}, {}, split, {}, {}, {}};
  p.signals.time_s = log.time_s;
  return p;
}

auto preparation_of(Eigen::Index rows, const Split& split) -> Preparation {
  return preparation_of(Samples(static_cast<std::size_t>(rows)), Eigen::VectorXd::Zero(rows), split);
}

auto normals(Eigen::Index rows, Eigen::Index columns, unsigned seed) -> Eigen::MatrixXd {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal;
  Eigen::MatrixXd values(rows, columns);
  for (double& value : values.reshaped()) {
    value = normal(engine);
  }
  return values;
}

}  // namespace capstan::tools::test
