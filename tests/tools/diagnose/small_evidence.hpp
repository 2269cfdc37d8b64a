// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "capstan/tools/diagnose/evidence.hpp"

namespace capstan::tools::test {

/// Evidence whose numbers can be worked out by hand: every column is given, nothing comes from a log.
struct SmallEvidence {
  Eigen::MatrixXd law;    ///< columns of the law so far
  Eigen::VectorXd error;  ///< that it leaves
  std::vector<Candidate> candidates = {};
  Eigen::MatrixXd flexible = {};  ///< or none
  double variance = 1.0;          ///< of the noise, which is white
};

/// Blocks of `size` rows each, one after the other.
auto equal_blocks(Eigen::Index count, Eigen::Index size) -> Blocks;
/// The same with roles that take turns: `pattern` is repeated.
auto split_of(Eigen::Index count, Eigen::Index size, const std::vector<Role>& pattern) -> Split;

/// A candidate of the catalogue with one variant.
auto candidate_named(const std::string& name, const Eigen::MatrixXd& columns, Sign sign = Sign::kAny) -> Candidate;

/// @param split  of the rows; its report blocks take no part
auto evidence_of(const SmallEvidence& small, const Split& split) -> Evidence;

/// A preparation of coarse rows of 1 s that are samples too, all of them settled; angle and target are 0.
auto preparation_of(Eigen::Index rows, const Split& split) -> Preparation;
/// The same of one log.
/// @param samples  one per entry of the target
auto preparation_of(Samples samples, const Eigen::VectorXd& target, const Split& split, double period_s = 1.0)
    -> Preparation;

/// Independent standard normals, always the same ones for one seed.
auto normals(Eigen::Index rows, Eigen::Index columns, unsigned seed) -> Eigen::MatrixXd;

}  // namespace capstan::tools::test
