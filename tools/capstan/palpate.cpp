// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <iostream>
#include <memory>

#include "capstan/tools/capstan/commands.hpp"
#include "capstan/tools/capstan/options.hpp"
#include "capstan/tools/identify/force_section.hpp"
#include "capstan/tools/identify/palpation_log.hpp"
#include "capstan/tools/report/palpation_map.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

struct PalpateOptions {
  LogOptions logs;
  std::string model;
  double period_s = 0.0;
  double stiff_factor = kStiffFactor;
  int against = -1;  ///< the other jaw's axis
  std::string against_model;
  std::string output, svg;
};

auto law_of(const std::string& file) -> TensionStateParameters<double> {
  return tension_state_of(read_pull_push(read_text_file(file), file));
}

/// @param said  what the other jaw's axis was warned of
auto read_for_map(const CsvLog& log, int axis, const std::vector<std::string>& said) -> AxisLog {
  AxisLog read = read_palpation_log(log, axis);
  for (const auto& warning : read.warnings) {
    if (std::find(said.begin(), said.end(), warning) == said.end()) {
      warn(warning);
    }
  }
  return read;
}

auto run_palpate(const PalpateOptions& options) -> int {
  refuse_repeats(options.logs.files);
  const TensionStateParameters<double> law = law_of(options.model);
  const auto law_against = options.against < 0 ? TensionStateParameters<double>{} : law_of(options.against_model);
  const auto mappings = parse_mappings(options.logs.maps);
  std::vector<MapRow> rows;
  for (const auto& file : options.logs.files) {
    const CsvLog log = CsvLog::read(file, mappings);
    if (options.period_s == 0.0 && !log.has("site")) {
      warn(file +
           ": without a column 'site' and without --period the whole log is one site; where the tip touched "
           "several, give the seconds at each with --period");
    }
    const auto sites = sites_of(log, options.period_s);
    const AxisLog first = read_for_map(log, options.logs.axis, {});
    const auto more = options.against < 0 ? map_sites(sites, {first, law})
                                          : map_grip(sites, {first, law},
                                                     {read_for_map(log, options.against, first.warnings), law_against});
    rows.insert(rows.end(), more.begin(), more.end());
  }
  std::cout << map_text(rows, options.stiff_factor);
  if (!options.output.empty()) {
    write_text_file(options.output, map_csv(rows));
    std::cerr << "wrote " << options.output << "\n";
  }
  if (!options.svg.empty()) {
    write_text_file(options.svg, svg_of(palpation_map(rows, options.stiff_factor)));
    std::cerr << "wrote " << options.svg << "\n";
  }
  if (std::none_of(rows.begin(), rows.end(), [](const MapRow& row) { return row.stiffness.combined.has_value(); })) {
    throw Refusal("no site was pressed far enough for its stiffness; press with more torque, or record more often");
  }
  return kExitDone;
}

}  // namespace

void add_palpate(CLI::App& app, int& exit_status) {
  auto options = std::make_shared<PalpateOptions>();
  CLI::App* command = app.add_subcommand(
      "palpate", "compute the stiffness of the tissue that the tip touched, site by site, with intervals");
  options->logs.add_to(*command, true);
  command
      ->add_option("--model", options->model,
                   "joint.toml with the force law of the instrument: identify --model pull_push, tip locked")
      ->required();
  command->add_option("--period", options->period_s, "seconds at each site, in a log without a column 'site'")
      ->check(CLI::Range(0.1, 1e4));
  command
      ->add_option("--factor", options->stiff_factor,
                   "times the median from which on a site stands out, its whole interval (1.2)")
      ->check(CLI::Range(1.0, 100.0));
  auto* against = command
                      ->add_option("--against", options->against,
                                   "axis of the other jaw, for what both hold between them while both motors close "
                                   "and open: its stiffness by the angle between the jaws")
                      ->check(CLI::Range(0, 15));
  auto* model = command->add_option("--against-model", options->against_model, "joint.toml of that axis");
  against->needs(model);
  model->needs(against);
  command->add_option("-o,--output", options->output, "CSV of the map to write");
  command->add_option("--svg", options->svg, "picture of the map to write: a bar for each site with its interval");
  command->footer(
      "A site is marked ('*', another colour) if its whole 95 % interval exceeds --factor times the median. What that\n"
      "finds, by the depth and stiffness of an inclusion, and at which false alarms: capstan thesis --table "
      "detection.");
  command->callback([options, &exit_status] { exit_status = run_palpate(*options); });
}

}  // namespace capstan::tools
