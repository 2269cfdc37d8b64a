// SPDX-License-Identifier: Apache-2.0
#include "capstan/firmware/console/recording.hpp"

#include <algorithm>

namespace capstan {
namespace {

constexpr std::array<std::string_view, 5> kLogged = {"q1", "torque", "q2", "reference", "current"};

}  // namespace

auto start_recorder(Session& session, const RecorderSetup& setup) -> bool {
  const bool started = session.machine().recorder().start(&session, setup);
  if (!started) {
    session.error("busy", "the recorder is in use, by another console or still by the last command",
                  "send the line again");
  }
  return started;
}

void Recording::choose(std::size_t axis) {
  choose_signals(setup, axis, kLogged);
}

auto Recording::begin(Session& session) -> bool {
  if (!start_recorder(session, setup)) {
    return false;
  }
  dropped_before_ = session.machine().recorder().dropped();
  Print& out = session.out();
  out << "time_s" << (site >= 0 ? ",site" : "");
  for (std::size_t i = 0; i + 1 < setup.count; ++i) {
    out << ',';
    print_column(out, setup.signals[i]);
  }
  out << "\r\n";
  return true;
}

void Recording::print_row(Print& out, const SignalSample& sample) const {
  if (sample.tick % print_every != 0) {
    return;
  }
  print_seconds(out, sample.tick);
  if (site >= 0) {
    out << ',' << site;
  }
  for (std::size_t i = 0; i + 1 < setup.count; ++i) {
    out << ',';
    print_raw(out, setup.signals[i], sample.raw[i]);
  }
  out << "\r\n";
}

auto Recording::end(Session& session) -> std::uint32_t {
  Recorder& recorder = session.machine().recorder();
  recorder.stop(&session);
  const std::uint32_t dropped = recorder.dropped() - dropped_before_;
  if (dropped != 0) {
    session.out() << "# " << dropped << " samples found no room; log every " << 2 * std::max(setup.every, print_every)
                  << " or fewer at a time\r\n";
  }
  return dropped;
}

}  // namespace capstan
