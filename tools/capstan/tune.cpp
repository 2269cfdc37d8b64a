// SPDX-License-Identifier: Apache-2.0
// `response` and `tune`: what a log of chirp or multisine says of a joint, and the gains that follow; `tune` of a board
// records that log, and tries the gains.
#include <filesystem>
#include <iostream>
#include <memory>

#include "capstan/tools/capstan/attended_board.hpp"
#include "capstan/tools/capstan/commands.hpp"
#include "capstan/tools/commission/commission.hpp"
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
  // Of a board only.
  std::string key, state = "tune.txt";
  double corridor_rad = 0.0, inertia_gm2 = 0.0;
  bool yes = false;
};

auto is_port(const std::string& name) -> bool {
  std::error_code ignored;
  return name.starts_with("tcp:") || name.starts_with("/dev/") || std::filesystem::is_character_file(name, ignored);
}

auto wanted_of(const TuneOptions& options) -> Wanted {
  Wanted wanted;
  if (options.bandwidth_hz > 0.0) {
    wanted.bandwidth_hz = options.bandwidth_hz;
  }
  return wanted;
}

auto read(const TuneOptions& options) -> Response {
  const CsvLog log = CsvLog::read(options.log, parse_mappings(options.maps));
  for (const auto& warning : log.warnings()) {
    std::cerr << "warning: " << warning << "\n";
  }
  return estimate_response(read_response(log, options.axis));
}

void report(const TuneOptions& options, const Response& response, const std::optional<Tuning>& tuning) {
  if (!options.report.empty()) {
    const std::string page = write_response_report(options.report, response, tuning, options.axis);
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

void tell(const TuneOptions& options, const Response& response, const Tuning& tuning, const LoopGains& present) {
  std::cerr << tuning_text(tuning, present);
  for (const std::string& line : tuning_lines(tuning.gains, options.axis)) {
    std::cout << line << "\n";
  }
  report(options, response, tuning);
}

auto tune_log(const TuneOptions& options) -> int {
  const LoopGains present = options.dump.empty() ? LoopGains{} : read_gains(read_text_file(options.dump), options.axis);
  const Response response = read(options);
  require_usable(response);
  tell(options, response, tune(response, present, wanted_of(options)), present);
  return kExitDone;
}

/// What a run that could not end itself left to be given back; nothing: none did.
auto interrupted(const std::string& state) -> Progress {
  return std::filesystem::exists(state) ? Progress::parse(read_text_file(state), state) : Progress{};
}

auto tune_board(const TuneOptions& options) -> int {
  const std::string state = with_joint(options.state, options.axis);
  const Operator person{.tell = [](const std::string& text) { std::cerr << text << "\n"; },
                        .agrees = [&options](const std::string& question) { return agrees(options.yes, question); },
                        .keep =
                            [&state](int, const Progress& now) {
                              if (now.before.empty()) {
                                std::filesystem::remove(state);
                              } else {
                                write_text_file(state, now.text());
                              }
                            }};
  CommissionOptions joint{.axis = options.axis,
                          .corridor_rad = options.corridor_rad,
                          .inertia_kgm2 = {},
                          .key = options.key,
                          .wanted = wanted_of(options)};
  if (options.inertia_gm2 > 0.0) {
    joint.inertia_kgm2 = 1e-3 * options.inertia_gm2;
  }
  Progress before = interrupted(state);
  const auto board = open_board(options.log);
  try {
    give_back(*board, person, joint, before);
    const LoopGains present = read_gains(joined(board->ask("dump"), "\n"), options.axis);
    const Commissioned tuned = retune(*board, person, joint);
    tell(options, *tuned.response, *tuned.tuning, present);
  } catch (const Stopped& stopped) {
    throw Refusal(stopped.what());
  }
  return kExitDone;
}

auto add_log(CLI::App& command, TuneOptions& options, const std::string& what) -> CLI::Option* {
  command.add_option("log", options.log, what)->required();
  command.add_option("--axis", options.axis, "number of the axis")->check(CLI::Range(0, 99));
  command.add_option("--report", options.report, "folder for a page with Bode, coherence and Nyquist");
  return command.add_option("--map", options.maps, "use a column of another name, as for identify");
}

/// Options of a log, and those of a board.
struct OnlyOf {
  std::vector<const CLI::Option*> log, board;
};

auto run_tune(const TuneOptions& options, const OnlyOf& only) -> int {
  const bool port = is_port(options.log);
  for (const CLI::Option* option : port ? only.log : only.board) {
    if (option->count() > 0) {
      throw BadInput(option->get_name() +
                     (port ? " is for a log, and " + options.log + " is a board, which is asked itself; leave it out"
                           : " is for a board, and " + options.log +
                                 " is a log; leave it out, or give the board's port, for "
                                 "instance tcp:4000"));
    }
  }
  if (port && options.corridor_rad == 0.0) {
    throw BadInput("a board needs --corridor: how far, in rad, the joint may move either way from where it stands");
  }
  return port ? tune_board(options) : tune_log(options);
}

}  // namespace

void add_response(CLI::App& app, int& exit_status) {
  auto options = std::make_shared<TuneOptions>();
  CLI::App* command = app.add_subcommand(
      "response", "compute the frequency response of a joint with intervals, from a log of a chirp or multisine");
  add_log(*command, *options, "log of 'experiment jointN chirp' or 'multisine on=torque'");
  command->callback([options, &exit_status] { exit_status = run_response(*options); });
}

void add_tune(CLI::App& app, int& exit_status) {
  auto options = std::make_shared<TuneOptions>();
  CLI::App* command = app.add_subcommand(
      "tune",
      "compute gains with stability margins, from a log (prints lines for the board's prompt) or on a board: shakes a "
      "commissioned joint, tries the gains, saves them if the check passes and takes them back if not");
  OnlyOf only;
  only.log.push_back(add_log(*command, *options,
                             "log of 'experiment jointN multisine on=torque'; or the shell of the board to tune: "
                             "tcp:PORT, or its serial device"));
  only.log.push_back(
      command->add_option("--dump", options->dump,
                          "log: the board's 'dump' when it was made; without it the firmware's defaults are taken"));
  command
      ->add_option("--bandwidth", options->bandwidth_hz,
                   "Hz, crossover of the motor servo; without it the highest that the margins allow")
      ->check(CLI::Range(0.5, 400.0));
  only.board = {
      command
          ->add_option("--corridor", options->corridor_rad,
                       "board, required: rad, how far the joint may move either way from where it stands")
          ->check(CLI::Range(0.1, 3.0)),
      command
          ->add_option("--inertia", options->inertia_gm2,
                       "board: g m2 of motor and gear at the input pulley, where observer.inertia is 0")
          ->check(CLI::Range(1e-6, 1e6)),
      command->add_option("--key", options->key, "board: maintenance key, if one is set"),
      command
          ->add_option("--state", options->state,
                       "board: file, with the joint's name put into it, that has the settings of before while they are "
                       "changed; the next run gives them back if this one is killed")
          ->capture_default_str(),
      command->add_flag("--yes", options->yes, "board, for scripts: answer yes to every question")};
  command->callback([options, only, &exit_status] { exit_status = run_tune(*options, only); });
}

}  // namespace capstan::tools
