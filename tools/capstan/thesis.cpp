// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/thesis/thesis.hpp"

#include <unistd.h>

#include <fstream>
#include <functional>
#include <iostream>
#include <memory>

#include "capstan/tools/capstan/commands.hpp"
#include "capstan/tools/support/errors.hpp"

namespace capstan::tools {
namespace {

struct ThesisOptions {
  std::vector<std::string> tables;
  std::string json;
};

struct Maker {
  std::vector<std::string> names;
  std::function<ThesisTable()> make;
};

auto makers() -> std::vector<Maker> {
  return {{{"2.1", "2.2"}, table_2_1_and_2_2},
          {{"5.2"}, table_5_2},
          {{"5.3"}, table_5_3},
          {{"6.2"}, table_6_2},
          {{"7.2"}, table_7_2}};
}

auto wanted(const Maker& maker, const std::vector<std::string>& tables) -> bool {
  bool found = tables.empty();
  for (const std::string& name : maker.names) {
    found = found || std::find(tables.begin(), tables.end(), name) != tables.end();
  }
  return found;
}

auto thesis(const ThesisOptions& options) -> int {
  nlohmann::json all = {{"schema", "capstan.thesis/1"}, {"tables", nlohmann::json::array()}};
  const bool progress = ::isatty(STDERR_FILENO) == 1;
  for (const Maker& maker : makers()) {
    if (!wanted(maker, options.tables)) {
      continue;
    }
    if (progress) {
      std::cerr << "table " << maker.names.front() << " ...\r" << std::flush;
    }
    const ThesisTable table = maker.make();
    std::cout << table_text(table) << "\n" << std::flush;
    all["tables"].push_back(table_json(table));
  }
  if (!options.json.empty()) {
    std::ofstream file(options.json);
    file << all.dump(2) << "\n";
    if (!file) {
      throw BadInput(options.json + ": the file can not be written; give a path in a folder that exists");
    }
  }
  return kExitDone;
}

}  // namespace

void add_thesis(CLI::App& app, int& exit_status) {
  auto options = std::make_shared<ThesisOptions>();
  CLI::App* command =
      app.add_subcommand("thesis", "the reference thesis's tables on the simulated instruments, beside the printed");
  command->add_option("--table", options->tables, "only this one (repeatable)")
      ->check(CLI::IsMember({"2.1", "2.2", "5.2", "5.3", "6.2", "7.2"}));
  command->add_option("--json", options->json, "file for the same as JSON (schema capstan.thesis/1)");
  command->footer(
      "F. Anooshahpour, 2017. KM is q2 = beta q1; PM is the thesis's law, (5.28) or, in table 6.2, (6.21); `law` is "
      "PM\n"
      "with pretension_offset and slip_propagation, fitted to the same logs; `control` under `capstan` is the "
      "firmware's\n"
      "with that law. All errors are RMSE of laws that run free, camera noise (0.1 deg) included. The instruments are\n"
      "those of scenario files, nothing of them is fitted to a table; `late camera` and `half friction` repeat the\n"
      "experiment with the suspected cause of the difference. Amplitudes that the thesis does not print follow from "
      "its\n"
      "RMSE / (1 - GoF) where it gives both. Takes a minute; exit status 0 done, 2 bad input.");
  command->callback([options, &exit_status] { exit_status = thesis(*options); });
}

}  // namespace capstan::tools
