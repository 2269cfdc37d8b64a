// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/firmware/console/shell.hpp"

namespace capstan {

struct ShellCommand {
  const char* name;
  const char* arguments;
  std::size_t most_words;  ///< after the name; more are refused
  const char* help;
  void (*run)(Shell& shell, std::string_view arguments);
  /// It gives torque, moves a joint or restarts the board. Noise on the line must not add up to it, so it is taken only
  /// as typed in full: never from the history, by completion, or right behind a damaged line.
  bool acts = false;
};

/// The signals of a list. Where one is unknown or one too many, or there is none: false, and nothing is changed.
auto parse_signals(std::string_view words, std::size_t axes, std::array<Signal, kMostSignals>& signals,
                   std::size_t& count) -> bool;

struct RecipeInfo;
/// What `experiment` takes.
auto recipe_names() -> std::span<const char* const>;

/// Whether an experiment is one that measures a frequency response, by its name and the words behind it.
auto asks_for_response(std::string_view recipe, std::string_view arguments) -> bool;
/// The last signal that the log of such an experiment prints, and no other log.
inline constexpr std::string_view kResponseMark = "excitation";

/// Every command there is; `help` prints from it.
auto shell_commands() -> std::span<const ShellCommand>;

/// The commands' bodies. A struct only so that they may use the shell's private parts.
struct ShellCommands {
  static void help(Shell& shell, std::string_view arguments);
  static void version(Shell& shell, std::string_view arguments);
  static void status(Shell& shell, std::string_view arguments);
  static void faults(Shell& shell, std::string_view arguments);
  static void get(Shell& shell, std::string_view arguments);
  static void set(Shell& shell, std::string_view arguments);
  static void list(Shell& shell, std::string_view arguments);
  static void dump(Shell& shell, std::string_view arguments);
  static void diff(Shell& shell, std::string_view arguments);
  static void begin(Shell& shell, std::string_view arguments);
  static void commit(Shell& shell, std::string_view arguments);
  static void abandon(Shell& shell, std::string_view arguments);
  static void defaults(Shell& shell, std::string_view arguments);
  static void save(Shell& shell, std::string_view arguments);
  static void load(Shell& shell, std::string_view arguments);
  static void arm(Shell& shell, std::string_view arguments);
  static void disarm(Shell& shell, std::string_view arguments);
  static void move(Shell& shell, std::string_view arguments);
  static void hold(Shell& shell, std::string_view arguments);
  static void zero(Shell& shell, std::string_view arguments);
  static void log(Shell& shell, std::string_view arguments);
  static void experiment(Shell& shell, std::string_view arguments);
  static void commission(Shell& shell, std::string_view arguments);
  static void palpate(Shell& shell, std::string_view arguments);
  static void frames(Shell& shell, std::string_view arguments);
  static void watch(Shell& shell, std::string_view arguments);
  static void scope(Shell& shell, std::string_view arguments);
  static void model(Shell& shell, std::string_view arguments);
  static void maintenance(Shell& shell, std::string_view arguments);
  static void timing(Shell& shell, std::string_view arguments);
  static void reboot(Shell& shell, std::string_view arguments);

 private:
  static void replay_lines(Shell& shell, bool changed_only);
  /// Says so where there is no joint. True: nothing may be done.
  static auto refuses_missing(Shell& shell, std::size_t axis) -> bool;
  static void post(Shell& shell, const Request& request, Shell::Activity activity);
  struct MoveRange {
    const char* what;  ///< "joint" or "motor"
    Q24 lowest_rad, highest_rad;
  };
  static auto parse_target(Shell& shell, std::string_view text, const MoveRange& range, Q24& angle_rad) -> bool;
  static auto refuses_mode(Shell& shell, std::size_t axis, ControlMode mode) -> bool;
  static void move_joint(Shell& shell, std::size_t axis, std::string_view target);
  static void move_motor(Shell& shell, std::size_t axis, std::string_view target);
  static void move_force(Shell& shell, std::size_t axis, std::string_view arguments);
  static void maintenance_status(Shell& shell);
  static void maintenance_open(Shell& shell, std::string_view key);
  static void maintenance_key(Shell& shell, std::string_view key);
  static void begin_experiment(Shell& shell, const RecipeInfo& recipe, std::size_t axis, std::string_view arguments);
  static void begin_response(Shell& shell, std::string_view recipe, std::size_t axis, std::string_view arguments);
  /// Begins setup_, which was checked, as recorded_ shows it, or says why not.
  static void start_experiment(Shell& shell, std::uint32_t every);
  static void palpation_map(Shell& shell);
  static void fault_history(Shell& shell);
  static void fault_second(Shell& shell);
  static void help_parameters(Shell& shell, std::string_view name);
  static void scope_status(Shell& shell);
  static void scope_signals(Shell& shell);
  static void scope_channels(Shell& shell, std::string_view arguments);
  static void scope_trigger(Shell& shell, std::string_view arguments);
  static void scope_start(Shell& shell, std::string_view arguments);
  static void scope_dump(Shell& shell);
};

/// A line where the law is not one that is certain.
void print_law_status(Print& out, const AxisConfig& config);

}  // namespace capstan
