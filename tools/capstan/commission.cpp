// SPDX-License-Identifier: Apache-2.0
// `commission`: from a bare motor to a tuned joint, on a board or on a simulated one.
#include <csignal>
#include <filesystem>
#include <iostream>
#include <memory>

#include "capstan/tools/capstan/commands.hpp"
#include "capstan/tools/commission/commission.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

struct CommandOptions {
  CommissionOptions own;
  std::string port, state = "commission.txt", report, machine = "machine.toml";
  double inertia_gm2 = 0.0;
  std::uint64_t seed = 1;
  bool yes = false, again = false;
};

volatile std::sig_atomic_t stop_asked = 0;

auto agrees(const CommandOptions& options, const std::string& question) -> bool {
  if (options.yes) {
    return true;
  }
  std::cerr << "  " << question << " [y/N] " << std::flush;
  std::string answer;
  return std::getline(std::cin, answer) && (answer == "y" || answer == "yes");
}

auto progress_of(const CommandOptions& options) -> Progress {
  if (options.again || !std::filesystem::exists(options.state)) {
    return {};
  }
  return Progress::parse(read_text_file(options.state), options.state);
}

auto run_commission(CommandOptions& options) -> int {
  if (options.inertia_gm2 > 0.0) {
    options.own.inertia_kgm2 = 1e-3 * options.inertia_gm2;
  }
  Progress progress = progress_of(options);
  std::unique_ptr<BoardShell> line;
  if (options.port.empty()) {
    std::cerr << "no port: this is the simulated forceps\n";
    sim::Scenario scenario;
    scenario.seed = options.seed;
    line = std::make_unique<SimShell>(scenario);
  } else {
    struct sigaction stop {};
    // What waits for the board ends, torque goes off and is not given again, and parameters go back.
    stop.sa_handler = [](int) { stop_asked = 1; };
    static_cast<void>(::sigaction(SIGINT, &stop, nullptr));
    line = std::make_unique<PortShell>(options.port);
    line->stop_by(stop_asked);
  }
  const Operator person{.tell = [](const std::string& text) { std::cerr << text << "\n"; },
                        .agrees = [&options](const std::string& question) { return agrees(options, question); },
                        .keep = [&options](const Progress& now) { write_text_file(options.state, now.text()); }};
  const Commissioned commissioned = commission(*line, person, options.own, std::move(progress));
  write_text_file(options.machine, machine_file(commissioned.progress, options.own.axis));
  std::cerr << "wrote " << options.machine << "\n";
  if (!options.report.empty()) {
    std::cerr << "wrote " << write_commission_report(options.report, commissioned) << "\n";
  }
  return kExitDone;
}

}  // namespace

void add_commission(CLI::App& app, int& exit_status) {
  auto options = std::make_shared<CommandOptions>();
  CLI::App* command = app.add_subcommand("commission", "from a bare motor to a tuned joint, step by step");
  command->add_option("port", options->port,
                      "the board's shell: tcp:PORT, or its serial device; without it the simulated forceps");
  command->add_option("--axis", options->own.axis, "joint of the board")->check(CLI::Range(0, 3));
  command
      ->add_option("--corridor", options->own.corridor_rad,
                   "rad: how far the joint may go either way from where it stands")
      ->required()
      ->check(CLI::Range(0.1, 3.0));
  command
      ->add_option("--inertia", options->inertia_gm2,
                   "g m2 of motor and gear at the input pulley by the data sheet; without it wrong counts are not seen")
      ->check(CLI::Range(1e-6, 1e6));
  command->add_option("--key", options->own.key, "of maintenance, where the board has one");
  command->add_option("--state", options->state, "file that remembers what is done")->capture_default_str();
  command->add_flag("--again", options->again, "begin anew, whatever the file says");
  command->add_option("--report", options->report, "folder for the page");
  command->add_option("--machine", options->machine, "file for what sets up the next board alike")
      ->capture_default_str();
  command->add_option("--seed", options->seed, "of the simulated forceps");
  command->add_flag("--yes", options->yes, "for scripts: ask nothing");
  command->callback([options, &exit_status] { exit_status = run_commission(*options); });
}

}  // namespace capstan::tools
