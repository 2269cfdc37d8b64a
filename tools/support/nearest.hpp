// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace capstan::tools {

/// The word that was likely meant: the one that the fewest letters put in, left out or exchanged make of `word`
/// (Levenshtein 1966); nothing where that takes more than a third of its letters.
auto nearest(const std::string& word, const std::vector<std::string>& words) -> std::optional<std::string>;

}  // namespace capstan::tools
