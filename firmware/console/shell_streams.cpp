// SPDX-License-Identifier: Apache-2.0
// The shell's commands that show signals over time: watch, scope.
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

constexpr const char* kUnknownSignal = "a signal is unknown, or there are more than 8, and nothing was changed";
constexpr const char* kSignalCure = "'scope signals' shows all of them; write 'joint0.q2'";
constexpr std::int32_t kMostEvery = 1000;

}  // namespace

auto parse_signals(std::string_view words, std::size_t axes, std::array<Signal, ScopeSetup::kMostChannels>& signals,
                   std::size_t& count) -> bool {
  std::array<Signal, ScopeSetup::kMostChannels> all{};
  std::size_t found = 0;
  for (std::string_view word = next_word(words); !word.empty(); word = next_word(words)) {
    const Signal signal = find_signal(word, axes);
    if (signal.info == nullptr || found == all.size()) {
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

void Shell::end_stream() {
  if (activity_ == Activity::kLogging || activity_ == Activity::kExperimenting ||
      activity_ == Activity::kCommissioning) {
    log_left_ = 0;  // the next poll answers
  } else if (activity_ == Activity::kDumping) {
    dump_next_ = machine_.scope().size();
  } else if (activity_ == Activity::kDumpingFaults) {
    dump_next_ = FaultLog::kSamples + 1;  // beyond the last: it stays kept
  } else if (activity_ == Activity::kWatching) {
    ok();
  }
}

void ShellCommands::watch(Shell& shell, std::string_view arguments) {
  constexpr std::int32_t kUsualEvery = 200;
  constexpr std::int32_t kLeastEvery = 20;
  constexpr std::int32_t kMostWatchEvery = 60'000;
  std::string_view rest = arguments;
  std::int32_t every = kUsualEvery;
  if (parse_integer(next_word(rest), every) == ParseResult::kOk) {
    arguments = rest;
    if (every < kLeastEvery || every > kMostWatchEvery) {
      shell.error("range", "watch prints every 20 to 60000 ms", "write 'watch 200 joint0.q2'");
      return;
    }
  } else {
    every = kUsualEvery;
  }
  if (!parse_signals(arguments, shell.machine_.axes(), shell.watched_, shell.watched_count_)) {
    shell.error("unknown_signal", kUnknownSignal, kSignalCure);
    return;
  }
  shell.watch_every_ = static_cast<std::uint32_t>(every);
  shell.watch_last_ = shell.machine_.telemetry().tick - shell.watch_every_;
  shell.activity_ = Shell::Activity::kWatching;
}

void Shell::go_on_watching() {
  const MachineTelemetry now = machine_.telemetry();
  if (now.tick - watch_last_ < watch_every_) {
    return;
  }
  watch_last_ = now.tick;
  std::array<AxisTelemetry, kMaxAxes> joints{};
  for (std::size_t axis = 0; axis < machine_.axes(); ++axis) {
    joints[axis] = machine_.axis_telemetry(axis);
  }
  for (std::size_t i = 0; i < watched_count_; ++i) {
    const Signal& signal = watched_[i];
    out_ << (i == 0 ? "" : "  ");
    print_name(out_, signal);
    out_ << ' ';
    print_raw(out_, signal, rt_raw(signal, now, joints));
    if (std::string_view(signal.info->unit) != "1") {
      out_ << ' ' << signal.info->unit;
    }
  }
  out_ << "\r\n";
}

void ShellCommands::scope(Shell& shell, std::string_view arguments) {
  const std::string_view word = next_word(arguments);
  if (word.empty()) {
    scope_status(shell);
  } else if (word == "signals") {
    scope_signals(shell);
  } else if (word == "channels") {
    scope_channels(shell, arguments);
  } else if (word == "trigger") {
    scope_trigger(shell, arguments);
  } else if (word == "start") {
    scope_start(shell, arguments);
  } else if (word == "stop") {
    if (shell.machine_.scope().start({})) {
      shell.activity_ = Shell::Activity::kApplying;
    } else {
      shell.error("busy", "the cycle has not taken the last request yet", "send the line again");
    }
  } else if (word == "dump") {
    scope_dump(shell);
  } else {
    shell.error("usage", "scope knows signals, channels, trigger, start, stop and dump",
                "'help' shows their arguments");
  }
}

void ShellCommands::scope_status(Shell& shell) {
  static constexpr std::array<const char*, 4> kPhases = {"idle", "waiting for its trigger", "triggered and filling",
                                                         "done, ready to dump"};
  Print& out = shell.out_;
  out << "scope " << kPhases[static_cast<std::size_t>(shell.machine_.scope().phase())] << "\r\nchannels";
  for (std::size_t i = 0; i < shell.scope_.channel_count; ++i) {
    out << ' ';
    print_name(out, shell.scope_.channels[i]);
  }
  out << (shell.scope_.channel_count == 0 ? " none" : "") << "\r\ntrigger ";
  const ScopeTrigger trigger = shell.scope_.trigger;
  if (trigger != ScopeTrigger::kNow && trigger != ScopeTrigger::kFault) {
    print_name(out, shell.scope_.trigger_signal);
    out << ' ';
  }
  out << kTriggers[static_cast<std::size_t>(trigger)].name;
  if (trigger != ScopeTrigger::kNow && trigger != ScopeTrigger::kFault) {
    out << ' ';
    print_raw(out, shell.scope_.trigger_signal, shell.scope_.level);
    out << ' ' << shell.scope_.trigger_signal.info->unit;
  }
  out << "\r\n";
  shell.ok();
}

void ShellCommands::scope_signals(Shell& shell) {
  const auto print = [&shell](const Signal& signal) {
    print_name(shell.out_, signal);
    shell.out_ << ' ' << signal.info->unit << ' ' << signal.info->doc << "\r\n";
  };
  for (std::size_t axis = 0; axis < shell.machine_.axes(); ++axis) {
    for (const SignalInfo& info : joint_signals()) {
      print({&info, static_cast<std::uint8_t>(axis)});
    }
  }
  for (const SignalInfo& info : machine_signals()) {
    print({&info});
  }
  shell.ok();
}

void ShellCommands::scope_channels(Shell& shell, std::string_view arguments) {
  if (parse_signals(arguments, shell.machine_.axes(), shell.scope_.channels, shell.scope_.channel_count)) {
    shell.ok();
  } else {
    shell.error("unknown_signal", kUnknownSignal, kSignalCure);
  }
}

void ShellCommands::scope_trigger(Shell& shell, std::string_view arguments) {
  constexpr const char* kCure =
      "write 'scope trigger now', 'scope trigger fault' or 'scope trigger joint0.q2 rising 0.1 rad' (rising, falling, "
      "above, below)";
  std::string_view word = next_word(arguments);
  Signal signal;
  const TriggerName* trigger = trigger_named(word);
  const bool alone = trigger != nullptr && trigger->trigger <= ScopeTrigger::kFault;
  if (!alone) {
    signal = find_signal(word, shell.machine_.axes());
    if (signal.info == nullptr) {
      shell.error("unknown_signal", "there is no such signal or trigger, and nothing was changed", kCure);
      return;
    }
    trigger = trigger_named(next_word(arguments));
    if (trigger == nullptr || trigger->trigger <= ScopeTrigger::kFault) {
      shell.error("usage", "a trigger on a signal says which way, and nothing was changed", kCure);
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
      shell.error("not_a_level", "the level is not a number of the signal's unit and range, and nothing was changed",
                  kCure);
      return;
    }
    level = signal.info->type == SignalType::kReal ? value.raw() : level;
  } else if (!next_word(arguments).empty()) {
    shell.error("usage", "this trigger takes nothing else, and nothing was changed", kCure);
    return;
  }
  shell.scope_.trigger = trigger->trigger;
  shell.scope_.trigger_signal = signal;
  shell.scope_.level = level;
  shell.ok();
}

void ShellCommands::scope_start(Shell& shell, std::string_view arguments) {
  if (shell.scope_.channel_count == 0) {
    shell.error("no_channels", "the scope does not know what to record", "'scope channels joint0.q2' first");
    return;
  }
  const auto room = static_cast<std::int32_t>(Scope::kWords / shell.scope_.channel_count);
  std::int32_t samples = std::min<std::int32_t>(room, 1000);
  std::int32_t every = 1;
  const bool counted = optional_number(next_word(arguments), 2, room, samples);
  std::int32_t before = samples / 4;
  if (!counted || !optional_number(next_word(arguments), 0, samples - 1, before) ||
      !optional_number(next_word(arguments), 1, kMostEvery, every) || !next_word(arguments).empty()) {
    shell.out_ << "error range: with these channels scope takes 2 to " << room
               << " samples, of these fewer than all before the trigger, and one every 1 to 1000 ms; write "
                  "'scope start 1000 250 1'\r\n";
    shell.prompt();
    return;
  }
  shell.scope_.samples = static_cast<std::size_t>(samples);
  shell.scope_.before = static_cast<std::size_t>(before);
  shell.scope_.every = static_cast<std::uint32_t>(every);
  if (shell.machine_.scope().start(shell.scope_)) {
    shell.activity_ = Shell::Activity::kApplying;
  } else {
    shell.error("busy", "the cycle has not taken the last request yet", "send the line again");
  }
}

void ShellCommands::scope_dump(Shell& shell) {
  const Scope& scope = shell.machine_.scope();
  if (scope.phase() != Scope::Phase::kDone) {
    shell.error("nothing_captured", "there is no finished capture",
                "'scope start', then look at 'scope' until it is done");
    return;
  }
  shell.out_ << "# trigger in cycle " << scope.trigger_tick() << ", " << scope.dropped()
             << " cycles dropped while it ran\r\ntime_s";
  for (std::size_t i = 0; i < scope.setup().channel_count; ++i) {
    shell.out_ << ',';
    print_column(shell.out_, scope.setup().channels[i]);
  }
  shell.out_ << "\r\n";
  shell.dump_next_ = 0;
  shell.activity_ = Shell::Activity::kDumping;
}

void Shell::go_on_dumping() {
  constexpr std::size_t kLinesAtOnce = 4;
  const Scope& scope = machine_.scope();
  const std::size_t end = std::min(scope.size(), dump_next_ + kLinesAtOnce);
  for (; dump_next_ < end; ++dump_next_) {
    const std::int32_t cycles = scope.cycles_from_trigger(dump_next_);
    out_ << (cycles < 0 ? "-" : "");
    print_seconds(out_, static_cast<std::uint32_t>(cycles < 0 ? -cycles : cycles));
    for (std::size_t i = 0; i < scope.setup().channel_count; ++i) {
      out_ << ',';
      print_raw(out_, scope.setup().channels[i], scope.raw(dump_next_, i));
    }
    out_ << "\r\n";
  }
  if (dump_next_ == scope.size()) {
    ok();
  }
}

}  // namespace capstan
