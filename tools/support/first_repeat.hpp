// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <functional>

namespace capstan::tools {

/// The first element of a range that is the same as one before it; its end where all differ.
template <typename Range, typename Same = std::equal_to<>>
auto first_repeat(const Range& range, const Same& same = {}) {
  const auto begin = std::begin(range);
  auto at = begin;
  while (at != std::end(range) && std::none_of(begin, at, [&](const auto& before) { return same(before, *at); })) {
    ++at;
  }
  return at;
}

}  // namespace capstan::tools
