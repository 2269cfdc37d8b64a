// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/tools/select/forward_score.hpp"
#include "capstan/tools/select/growth.hpp"
#include "capstan/tools/select/vocabulary.hpp"

namespace capstan::tools {

/// Laws of a joint angle grown from each of the vocabulary's starts: the law after each step.
auto grown_angle_laws(ForwardScore& forward, const Vocabulary& vocabulary) -> std::vector<ScoredLaw<LawCandidate>>;

}  // namespace capstan::tools
