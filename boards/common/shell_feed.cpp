// SPDX-License-Identifier: Apache-2.0
#include "capstan/boards/common/shell_feed.hpp"

#include <algorithm>
#include <span>
#include <thread>

namespace capstan {

void ShellFeed::take() {
  constexpr int kMostRounds = 16;  // for who never stops sending must not keep the shell from going on
  std::array<char, 64> fresh{};
  bool more = true;
  for (int round = 0; more && round < kMostRounds; ++round) {
    const std::size_t wanted = console_.is_script() ? input_.room() : input_.wants();
    const std::size_t count = console_.receive(std::span(fresh).first(std::min(fresh.size(), wanted)));
    for (std::size_t i = 0; i < count; ++i) {
      input_.take(fresh[i], !console_.is_script());
    }
    more = count == fresh.size();
  }
}

auto ShellFeed::poll() -> bool {
  take();
  if (!met_ && console_.attached() && console_.is_terminal()) {
    shell_.print_banner();
  }
  met_ = console_.attached();
  bool lost = false;
  if (console_.hung_up()) {
    ended_ = console_.is_script();
    lost = !ended_;
    if (lost) {
      input_.peer_left();
    }
  }
  input_.poll();
  if (ended_ && input_.empty() && !shell_.busy()) {
    if (input_.in_line()) {
      input_.take('\n');  // the last line lacks it
      input_.poll();
    }
    ended_ = shell_.busy();
    lost = !ended_;
    if (lost) {
      input_.peer_left();  // a watch at the script's end ends with it
    }
  }
  return lost;
}

void ShellFeed::wait(std::chrono::milliseconds at_most) {
  if (input_.empty() && !shell_.busy()) {
    console_.wait(at_most);
    return;
  }
  // Input would wake it at once although the shell cannot take it yet; the cycle answers within a millisecond.
  console_.flush();
  std::this_thread::sleep_for(std::min(at_most, std::chrono::milliseconds(1)));
}

}  // namespace capstan
