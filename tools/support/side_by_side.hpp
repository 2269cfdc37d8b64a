// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstddef>
#include <future>
#include <vector>

namespace capstan::tools {

/// Does work(0) to work(count - 1), in any order, in so many threads, this one among them. What a piece throws comes
/// out when all threads are done. @pre no piece needs or changes what another changes
template <typename Work>
void side_by_side(int threads, std::size_t count, const Work& work) {
  std::atomic<std::size_t> next = 0;
  const auto take_pieces = [&] {
    for (std::size_t i = next++; i < count; i = next++) {
      work(i);
    }
  };
  std::vector<std::future<void>> others;
  for (int i = 1; i < threads; ++i) {
    others.push_back(std::async(std::launch::async, take_pieces));
  }
  take_pieces();
  for (auto& other : others) {
    other.get();
  }
}

/// The same in two threads, for what a user waits for: every machine has two processors.
template <typename Work>
void two_at_a_time(std::size_t count, const Work& work) {
  side_by_side(2, count, work);
}

}  // namespace capstan::tools
