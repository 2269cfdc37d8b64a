// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/run/run.hpp"

#include <chrono>
#include <iostream>
#include <memory>
#include <optional>
#include <thread>

#include "capstan/boards/common/file_banks.hpp"
#include "capstan/boards/common/retained_memory.hpp"
#include "capstan/boards/common/shell_feed.hpp"
#include "capstan/tools/apply/law_lines.hpp"
#include "capstan/tools/capstan/commands.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/pending_file.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

struct RunOptions {
  std::string board = "sim";
  std::string scenario;
  std::vector<std::string> models;
  std::string log;
  std::string shell;
  std::string storage;
  std::vector<std::string> plant_effects;
  std::vector<std::string> faults;
  std::optional<double> seconds;
  std::optional<std::uint64_t> seed;
  bool fast = false;
};

constexpr double kDegrees = 57.29577951308232;
/// How long a board that goes as fast as it can waits for a reader that does not keep up.
constexpr std::chrono::seconds kReaderPatience{1};

auto scenario_of(const RunOptions& options) -> sim::Scenario {
  try {
    sim::Scenario scenario = options.scenario.empty() ? sim::Scenario{} : sim::load_scenario(options.scenario);
    for (const std::string& effect : options.plant_effects) {
      sim::override_effect(scenario, effect);
    }
    for (const std::string& fault : options.faults) {
      scenario.faults.push_back(sim::parse_fault(fault));
      if (scenario.faults.back().axis > static_cast<int>(scenario.other_axes.size())) {
        throw BadInput("--fault \"" + fault + "\": the instrument has no such axis; correct its number");
      }
    }
    if (options.seconds) {
      scenario.duration_s = *options.seconds;
    }
    if (options.seed) {
      scenario.seed = *options.seed;
    }
    return scenario;
  } catch (const sim::ScenarioError& error) {
    throw BadInput(error.what());
  }
}

/// The firmware and a person: the plant runs, the shell is attached, and the operator moves the joint.
/// True if the operator wants it to start anew.
auto serve(SimBoard& board, Console& console, const RunOptions& options, RetainedMemory& retained) -> bool {
  ShellFeed feed(console, board.shell());
  const auto start = std::chrono::steady_clock::now();
  for (std::int64_t cycle = 0; !feed.done(); ++cycle) {
    if (options.seconds && static_cast<double>(cycle) >= *options.seconds * kCycleRateHz) {
      return false;
    }
    if (board.reboot_wanted()) {
      return true;
    }
    board.tick();
    if (feed.poll()) {
      board.link_lost();
    }
    if (const std::string problem = retained.keep(energised(board.machine().telemetry().state)); !problem.empty()) {
      std::cerr << problem << "\n";
    }
    if (!options.fast) {
      const auto edge = start + std::chrono::milliseconds(cycle + 1);
      std::this_thread::sleep_until(edge);
      board.set_lateness(std::chrono::steady_clock::now() - edge);
    } else {
      console.drain(kReaderPatience);  // this board's time stands still for its reader, so that no row is lost
    }
  }
  return false;
}

auto run_interactive(const sim::Scenario& scenario, Banks& banks, const RunOptions& options) -> int {
  try {
    Console console = Console::open(options.shell);
    if (console.name() != "stdio") {
      std::cerr << "shell at " << console.name() << "\n";
    }
    const std::size_t words = FaultLog::words_for(1 + scenario.other_axes.size());
    const auto retained = options.storage.empty()
                              ? std::make_unique<RetainedMemory>(words)
                              : std::make_unique<RetainedMemory>(options.storage + ".faults", words);
    if (!retained->remark().empty()) {
      std::cerr << retained->remark() << "\n";
    }
    bool again = true;
    while (again) {
      SimBoard board(scenario, banks, console, console.is_terminal(), retained->words());
      again = serve(board, console, options, *retained);
    }
    return kExitDone;
  } catch (const std::runtime_error& error) {
    throw BadInput(error.what());
  }
}

void print_errors(const sim::Scenario& scenario, const RunSummary& summary) {
  const auto axes = axes_of(scenario);
  for (std::size_t i = 0; i < summary.joints.size(); ++i) {
    if (axes.size() > 1) {
      std::printf("axis%zu, %s\n", i, axes[i].name.c_str());
    }
    if (!on_bench(scenario)) {
      std::printf("  tracking error (RMSE)    %8.3f deg\n", summary.joints[i].tracking_rmse_rad * kDegrees);
    }
    std::printf("  estimation error (RMSE)  %8.3f deg\n", summary.joints[i].estimation_rmse_rad * kDegrees);
  }
}

