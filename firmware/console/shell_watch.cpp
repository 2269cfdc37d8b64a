// SPDX-License-Identifier: Apache-2.0
// The shell's command that prints signals until somebody stops it, and the list of signals that others take too.
#include <algorithm>

#include "capstan/firmware/console/shell_commands.hpp"

namespace capstan {
namespace {

struct WatchStream final : Stream {
  std::array<Signal, kMostSignals> signals{};
  std::size_t count = 0;
  std::uint32_t every_ms = 0;
  std::uint32_t last_tick = 0;

  void step(Session& session) override;
  void cancel(Session& session) override { session.ok(); }
  [[nodiscard]] auto manner() const -> Manner override { return Manner::kYields; }
};

void WatchStream::step(Session& session) {
  const MachineTelemetry now = session.machine().telemetry();
  if (now.tick - last_tick < every_ms) {
    return;
  }
  last_tick = now.tick;
  Print& out = session.out();
  std::array<AxisTelemetry, Session::kMaxAxes> joints{};
  for (std::size_t axis = 0; axis < session.machine().axes(); ++axis) {
    joints[axis] = session.machine().axis_telemetry(axis);
  }
  for (std::size_t i = 0; i < count; ++i) {
    const Signal& signal = signals[i];
    out << (i == 0 ? "" : "  ");
    print_name(out, signal);
    out << ' ';
    print_raw(out, signal, rt_raw(signal, now, joints));
    if (std::string_view(signal.info->unit) != "1") {
      out << ' ' << signal.info->unit;
    }
  }
  out << "\r\n";
}

}  // namespace

auto parse_signals(std::string_view words, std::size_t axes, std::array<Signal, kMostSignals>& signals,
                   std::size_t& count) -> bool {
  std::array<Signal, kMostSignals> all{};
  std::size_t found = 0;
  for (std::string_view word = next_word(words); !word.empty(); word = next_word(words)) {
    const Signal signal = find_signal(word, axes);
    const auto same = [&signal](const Signal& before) {
      return before.info == signal.info && before.axis == signal.axis;
    };
    if (signal.info == nullptr || found == all.size() || std::any_of(all.begin(), all.begin() + found, same)) {
      return false;
    }
    all[found++] = signal;
  }
  if (found > 0) {
    signals = all;
    count = found;
  }
  return found > 0;
}

void refuse_signals(Session& session) {
  session.error("unknown_signal",
                "a signal is unknown or named twice, or there are more than 8, and nothing was changed",
                "'scope signals' shows all of them; name them as in 'watch joint0.q2'");
}

void commands::watch(Session& session, std::string_view arguments) {
  constexpr std::int32_t kUsualEvery = 200;
  constexpr std::int32_t kLeastEvery = 20;
  constexpr std::int32_t kMostWatchEvery = 60'000;
  std::string_view rest = arguments;
  std::int32_t every = kUsualEvery;
  if (parse_integer(next_word(rest), every) == ParseResult::kOk) {
    arguments = rest;
    if (every < kLeastEvery || every > kMostWatchEvery) {
      session.error("range", "watch prints every 20 to 60000 ms", "write 'watch 200 joint0.q2'");
      return;
    }
  } else {
    every = kUsualEvery;
  }
  auto& watch = session.make<WatchStream>();
  if (!parse_signals(arguments, session.machine().axes(), watch.signals, watch.count)) {
    refuse_signals(session);
    return;
  }
  watch.every_ms = static_cast<std::uint32_t>(every);
  watch.last_tick = session.machine().telemetry().tick - watch.every_ms;
  session.begin(watch);
}

}  // namespace capstan
