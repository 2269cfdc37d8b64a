// SPDX-License-Identifier: Apache-2.0
// `response` and `tune`: what a log of chirp or multisine says of a joint, and the gains that follow.
#include <iostream>
#include <memory>

#include "capstan/tools/capstan/commands.hpp"
#include "capstan/tools/response/response_report.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

struct TuneOptions {
  std::string log, dump, report;
  std::vector<std::string> maps;
  int axis = 0;
  double bandwidth_hz = 0.0;
};

auto read(const TuneOptions& options) -> Response {
  const CsvLog log = CsvLog::read(options.log, parse_mappings(options.maps));
  for (const auto& warning : log.warnings()) {
    std::cerr << "warning: " << warning << "\n";
  }
  return estimate_response(read_response(log, options.axis));
}

void report(const TuneOptions& options, const Response& response, const std::optional<Tuning>& tuning) {
  if (!options.report.empty()) {
    const std::string page = write_response_report(options.report, response, tuning);
    std::cerr << "wrote " << page << "\n";
  }
}

auto run_response(const TuneOptions& options) -> int {
  const Response response = read(options);
  std::cout << response_text(response);
  report(options, response, {});
  require_usable(response);
  return kExitDone;
}

auto run_tune(const TuneOptions& options) -> int {
  const LoopGains present = options.dump.empty() ? LoopGains{} : read_gains(read_text_file(options.dump), options.axis);
  const Response response = read(options);
  require_usable(response);
  Wanted wanted;
  if (options.bandwidth_hz > 0.0) {
    wanted.bandwidth_hz = options.bandwidth_hz;
  }
  const Tuning tuning = tune(response, present, wanted);
  std::cerr << tuning_text(tuning, present);
  for (const std::string& line : tuning_lines(tuning.gains, options.axis)) {
    std::cout << line << "\n";
  }
  report(options, response, tuning);
  return kExitDone;
}

void add_log(CLI::App& command, TuneOptions& options) {
  command.add_option("log", options.log, "log of 'experiment jointN chirp' or 'multisine on=torque'")->required();
  command.add_option("--map", options.maps, "use a column of another name, as for identify");
  command.add_option("--axis", options.axis, "number of the axis")->check(CLI::Range(0, 99));
  command.add_option("--report", options.report, "folder for a page with Bode, coherence and Nyquist");
}

}  // namespace

void add_response(CLI::App& app, int& exit_status) {
  auto options = std::make_shared<TuneOptions>();
  CLI::App* command = app.add_subcommand(
      "response", "compute the frequency response of a joint with intervals, from a log of a chirp or multisine");
  add_log(*command, *options);
  command->callback([options, &exit_status] { exit_status = run_response(*options); });
}

void add_tune(CLI::App& app, int& exit_status) {
  auto options = std::make_shared<TuneOptions>();
  CLI::App* command = app.add_subcommand(
      "tune",
      "compute gains with stability margins from a frequency-response log; prints lines for the board's prompt");
  add_log(*command, *options);
  command->add_option("--dump", options->dump,
                      "the board's 'dump' when the log was made; without it the firmware's defaults are taken");
  command
      ->add_option("--bandwidth", options->bandwidth_hz,
                   "Hz, crossover of the motor servo; without it the highest that the margins allow")
      ->check(CLI::Range(0.5, 400.0));
  command->callback([options, &exit_status] { exit_status = run_tune(*options); });
}

}  // namespace capstan::tools
