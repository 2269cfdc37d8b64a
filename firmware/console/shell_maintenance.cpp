// SPDX-License-Identifier: Apache-2.0
// The shell's command that opens the way to the safety limits. Its arguments are never echoed, kept or printed.
#include "capstan/firmware/console/shell_commands.hpp"

namespace capstan {

namespace {

void maintenance_status(Session& session) {
  const bool open = session.maintenance().is_open(session.machine().telemetry().tick);
  session.out() << "maintenance " << (open ? "open, closes 10 minutes after it was opened" : "closed") << ", "
                << (session.machine().maintenance_key().is_set() ? "a key is set" : "no key is set") << "\r\n";
  session.ok();
}

void maintenance_open(Session& session, std::string_view key) {
  if (!key.empty() && !session.machine().maintenance_key().is_set()) {
    session.error("usage", "no key is set, and nothing was opened", "'maintenance open' is enough");
    return;
  }
  switch (session.maintenance().open(key, session.machine().maintenance_key(), session.machine().telemetry().tick)) {
    case Maintenance::Attempt::kOpened:
      session.ok();
      break;
    case Maintenance::Attempt::kWrong:
      session.error("wrong_key", "this is not the board's maintenance key, and nothing was opened",
                    "wait 3 s and give the right one; a lost key goes with the stored parameters when the board's "
                    "storage is erased");
      break;
    case Maintenance::Attempt::kTooSoon:
      session.error("too_soon", "a wrong key was given less than 3 s ago, so this one was not checked",
                    "wait 3 s and give it again");
      break;
  }
}

void maintenance_key(Session& session, std::string_view key) {
  const bool none = key == "none";
  if (!session.maintenance().is_open(session.machine().telemetry().tick)) {
    session.error("maintenance", "the key changes only while maintenance is open, and nothing was changed",
                  "'maintenance open' first, with the old key if there is one");
  } else if (!none && key.size() < Maintenance::kShortestKey) {
    session.error("short_key", "a key has 6 characters or more, and nothing was changed", "choose a longer one");
  } else {
    session.machine().set_maintenance_key(none ? KeyDigest{} : digest_of(key));
    session.out() << "in force now; 'save' keeps it over a restart\r\n";
    session.ok();
  }
}

}  // namespace

void commands::maintenance(Session& session, std::string_view arguments) {
  const std::string_view word = next_word(arguments);
  const std::string_view key = next_word(arguments);
  if (word.empty()) {
    maintenance_status(session);
  } else if (word == "open") {
    maintenance_open(session, key);
  } else if (word == "close" && key.empty()) {
    session.maintenance().close();
    session.ok();
  } else if (word == "key" && !key.empty()) {
    maintenance_key(session, key);
  } else {
    session.error("usage", "maintenance knows 'open', 'open KEY', 'close', 'key NEWKEY' and 'key none'",
                  "without arguments it shows its status");
  }
}

}  // namespace capstan
