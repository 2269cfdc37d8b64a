// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "capstan/tools/diagnose/trials.hpp"

namespace capstan::tools {

/// Two effects of the catalogue that together explain what neither explains alone.
struct EffectPair {
  std::size_t candidate[2] = {};
  std::size_t variant[2] = {};
  Eigen::VectorXd energies;  ///< out of fold per learned block, in the measured quantity
};

/// The best pair, or the special case of it that does as well, when every pair is clearly worse over blocks that holds
/// neither its two nor more general ones; nothing otherwise.
/// Two strong effects can hide each other from a search that adds one at a time.
/// Effects that the catalogue calls confusable with each other are no pair.
auto best_pair(const Evidence& evidence, const Catalogue& catalogue) -> std::optional<EffectPair>;

/// Two effects by their names, at their best variants; nothing unless both are among the candidates.
auto pair_of(const Evidence& evidence, const std::vector<std::string>& names) -> std::optional<EffectPair>;

}  // namespace capstan::tools
