// SPDX-License-Identifier: Apache-2.0
// The shell's command that captures signals in every cycle around a trigger.
#include <algorithm>

#include "capstan/firmware/console/shell_commands.hpp"

namespace capstan {
namespace {

struct TriggerName {
  std::string_view name;
  ScopeTrigger trigger;
};
constexpr std::array<TriggerName, 6> kTriggers = {{{"now", ScopeTrigger::kNow},
                                                   {"fault", ScopeTrigger::kFault},
                                                   {"rising", ScopeTrigger::kRising},
                                                   {"falling", ScopeTrigger::kFalling},
                                                   {"above", ScopeTrigger::kAbove},
                                                   {"below", ScopeTrigger::kBelow}}};

auto trigger_named(std::string_view word) -> const TriggerName* {
  const auto* const found =
      std::find_if(kTriggers.begin(), kTriggers.end(), [word](const TriggerName& t) { return t.name == word; });
  return found == kTriggers.end() ? nullptr : found;
}

/// A whole number in a range; `value` keeps what it has if there is no word.
auto optional_number(std::string_view word, std::int32_t minimum, std::int32_t maximum, std::int32_t& value) -> bool {
  return word.empty() || (parse_integer(word, value) == ParseResult::kOk && value >= minimum && value <= maximum);
}

constexpr std::int32_t kMostEvery = 1000;

class DumpStream final : public Stream {
 public:
  void step(Session& session) override;
  void cancel(Session& session) override { next_ = session.machine().scope().size(); }

