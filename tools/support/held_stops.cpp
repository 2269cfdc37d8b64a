// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/support/held_stops.hpp"

namespace capstan::tools {

HeldStops::HeldStops() {
  sigemptyset(&stops_);
  sigaddset(&stops_, SIGINT);
  sigaddset(&stops_, SIGTERM);
  sigprocmask(SIG_BLOCK, &stops_, &usual_);
}

HeldStops::~HeldStops() {
  sigprocmask(SIG_SETMASK, &usual_, nullptr);
}

auto HeldStops::came(std::chrono::milliseconds wait) -> bool {
  const timespec most{.tv_sec = 0, .tv_nsec = std::chrono::nanoseconds(wait).count()};
  const bool now = ::sigtimedwait(&stops_, nullptr, &most) > 0;
  came_ = came_ || now;
  return now;
}

}  // namespace capstan::tools
