// SPDX-License-Identifier: Apache-2.0
// The shell's command that opens the way to the safety limits. Its arguments are never echoed, kept or printed.
#include "capstan/firmware/console/shell_commands.hpp"

namespace capstan {

void ShellCommands::maintenance(Shell& shell, std::string_view arguments) {
  const std::string_view word = next_word(arguments);
  const std::string_view key = next_word(arguments);
  if (word.empty()) {
    maintenance_status(shell);
  } else if (word == "open") {
    maintenance_open(shell, key);
  } else if (word == "close" && key.empty()) {
    shell.maintenance_.close();
    shell.ok();
  } else if (word == "key" && !key.empty()) {
    maintenance_key(shell, key);
  } else {
    shell.error("usage", "maintenance knows 'open', 'open KEY', 'close', 'key NEWKEY' and 'key none'",
                "alone it says how it stands");
  }
}

void ShellCommands::maintenance_status(Shell& shell) {
  const bool open = shell.maintenance_.is_open(shell.machine_.telemetry().tick);
  shell.out_ << "maintenance " << (open ? "open, closes 10 minutes after it was opened" : "closed") << ", "
             << (shell.machine_.maintenance_key().is_set() ? "a key is set" : "no key is set") << "\r\n";
  shell.ok();
}

void ShellCommands::maintenance_open(Shell& shell, std::string_view key) {
  switch (shell.maintenance_.open(key, shell.machine_.maintenance_key(), shell.machine_.telemetry().tick)) {
    case Maintenance::Attempt::kOpened:
      shell.ok();
      break;
    case Maintenance::Attempt::kWrong:
      shell.error("wrong_key", "this is not the board's maintenance key, and nothing was opened",
                  "wait 3 s and give the right one; a lost key goes with the stored parameters when the board's "
                  "storage is erased");
      break;
    case Maintenance::Attempt::kTooSoon:
      shell.error("too_soon", "a wrong key was given less than 3 s ago, so this one was not looked at",
                  "wait 3 s and give it again");
      break;
  }
}

void ShellCommands::maintenance_key(Shell& shell, std::string_view key) {
  const bool none = key == "none";
  if (!shell.maintenance_.is_open(shell.machine_.telemetry().tick)) {
    shell.error("maintenance", "the key changes only while maintenance is open, and nothing was changed",
                "'maintenance open' first, with the old key if there is one");
  } else if (!none && key.size() < Maintenance::kShortestKey) {
    shell.error("short_key", "a key has 6 characters or more, and nothing was changed", "choose a longer one");
  } else {
    shell.machine_.set_maintenance_key(none ? KeyDigest{} : digest_of(key));
    shell.out_ << "in force now; 'save' keeps it over a restart\r\n";
    shell.ok();
  }
}

}  // namespace capstan
