// SPDX-License-Identifier: Apache-2.0
#include <iostream>
#include <memory>

#include "capstan/tools/capstan/commands.hpp"
#include "capstan/tools/console_server/serve.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

struct Words {
  ConsoleOptions options;
  std::string scenario;  // a file
};

auto run_console(Words words) -> int {
  if (!words.scenario.empty()) {
    if (!words.options.port.empty()) {
      throw BadInput("--scenario is for the simulator, and a board is given; leave one of them out");
    }
    words.options.scenario = read_text_file(words.scenario);
  }
  serve_console(words.options, [&](const std::string& address, const std::string& foxglove) {
    std::cout << "the console of " << (words.options.port.empty() ? "a simulated joint" : words.options.port)
              << "; Ctrl-C ends it. Open\n"
              << address << std::endl;
    if (!foxglove.empty()) {
      std::cout << "and in Foxglove, as a Foxglove WebSocket,\n" << foxglove << std::endl;
    }
  });
  return kExitDone;
}

}  // namespace

void add_console(CLI::App& app, int& exit_status) {
  auto words = std::make_shared<Words>();
  CLI::App* command = app.add_subcommand(
      "console", "serve the console page to a browser on this machine, for a board or a simulated joint");
  command->add_option("port", words->options.port,
                      "the board's shell: tcp:PORT, its serial device or pseudo-terminal; none: a simulated joint");
  command
      ->add_option("--listen", words->options.listen,
                   "port of the page on 127.0.0.1; without it, or with 0, a free one")
      ->check(CLI::Range(0, 65535));
  command->add_flag("--foxglove", words->options.foxglove, "show the signals by Foxglove's WebSocket protocol too");
  command->add_option("--scenario", words->scenario, "plant, effects and faults of the simulated joint, a TOML file");
  command->add_option("--page", words->options.page,
                      "folder of the page, if it was moved after it was built or installed");
  command->callback([words, &exit_status] { exit_status = run_console(*words); });
}

}  // namespace capstan::tools
