// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/thesis/thesis.hpp"

#include <unistd.h>

#include <algorithm>
#include <functional>
#include <iostream>
#include <memory>

#include "capstan/tools/capstan/commands.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"
#include "capstan/tools/thesis/detection.hpp"
#include "capstan/tools/thesis/page.hpp"

namespace capstan::tools {
namespace {

struct ThesisOptions {
  std::vector<std::string> tables;
  std::string json, html;
};

struct Maker {
  std::vector<std::string> names;
  std::function<ThesisTable()> make;
};

auto makers() -> std::vector<Maker> {
  return {{{"2.1", "2.2"}, table_2_1_and_2_2},
          {{"2.27"}, table_2_27},
          {{"4.1"}, table_4_1},
          {{"4.1 laws"}, table_4_1_laws},
          {{"5.1"}, table_5_1},
          {{"5.2"}, table_5_2},
          {{"5.3"}, table_5_3},
          {{"6.1"}, table_6_1},
          {{"6.2"}, table_6_2},
          {{"7.1"}, table_7_1},
          {{"7.2"}, table_7_2},
          {{"8.2.3"}, table_8_2_3},
          {{"palpation"}, table_coverage},
          {{"detection"}, table_detection}};
}

auto wanted(const Maker& maker, const std::vector<std::string>& tables) -> bool {
  bool found = tables.empty();
  for (const std::string& name : maker.names) {
    found = found || std::find(tables.begin(), tables.end(), name) != tables.end();
  }
  return found;
}

auto thesis(const ThesisOptions& options) -> int {
  nlohmann::json all = {{"schema", "capstan.thesis/2"}, {"tables", nlohmann::json::array()}};
  std::vector<ThesisTable> tables;
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
    tables.push_back(table);
  }
  if (!options.json.empty()) {
    write_text_file(options.json, all.dump(2) + "\n");
  }
  if (!options.html.empty()) {
    if (progress) {
      std::cerr << "figures ...   \r" << std::flush;
    }
    write_text_file(options.html,
                    thesis_page(tables, options.tables.empty() ? thesis_figures() : std::vector<ThesisFigure>{}));
  }
  return kExitDone;
}

}  // namespace

void add_thesis(CLI::App& app, int& exit_status) {
  auto options = std::make_shared<ThesisOptions>();
  CLI::App* command = app.add_subcommand(
      "thesis", "reproduce the reference thesis's tables on simulated instruments, beside the printed values");
  command->add_option("--table", options->tables, "only this one (repeatable)")
      ->check(CLI::IsMember({"2.1", "2.2", "2.27", "4.1", "4.1 laws", "5.1", "5.2", "5.3", "6.1", "6.2", "7.1", "7.2",
                             "8.2.3", "palpation", "detection"}));
  command->add_option("--json", options->json, "write the tables as JSON (schema capstan.thesis/2)");
  command->add_option("--html", options->html, "write the tables and figures as an HTML page");
  command->footer(
      "F. Anooshahpour, 2017. KM is q2 = beta q1; PM is the thesis's law, (5.28) or, in table 6.2, (6.21); `law` is "
      "PM\n"
      "with pretension_offset and slip_propagation, fitted to the same logs; `control` under `capstan` is the "
      "firmware's\n"
      "with that law. All errors are RMSE of laws that run free, camera noise (0.1 deg) included. An f marks a value "
      "that is\n"
      "fitted to the print; all others are predicted. Below a table stands every difference over 10 %, with the "
      "reason\n"
      "and the experiment that tested it: the suspected cause was changed; the new value is shown. Amplitudes follow "
      "from\n"
      "the printed RMSE / (1 - GoF). Takes three minutes; exit status 0 done, 2 bad input.");
  command->callback([options, &exit_status] { exit_status = thesis(*options); });
}

}  // namespace capstan::tools
