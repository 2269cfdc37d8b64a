// SPDX-License-Identifier: Apache-2.0
#include "boards/common/shell_feed.hpp"

#include <algorithm>
#include <span>
#include <thread>

namespace capstan {
namespace {
constexpr char kCancel = 0x03;
}  // namespace

void ShellFeed::take() {
  if (empty()) {
    first_ = 0;
    count_ = 0;
  }
  const std::size_t before = count_;
  count_ += console_.receive(std::span(waiting_).subspan(count_));
  const auto* const fresh = waiting_.begin() + before;
  const auto* const end = waiting_.begin() + count_;
  if (const auto* const cancel = std::find(fresh, end, kCancel); cancel != end && shell_.busy()) {
    first_ = static_cast<std::size_t>(cancel - waiting_.begin());
    shell_.receive(waiting_[first_++]);
  }
}

auto ShellFeed::poll() -> bool {
  take();
  shell_.poll();
  bool lost = false;
  if (console_.hung_up()) {
    ended_ = console_.is_script();
    lost = !ended_;
    if (lost) {
      first_ = count_;
      shell_.receive(kCancel);
    }
  }
  while (!empty() && !shell_.busy()) {
    shell_.receive(waiting_[first_++]);
  }
  if (ended_ && empty() && !shell_.busy()) {
    shell_.receive('\n');  // the last line may lack it
    ended_ = shell_.busy();
    lost = !ended_;
  }
  shell_.poll();
  return lost;
}

void ShellFeed::wait(std::chrono::milliseconds at_most) {
  if (empty() && !shell_.busy()) {
    console_.wait(at_most);
    return;
  }
  // Input would wake it at once although the shell cannot take it yet; the cycle answers within a millisecond.
  console_.flush();
  std::this_thread::sleep_for(std::min(at_most, std::chrono::milliseconds(1)));
}

}  // namespace capstan
