// SPDX-License-Identifier: Apache-2.0
#include "capstan/boards/linux_rt/linux_rt_board.hpp"

#include <algorithm>
#include <chrono>
#include <stdexcept>

namespace capstan {

LinuxRtBoard::LinuxRtBoard(const RtOptions& options, std::unique_ptr<RtJoints> joints)
    : joints_(std::move(joints)), loop_(options) {}

LinuxRtBoard::~LinuxRtBoard() {
  loop_.stop();
  if (thread_.joinable()) {
    thread_.join();
  }
  joints_->release();
}

void LinuxRtBoard::start() {
  running_ = true;
  thread_ = std::thread([this] { run(); });
}

void LinuxRtBoard::run() {
  try {
    Timing timing;
    report_ = loop_.run([this, &timing](const RtTick& tick) {
      rt_note(tick, timing);
      joints_->rt_tick(static_cast<std::uint32_t>(tick.overruns));
    });
  } catch (...) {
    problem_ = std::current_exception();
  }
  running_ = false;
}

void LinuxRtBoard::rt_note(const RtTick& tick, Timing& timing) {
  const auto us = [](std::chrono::nanoseconds time) {
    return static_cast<std::int32_t>(std::chrono::duration_cast<std::chrono::microseconds>(time).count());
  };
  timing.late = us(tick.late);
  timing.cycle = us(tick.last_cycle);
  timing.latest = std::max(timing.latest, timing.late);
  timing.longest = std::max(timing.longest, timing.cycle);
  timing.page_faults = static_cast<std::uint32_t>(tick.page_faults);
  timing_.rt_publish(timing);
}

void LinuxRtBoard::print_timing(Print& out) const {
  const Timing now = timing_.read();
  out << "real-time thread: began " << now.late << " us late, the latest " << now.latest << " us; took " << now.cycle
      << " us, the longest " << now.longest << " us; page faults " << now.page_faults << "\r\n";
  joints_->print(out);
}

auto LinuxRtBoard::stop() -> RtReport {
  using std::chrono::steady_clock;
  constexpr std::chrono::seconds kLongEnough{1};
  joints_->link_lost();
  const auto end = steady_clock::now() + kLongEnough;
  while (running() && energised(machine().telemetry().state) && steady_clock::now() < end) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  loop_.stop();
  if (thread_.joinable()) {
    thread_.join();
  }
  joints_->release();
  if (problem_) {
    std::rethrow_exception(problem_);
  }
  if (const std::string failure = joints_->failure(); !failure.empty()) {
    throw std::runtime_error(failure);
  }
  return report_;
}

}  // namespace capstan
