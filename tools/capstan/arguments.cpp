// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/capstan/arguments.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "capstan/tools/joint_file/effort_file.hpp"
#include "capstan/tools/log/column_map.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/named_files.hpp"

namespace capstan::tools {
namespace {

/// The options that write a file or, for a report, a folder; every other word that names a file is of one that is read.
auto writes(const CLI::Option& option) -> bool {
  constexpr std::array kWriters = {"output", "json",    "next",   "svg",     "html",  "log",
                                   "state",  "machine", "record", "storage", "report"};
  return std::any_of(kWriters.begin(), kWriters.end(), [&](const char* name) { return option.check_lname(name); });
}

/// What the frames of a board are written to may be MCAP; nothing else is, whatever its name.
void expect_no_mcap(const CLI::App& command, const NamedFile& file) {
  const bool by_frames = command.get_name() == "record" || file.option == "--record";
  if (!by_frames && file.path.ends_with(".mcap")) {
    throw BadInput(file.option + ": " + file.path + " would be named like MCAP, which 'capstan " + command.get_name() +
                   "' does not write; give it another ending, for a log .csv");
  }
}

/// Ranges let nan through, as it is neither below nor above.
void expect_finite(const CLI::App& command, const CLI::Option& option) {
  for (const std::string& word : option.results()) {
    if (!std::isfinite(std::strtod(word.c_str(), nullptr))) {
      throw BadInput(option.get_name() + ": " + word + " is no finite number; give one, as in 'capstan " +
                     command.get_name() + " --help'");
    }
  }
}

/// CLI11 wraps -1 around and cuts what is too large.
void expect_count(const CLI::Option& option) {
  for (const std::string& word : option.results()) {
    errno = 0;
    static_cast<void>(std::strtoull(word.c_str(), nullptr, 0));
    if (errno == ERANGE || word.find('-') != std::string::npos) {
      throw BadInput(option.get_name() + ": " + word + " is out of range; give a whole number from 0 to " +
                     std::to_string(std::numeric_limits<std::uint64_t>::max()));
    }
  }
}

/// The words that the command was given for an option of this name; none where it has no such option.
auto words_of(const CLI::App& command, const char* name) -> std::vector<std::string> {
  const CLI::Option* option = command.get_option_no_throw(name);
  return option == nullptr ? std::vector<std::string>{} : option->results();
}

/// A target may be any column; a law of an effort that is replayed says itself what it explains, and of which axis is
/// asked for then.
void expect_maps_read(const CLI::App& command) {
  const auto mappings = parse_mappings(words_of(command, "--map"));
  std::vector<std::string> targets = words_of(command, "--target");
  const auto models = words_of(command, "--model");
  if (command.get_name() == "replay" && !mappings.empty() && is_effort_file(models.front())) {
    const std::string target = read_effort_file(models.front()).target;
    const std::string quantity = "/" + target.substr(target.find('/') + 1);
    for (const auto& mapping : mappings) {
      if (mapping.wanted.ends_with(quantity)) {
        targets.push_back(mapping.wanted);
      }
    }
  }
  expect_read(mappings, targets);
}

}  // namespace

void expect_sound(const CLI::App& command) {
  std::vector<NamedFile> read;
  std::vector<NamedFile> written;
  for (const CLI::Option* option : command.get_options()) {
    const std::string type = option->get_type_name();
    if (type.starts_with("FLOAT")) {
      expect_finite(command, *option);
    } else if (type.starts_with("UINT")) {
      expect_count(*option);
    } else if (type.starts_with("TEXT")) {
      const bool given = option->count() > 0;
      for (const std::string& word : given ? option->results() : std::vector{option->get_default_str()}) {
        if (!word.empty()) {
          (writes(*option) ? written : read).push_back({option->get_name(), word, option->check_lname("report")});
        }
      }
    }
  }
  std::for_each(written.begin(), written.end(), [&](const auto& file) { expect_no_mcap(command, file); });
  expect_sound_files(read, written);
  expect_maps_read(command);
}

}  // namespace capstan::tools