 private:
  std::size_t next_ = 0;  // sample
};

void DumpStream::step(Session& session) {
  constexpr std::size_t kLinesAtOnce = 4;
  const StepTime time(session.machine());
  Scope& scope = session.machine().scope();
  Print& out = session.out();
  const std::size_t end = std::min(scope.size(), next_ + kLinesAtOnce);
  for (; next_ < end && time.left(); ++next_) {
    const std::int32_t cycles = scope.cycles_from_trigger(next_);
    out << (cycles < 0 ? "-" : "");
    print_seconds(out, static_cast<std::uint32_t>(cycles < 0 ? -cycles : cycles));
    for (std::size_t i = 0; i < scope.setup().channel_count; ++i) {
      out << ',';
      print_raw(out, scope.setup().channels[i], scope.raw(next_, i));
    }
    out << "\r\n";
  }
  if (next_ >= scope.size()) {
    scope.end_reading();
    session.ok();
  }
}

void scope_status(Session& session) {
  static constexpr std::array<const char*, 4> kPhases = {"idle", "waiting for its trigger", "triggered and filling",
                                                         "done, ready to dump"};
  Print& out = session.out();
  out << "scope " << kPhases[static_cast<std::size_t>(session.machine().scope().phase())] << "\r\nchannels";
  for (std::size_t i = 0; i < session.scope_setup().channel_count; ++i) {
    out << ' ';
    print_name(out, session.scope_setup().channels[i]);
  }
  out << (session.scope_setup().channel_count == 0 ? " none" : "") << "\r\ntrigger ";
  const ScopeTrigger trigger = session.scope_setup().trigger;
  if (trigger != ScopeTrigger::kNow && trigger != ScopeTrigger::kFault) {
    print_name(out, session.scope_setup().trigger_signal);
    out << ' ';
  }
  out << kTriggers[static_cast<std::size_t>(trigger)].name;
  if (trigger != ScopeTrigger::kNow && trigger != ScopeTrigger::kFault) {
    out << ' ';
    print_raw(out, session.scope_setup().trigger_signal, session.scope_setup().level);
    out << ' ' << session.scope_setup().trigger_signal.info->unit;
  }
  out << "\r\n";
  session.ok();
}

/// The list of them, a line a signal.
class SignalsStream final : public PartsStream {
  auto print(Session& session, std::uint32_t part) -> bool override {
    const std::size_t of_joints = session.machine().axes() * joint_signals().size();
    if (part == of_joints + machine_signals().size()) {
      session.ok();
      return false;
    }
    const Signal signal = part < of_joints ? Signal{&joint_signals()[part % joint_signals().size()],
                                                    static_cast<std::uint8_t>(part / joint_signals().size())}
                                           : Signal{&machine_signals()[part - of_joints]};
    print_name(session.out(), signal);
    session.out() << ' ' << signal.info->unit << ' ' << signal.info->doc << "\r\n";
    return true;
  }
};

void scope_channels(Session& session, std::string_view arguments) {
  if (parse_signals(arguments, session.machine().axes(), session.scope_setup().channels,
                    session.scope_setup().channel_count)) {
    session.ok();
  } else {
    refuse_signals(session);
  }
}

void scope_trigger(Session& session, std::string_view arguments) {
  constexpr const char* kCure =
      "write 'scope trigger now', 'scope trigger fault' or 'scope trigger joint0.q2 rising 0.1 rad' (rising, falling, "
      "above, below)";
  std::string_view word = next_word(arguments);
  Signal signal;
  const TriggerName* trigger = trigger_named(word);
  const bool alone = trigger != nullptr && trigger->trigger <= ScopeTrigger::kFault;
  if (!alone) {
    signal = find_signal(word, session.machine().axes());
    if (signal.info == nullptr) {
      session.error("unknown_signal", "there is no such signal or trigger, and nothing was changed", kCure);
      return;
    }
    trigger = trigger_named(next_word(arguments));
    if (trigger == nullptr || trigger->trigger <= ScopeTrigger::kFault) {
      session.error("usage", "a trigger on a signal needs a direction, and nothing was changed", kCure);
      return;
    }
  }
  std::int32_t level = 0;
  if (!alone) {
    Q24 value;
    const bool parsed = signal.info->type == SignalType::kReal
                            ? parse_quantity(arguments, signal.info->unit, value) == ValueError::kNone
                            : parse_integer(next_word(arguments), level) == ParseResult::kOk;
    if (!parsed) {
      session.error("not_a_level", "the level is not a number of the signal's unit and range, and nothing was changed",
                    kCure);
      return;
    }
    level = signal.info->type == SignalType::kReal ? value.raw() : level;
  } else if (!next_word(arguments).empty()) {
    session.error("usage", "this trigger takes no arguments, and nothing was changed", kCure);
    return;
  }
  session.scope_setup().trigger = trigger->trigger;
  session.scope_setup().trigger_signal = signal;
  session.scope_setup().level = level;
  session.ok();
}

/// Begins or ends a capture.
void hand_over_setup(Session& session, const ScopeSetup& setup) {
  Scope& scope = session.machine().scope();
  if (scope.start(setup)) {
    session.answer_when_taken();
  } else if (scope.reading()) {
    session.error("busy", "another console is reading the last capture, and nothing was changed",
                  "send the line again when its dump has ended");
  } else {
    session.busy_cycle();
  }
}

void scope_start(Session& session, std::string_view arguments) {
  if (session.scope_setup().channel_count == 0) {
    session.error("no_channels", "the scope has no channels to record", "'scope channels joint0.q2' first");
    return;
  }
  const auto room = static_cast<std::int32_t>(Scope::kWords / session.scope_setup().channel_count);
  std::int32_t samples = std::min<std::int32_t>(room, 1000);
  std::int32_t every = 1;
  const bool counted = optional_number(next_word(arguments), 2, room, samples);
  std::int32_t before = samples / 4;
  if (!counted || !optional_number(next_word(arguments), 0, samples - 1, before) ||
      !optional_number(next_word(arguments), 1, kMostEvery, every) || !next_word(arguments).empty()) {
    session.out() << "error range: with these channels scope takes 2 to " << room
                  << " samples, not all of them before the trigger, and one every 1 to 1000 ms; write "
                     "'scope start 1000 250 1'\r\n";
    session.refused();
    return;
  }
  session.scope_setup().samples = static_cast<std::size_t>(samples);
  session.scope_setup().before = static_cast<std::size_t>(before);
  session.scope_setup().every = static_cast<std::uint32_t>(every);
  hand_over_setup(session, session.scope_setup());
}

void scope_dump(Session& session) {
  Scope& scope = session.machine().scope();
  if (!scope.begin_reading()) {
    session.error("nothing_captured", "there is no finished capture",
                  "'scope start', then look at 'scope' until it is done");
    return;
  }
  session.out() << "# trigger in cycle " << scope.trigger_tick() << ", " << scope.dropped()
                << " cycles dropped while it ran\r\ntime_s";
  for (std::size_t i = 0; i < scope.setup().channel_count; ++i) {
    session.out() << ',';
    print_column(session.out(), scope.setup().channels[i]);
  }
  session.out() << "\r\n";
  session.begin(session.make<DumpStream>());
}

}  // namespace

void commands::scope(Session& session, std::string_view arguments) {
  const std::string_view word = next_word(arguments);
  const bool alone = word == "signals" || word == "stop" || word == "dump";
  if (alone && refuses_more(session, arguments)) {
    return;
  }
  if (word.empty()) {
    scope_status(session);
  } else if (word == "signals") {
    session.answer(session.make<SignalsStream>());
  } else if (word == "channels") {
    scope_channels(session, arguments);
  } else if (word == "trigger") {
    scope_trigger(session, arguments);
  } else if (word == "start") {
    scope_start(session, arguments);
  } else if (word == "stop") {
    hand_over_setup(session, {});
  } else if (word == "dump") {
    scope_dump(session);
  } else {
    session.error("usage", "scope knows signals, channels, trigger, start, stop and dump",
                  "'help' shows their arguments");
  }
}

}  // namespace capstan
