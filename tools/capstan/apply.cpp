// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/apply/law_lines.hpp"

#include <algorithm>
#include <iostream>
#include <memory>

#include "capstan/tools/apply/machine_lines.hpp"
#include "capstan/tools/apply/shell_client.hpp"
#include "capstan/tools/capstan/commands.hpp"
#include "capstan/tools/capstan/options.hpp"
#include "capstan/tools/joint_file/effort_file.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/held_stops.hpp"

namespace capstan::tools {
namespace {

struct ApplyOptions {
  std::string model;
  std::string port, key;
  int axis = 0;
  bool axis_given = false;
  bool keep_unsaved = false;
  bool force = false;
};

/// Reads back what a 'set' line asked for.
void verify(ShellClient& shell, const std::string& set_line) {
  const std::string name = set_line.substr(4, set_line.find(' ', 4) - 4);
  const auto answers = shell.ask("get " + name);
  if (std::any_of(answers.begin(), answers.end(), [&](const auto& answer) { return reports(answer, set_line); })) {
    return;
  }
  throw Refusal("the board does not report " + name +
                " as it was set; nothing was saved, so restart it and apply again");
}

/// Of a table with more levels than the board was built for the board knows its range, not what sets that.
void tell_board(ShellClient& shell, const std::string& line) {
  try {
    static_cast<void>(shell.ask(line));
  } catch (const Refusal& refusal) {
    const std::string levels = ".preisach.levels ";
    if (const auto at = line.find(levels); at != std::string::npos) {
      throw Refusal(std::string(refusal.what()) + ". Build its firmware with -DCAPSTAN_PREISACH_LEVELS=" +
                    line.substr(at + levels.size()) + ", or identify with as many --levels as it has");
    }
    throw;
  }
}

/// Takes back what is staged of lines that were not all taken, and closes the maintenance that they opened. A board
/// that no longer answers can not be asked.
void take_back(ShellClient& shell, bool in_maintenance) {
  try {
    static_cast<void>(shell.ask("abandon"));
  } catch (const Refusal&) {
    // What was staged came into force, or the line is gone.
  }
  if (in_maintenance) {
    try {
      static_cast<void>(shell.ask("maintenance close"));
    } catch (const Refusal&) {
      // It ends by itself.
    }
  }
}

/// All lines or none: what is refused, or stopped by Ctrl-C, leaves the board as it was.
void tell_all(ShellClient& shell, const std::vector<std::string>& lines, const std::string& key, HeldStops& stops) {
  bool in_maintenance = false;
  try {
    for (const std::string& line : lines) {
      if (stops.came(std::chrono::milliseconds(0))) {
        throw Refusal("stopped before all was written; the board has what it had before");
      }
      const bool opens = line == "maintenance open";
      in_maintenance |= opens;
      tell_board(shell, opens && !key.empty() ? line + " " + key : line);
    }
  } catch (...) {
    take_back(shell, in_maintenance);
    throw;
  }
}

/// A law of an effort knows the axis of its log, and the board's joint may be another.
void tell_other_axis(const std::string& model, int axis) {
  if (!is_effort_file(model)) {
    return;
  }
  if (const std::string target = read_effort_file(model).target; axis_of_column(target) != axis) {
    warn(model + ": the law is of " + target + ", and goes into joint " + std::to_string(axis) +
         "; --axis N chooses another joint");
  }
}

auto apply(const ApplyOptions& options) -> int {
  const std::vector<std::string> lines = law_lines(options.model, options.axis, options.force);
  if (options.axis_given) {
    expect_axis(lines, options.axis, options.model);
  } else {
    tell_other_axis(options.model, options.axis);
  }
  HeldStops stops;
  ShellClient shell(options.port);
  const auto version = shell.ask("version");
  expect_joints(lines, version);
  tell_all(shell, lines, options.key, stops);
  int verified = 0;
  for (const std::string& line : lines) {
    if (line.starts_with("set ")) {
      verify(shell, line);
      ++verified;
    }
  }
  if (!options.keep_unsaved) {
    shell.ask("save");
  }
  std::cout << (version.empty() ? std::string("board") : version.front()) << "\n  " << verified
            << " parameters set and read back" << (options.keep_unsaved ? ", not saved" : ", saved") << "\n";
  return kExitDone;
}

}  // namespace

void add_apply(CLI::App& app, int& exit_status) {
  auto options = std::make_shared<ApplyOptions>();
  CLI::App* command =
      app.add_subcommand("apply", "write a law or commissioned settings into a running board, verify and save them");
  command
      ->add_option("model", options->model,
                   "the law, a joint.toml; or a machine.toml written by 'capstan commission', which names its joints")
      ->required();
  command->add_option("--port", options->port, "the board's shell: tcp:PORT, or its serial device")->required();
  const CLI::Option* axis = command->add_option("--axis", options->axis, "joint of the board")
                                ->capture_default_str()
                                ->check(CLI::Range(0, 3));
  command->add_option("--key", options->key, "maintenance key, if one is set on the board; needed for a machine.toml");
  command->add_flag("--force", options->force,
                    "write a law even if its joint would move against the motor, or too far");
  command->add_flag("--no-save", options->keep_unsaved, "try the law without saving it");
  command->callback([options, axis, &exit_status] {
    options->axis_given = axis->count() > 0;
    exit_status = apply(*options);
  });
}

}  // namespace capstan::tools
