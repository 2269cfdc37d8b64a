// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/dbc/dbc.hpp"

#include <algorithm>
#include <iostream>
#include <memory>

#include "capstan/boards/stm32f405/can_messages.hpp"
#include "capstan/tools/capstan/commands.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

struct DbcOptions {
  std::vector<int> nodes;
  std::size_t axes = stm32f405::kCanMostAxes;
  std::string output;
};

auto run_dbc(const DbcOptions& options) -> int {
  DbcRequest request{.axes = options.axes, .version = CAPSTAN_VERSION};
  if (!options.nodes.empty()) {
    request.nodes.assign(options.nodes.begin(), options.nodes.end());
  }
  std::sort(request.nodes.begin(), request.nodes.end());
  if (const auto twice = std::adjacent_find(request.nodes.begin(), request.nodes.end()); twice != request.nodes.end()) {
    throw BadInput("node " + std::to_string(*twice) + " is given twice; give each board on a bus its own node number");
  }
  const std::string text = dbc_text(request);
  if (options.output.empty()) {
    std::cout << text;
  } else {
    write_text_file(options.output, text);
    std::cerr << "wrote " << options.output << "\n";
  }
  return kExitDone;
}

}  // namespace

void add_dbc(CLI::App& app, int& exit_status) {
  auto options = std::make_shared<DbcOptions>();
  CLI::App* command =
      app.add_subcommand("dbc", "describe the motor board's CAN frames for other programs, as a DBC file");
  command->add_option("--node", options->nodes, "node of a board on the bus (default 1); repeatable")
      ->allow_extra_args(false)
      ->check(CLI::Range(1, static_cast<int>(stm32f405::kCanLastNode)));
  command->add_option("--axes", options->axes, "number of axes that the boards were built with")
      ->capture_default_str()
      ->check(CLI::Range(std::size_t{1}, stm32f405::kCanMostAxes));
  command->add_option("-o,--output", options->output, "file to write; without it the text is printed");
  command->callback([options, &exit_status] { exit_status = run_dbc(*options); });
}

}  // namespace capstan::tools
