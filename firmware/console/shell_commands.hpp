// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/firmware/console/session.hpp"

namespace capstan {

struct ShellCommand {
  const char* name;
  const char* arguments;
  std::size_t most_words;  ///< after the name; more are refused
  const char* help;
  void (*run)(Session& session, std::string_view arguments);
  /// It gives torque, moves a joint or restarts the board. Noise on the line must not add up to it, so it is taken only
  /// as typed in full: never from the history, by completion, or right behind a damaged line.
  bool acts = false;
};

/// Every command there is; `help` prints from it.
auto shell_commands() -> std::span<const ShellCommand>;

/// The commands' bodies, one topic a file.
namespace commands {
void help(Session& session, std::string_view arguments);
void version(Session& session, std::string_view arguments);
void status(Session& session, std::string_view arguments);
void faults(Session& session, std::string_view arguments);
void get(Session& session, std::string_view arguments);
void set(Session& session, std::string_view arguments);
void list(Session& session, std::string_view arguments);
void dump(Session& session, std::string_view arguments);
void diff(Session& session, std::string_view arguments);
void begin(Session& session, std::string_view arguments);
void commit(Session& session, std::string_view arguments);
void abandon(Session& session, std::string_view arguments);
void defaults(Session& session, std::string_view arguments);
void save(Session& session, std::string_view arguments);
void load(Session& session, std::string_view arguments);
void arm(Session& session, std::string_view arguments);
void disarm(Session& session, std::string_view arguments);
void move(Session& session, std::string_view arguments);
void hold(Session& session, std::string_view arguments);
void zero(Session& session, std::string_view arguments);
void log(Session& session, std::string_view arguments);
void experiment(Session& session, std::string_view arguments);
void commission(Session& session, std::string_view arguments);
/// What a motor at rest answers looks by, of a joint whose other values are known.
void commission_looks(Session& session, std::size_t axis);
void palpate(Session& session, std::string_view arguments);
void frames(Session& session, std::string_view arguments);
void watch(Session& session, std::string_view arguments);
void scope(Session& session, std::string_view arguments);
void model(Session& session, std::string_view arguments);
void maintenance(Session& session, std::string_view arguments);
void timing(Session& session, std::string_view arguments);
void reboot(Session& session, std::string_view arguments);
}  // namespace commands

// What several of them use.

/// The signals of a list. Where one is unknown or one too many, or there is none: false, and nothing is changed.
auto parse_signals(std::string_view words, std::size_t axes, std::array<Signal, kMostSignals>& signals,
                   std::size_t& count) -> bool;
void refuse_signals(Session& session);
/// Refuses words that nothing would read.
auto refuses_more(Session& session, std::string_view rest) -> bool;
/// Of a line's "name=value" words: refuses `word` where `rest`, what follows it, gives the same option again.
auto refuses_repeat(Session& session, std::string_view word, std::string_view rest) -> bool;
/// A whole number in a range.
auto parse_count(std::string_view text, std::int32_t minimum, std::int32_t maximum, std::int32_t& value) -> bool;
/// What `experiment` takes.
auto recipe_names() -> std::span<const char* const>;
/// `help` of a parameter or a group.
void help_parameters(Session& session, std::string_view name);
/// With the joints that show it, where it is a joint's.
void print_fault(Session& session, const char* what, const FaultInfo& entry);
void print_warnings(Print& out, WarningSet warnings);
void print_tendons(Print& out, const AxisTelemetry& joint);
/// Says why a set was refused.
void print_refusal(Session& session, const SetAnswer& answer);
/// What is to be known about what was stored, each line behind `begin`; nothing if all is as it was saved.
void print_load_report(Print& out, const LoadReport& report, const char* begin);
/// A line where the law is not one that is certain.
void print_law_status(Print& out, const AxisConfig& config);

}  // namespace capstan
