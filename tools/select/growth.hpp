// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/tools/select/forward_score.hpp"
#include "capstan/tools/select/vocabulary.hpp"

namespace capstan::tools {

/// A law and how well it predicts.
struct ScoredLaw {
  LawCandidate law;
  double score = 0.0;  ///< mean squared error on unseen parts
};

/// Grows a law by what lowers its error on unseen parts most, as long as that is worth a step; after each step it is
/// looked at whether something has become superfluous or another setting serves better. The law after each step.
auto grow(ForwardScore& forward, const Vocabulary& vocabulary, const LawCandidate& start) -> std::vector<ScoredLaw>;

}  // namespace capstan::tools
