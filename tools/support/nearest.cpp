// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/support/nearest.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

namespace capstan::tools {
namespace {

auto distance(const std::string& a, const std::string& b) -> std::size_t {
  std::vector<std::size_t> above(b.size() + 1);  // from the letters of `a` so far to each beginning of `b`
  std::iota(above.begin(), above.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = std::exchange(above[0], i + 1);
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t exchanged = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = above[j + 1];
      above[j + 1] = std::min({exchanged, above[j + 1] + 1, above[j] + 1});
    }
  }
  return above.back();
}

}  // namespace

auto nearest(const std::string& word, const std::vector<std::string>& words) -> std::optional<std::string> {
  constexpr std::size_t kLettersPerSlip = 3;
  std::optional<std::string> best;
  std::size_t fewest = word.size() / kLettersPerSlip + 1;
  for (const std::string& other : words) {
    const std::size_t steps = distance(word, other);
    if (steps < fewest) {
      fewest = steps;
      best = other;
    }
  }
  return best;
}

}  // namespace capstan::tools
