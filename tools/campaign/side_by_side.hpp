// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <thread>
#include <vector>

namespace capstan::tools {

/// Runs the same work in so many threads, this one among them, until all are done. They divide it among themselves.
template <typename Work>
void run_side_by_side(int threads, Work&& work) {
  std::vector<std::thread> others;
  for (int i = 1; i < threads; ++i) {
    others.emplace_back(work);
  }
  work();
  for (std::thread& other : others) {
    other.join();
  }
}

}  // namespace capstan::tools
