// SPDX-License-Identifier: Apache-2.0
#if __has_include(<malloc.h>)
#include <malloc.h>
#endif

#include <algorithm>
#include <cstdio>
#include <exception>
#include <iostream>
#include <string>
#include <vector>

#include "capstan/tools/capstan/arguments.hpp"
#include "capstan/tools/capstan/commands.hpp"
#include "capstan/tools/capstan/run_linux_rt.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/nearest.hpp"

namespace {

/// Words as CLI11 takes them: the last first. What stands behind -- of a comparison are the logs of now.
auto backwards(std::vector<std::string> words) -> std::vector<std::string> {
  if (!words.empty() && words.front() == "compare") {
    std::replace(words.begin(), words.end(), std::string("--"), std::string("--now"));
  }
  std::reverse(words.begin(), words.end());
  return words;
}

/// CLI11 would only say of a first word that is no command that a command is missing.
void expect_command(const CLI::App& app, const std::vector<std::string>& words) {
  if (words.empty()) {
    throw capstan::tools::BadInput("no command was given; `capstan --help` lists the commands");
  }
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    names.push_back(command->get_name());
  }
  if (words.front().starts_with('-') || std::find(names.begin(), names.end(), words.front()) != names.end()) {
    return;
  }
  const auto meant = capstan::tools::nearest(words.front(), names);
  throw capstan::tools::BadInput("there is no command '" + words.front() + "'; " +
                                 (meant ? "did you mean '" + *meant + "'? " : std::string()) +
                                 "`capstan --help` lists the commands");
}

/// A diagnosis frees and takes columns of a whole log thousands of times. glibc gives each back to the kernel, which
/// clears its pages anew: a fifth of the time of 600,000 rows. Kept, they cost a tenth more memory at the peak.
void keep_freed_memory() {
#if defined(__GLIBC__)
  constexpr int kMost = 1 << 30;  // bytes
  mallopt(M_MMAP_THRESHOLD, kMost);
  mallopt(M_TRIM_THRESHOLD, kMost);
  mallopt(M_TOP_PAD, 1 << 26);
#endif
}

auto run_command(int argc, char** argv) -> int {
  using namespace capstan::tools;
  int exit_status = kExitDone;
  CLI::App app("Firmware and tools for tendon-driven joints: run, identify, diagnose, correct.", "capstan");
  app.require_subcommand(1);
  app.set_version_flag("--version", "capstan " CAPSTAN_VERSION);
  add_run(app, exit_status);
  add_faults(app, exit_status);
  add_commission(app, exit_status);
  add_apply(app, exit_status);
  add_shell(app, exit_status);
  add_console(app, exit_status);
  add_flash(app, exit_status);
  add_dbc(app, exit_status);
  add_mjcf(app, exit_status);
  add_identify(app, exit_status);
  add_palpate(app, exit_status);
  add_record(app, exit_status);
  add_replay(app, exit_status);
  add_diagnose(app, exit_status);
  add_compare(app, exit_status);
  add_response(app, exit_status);
  add_tune(app, exit_status);
  add_routing(app, exit_status);
  add_tip(app, exit_status);
  add_thesis(app, exit_status);
  app.parse_complete_callback([&app] { expect_sound(*app.get_subcommands().front()); });
  try {
    const std::vector<std::string> words(argv + std::min(argc, 1), argv + argc);
    constexpr std::size_t kOwnWords = 3;
    if (words.size() >= kOwnWords && words[0] == "run" && words[1] == "--board" && words[2] == "linux_rt") {
      run_linux_rt({words.begin() + kOwnWords, words.end()});
    }
    expect_command(app, words);
    app.parse(backwards(words));
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kExitDone : kExitBadInput;
  } catch (const BadInput& error) {
    std::cerr << "capstan: " << error.what() << "\n";
    return kExitBadInput;
  } catch (const Refusal& error) {
    std::cerr << "capstan: " << error.what() << "\n";
    return kExitRefused;
  } catch (const std::exception& error) {
    std::cerr << "capstan: stopped by an internal error: " << error.what() << "; please report it with the command\n";
    return kExitRefused;
  }
  return exit_status;
}

}  // namespace

int main(int argc, char** argv) {
  keep_freed_memory();
  const int exit_status = run_command(argc, argv);
  // A result is not given before all of it is out.
  if (!std::cout.flush() || std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
    std::cerr << "capstan: the result could not be written completely to standard output; free disk space\n";
    return capstan::tools::kExitBadInput;
  }
  return exit_status;
}