auto run_scripted(const sim::Scenario& scenario, Banks& banks, const RunOptions& options) -> int {
  if (scenario.duration_s <= 0.0) {
    throw BadInput("there is no motion to run; give --scenario FILE, or --shell stdio to move the joint yourself");
  }
  if (options.models.size() > 1 + scenario.other_axes.size()) {
    throw BadInput("there are more models than axes in the scenario; give --model once for each axis at most");
  }
  std::vector<std::string> model;
  for (std::size_t axis = 0; axis < options.models.size(); ++axis) {
    // Also an implausible law: what it does is seen here without harm.
    const auto lines = law_lines(options.models[axis], static_cast<int>(axis), true);
    model.insert(model.end(), lines.begin(), lines.end());
  }
  std::ofstream log;
  std::optional<PendingFile> pending;
  if (!options.log.empty()) {
    expect_writable(options.log);
    log = open_to_write(pending.emplace(options.log).name());
  }
  const auto begin = std::chrono::steady_clock::now();
  const RunSummary summary = run_scenario(scenario, model, banks, options.log.empty() ? nullptr : &log);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  std::printf("ran %.1f s of the joint in %.1f s\n", summary.seconds, took.count());
  print_errors(scenario, summary);
  if (!options.log.empty()) {
    finish_writing(log, options.log);
    pending->keep();
    std::printf("  log written to %s\n", options.log.c_str());
  }
  if (!summary.fault.empty()) {
    throw Refusal("the run ended early by " + summary.fault);
  }
  return kExitDone;
}

auto banks_of(const RunOptions& options) -> FileBanks {
  try {
    return options.storage.empty() ? FileBanks::temporary() : FileBanks(options.storage);
  } catch (const std::runtime_error& error) {
    throw BadInput(error.what());
  }
}

/// An option that has no effect beside another one would pass for done.
void refuse_beside(const CLI::Option& one, const CLI::Option& other, const std::string& cure) {
  if (one.count() > 0 && other.count() > 0) {
    throw BadInput(other.get_name() + " has no effect with " + one.get_name() + "; " + cure);
  }
}

auto run(const RunOptions& options) -> int {
  if (options.board != "sim") {
    throw BadInput(
        "--board linux_rt takes all arguments that follow it; write it first: capstan run --board linux_rt ...");
  }
  const sim::Scenario scenario = scenario_of(options);
  FileBanks banks = banks_of(options);
  return options.shell.empty() ? run_scripted(scenario, banks, options) : run_interactive(scenario, banks, options);
}

}  // namespace

void add_run(CLI::App& app, int& exit_status) {
  auto options = std::make_shared<RunOptions>();
  CLI::App* command = app.add_subcommand("run", "run the firmware on the simulated joint");
  command->add_option("--scenario", options->scenario, "plant, effects, faults and motion, a TOML file");
  const CLI::Option* model = command->add_option(
      "--model", options->models,
      "laws to load before the motion, of motion and of force, a joint.toml (repeatable: for the first axis, the "
      "next, ...)");
  command->add_option("--for", options->seconds, "seconds to run instead of the scenario's")
      ->check(CLI::Range(0.001, 1e6));
  const CLI::Option* log = command->add_option("--log", options->log, "CSV log to write");
  const CLI::Option* shell =
      command->add_option("--shell", options->shell,
                          "attach the firmware's shell: stdio, pty or tcp:PORT; its commands then move the joint");
  command->add_option("--plant-effect", options->plant_effects,
                      "give the plant an effect, for instance play=0.03 (repeatable)");
  command->add_option("--fault", options->faults,
                      "inject a fault, for instance \"encoder stuck at 3 for 0.5\": target, kind, then any of at, "
                      "for, amount, axis (repeatable)");
  command->add_option("--seed", options->seed, "seed of the plant's noise");
  command->add_option("--storage", options->storage,
                      "file in which 'save' stores the parameters; FILE.faults beside it holds the fault log");
  command->add_flag("--fast", options->fast, "with --shell: as fast as it goes instead of real time");
  command
      ->add_option("--board", options->board,
                   "sim, or, as the first word, linux_rt: the real-time program of this machine, which takes all "
                   "arguments that follow (capstan run --board linux_rt --help)")
      ->check(CLI::IsMember({"sim", "linux_rt"}));
  command->callback([options, &exit_status, model, log, shell] {
    refuse_beside(*shell, *model, "write the law into the running board with 'capstan apply LAW --port PORT'");
    refuse_beside(*shell, *log, "record the running board with 'capstan record PORT -o LOG'");
    exit_status = run(*options);
  });
}

}  // namespace capstan::tools
