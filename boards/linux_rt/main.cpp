// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <chrono>
#include <csignal>
#include <exception>
#include <iostream>
#include <thread>

#include "capstan/boards/common/console.hpp"
#include "capstan/boards/common/file_banks.hpp"
#include "capstan/boards/common/retained_memory.hpp"
#include "capstan/boards/common/shell_feed.hpp"
#include "capstan/boards/linux_rt/linux_rt_board.hpp"
#include "capstan/boards/linux_rt/options.hpp"
#include "capstan/boards/linux_rt/selftest.hpp"
#include "capstan/firmware/console/shell.hpp"

namespace {

using capstan::BoardOptions;

volatile std::sig_atomic_t stop_requested = 0;

extern "C" void request_stop(int /*signal_number*/) {
  stop_requested = 1;
}

auto interrupted() -> bool {
  return stop_requested != 0;
}

auto joints_of(const BoardOptions& options) -> std::size_t {
  std::size_t drives = 0;
  for (const capstan::CanBusSetup& bus : options.can.buses) {
    drives += bus.nodes.size();
  }
  return std::max<std::size_t>(drives, 1);
}

auto make_joints(const BoardOptions& options, capstan::Banks& banks, std::span<std::uint32_t> fault_memory)
    -> std::unique_ptr<capstan::RtJoints> {
  if (options.can.buses.empty()) {
    return capstan::simulated_joints(banks, options.gpio, fault_memory);
  }
  capstan::CanSetup can = options.can;
  can.interrupted = interrupted;
  return capstan::can_joints(can, options.gpio, banks, fault_memory, std::cerr);
}

/// The fault log's file, from what the cycle has written into memory.
void keep_faults(capstan::LinuxRtBoard& board, capstan::RetainedMemory& retained) {
  if (const std::string problem = retained.keep(energised(board.machine().telemetry().state)); !problem.empty()) {
    std::cerr << "capstan_linux_rt: " << problem << '\n';
  }
}

auto retained_memory(const BoardOptions& options) -> std::unique_ptr<capstan::RetainedMemory> {
  const std::size_t words = capstan::FaultLog::words_for(joints_of(options));
  auto retained = options.storage.empty()
                      ? std::make_unique<capstan::RetainedMemory>(words)
                      : std::make_unique<capstan::RetainedMemory>(options.storage + ".faults", words);
  if (!retained->remark().empty()) {
    std::cerr << "capstan_linux_rt: " << retained->remark() << ".\n";
  }
  return retained;
}

/// What goes to standard error and to the disk while the firmware runs, in a thread of its own: a terminal after
/// Ctrl-S, a log's reader that hangs or a disk that stalls may keep it for as long as they like, and must not keep
/// `disarm`, a lost link or a signal from being heard.
class Chronicle {
 public:
  /// @param board, retained  outlive this object, which waits for its thread
  Chronicle(capstan::LinuxRtBoard& board, capstan::RetainedMemory& retained)
      : thread_([&board, &retained](const std::stop_token& stop) {
          constexpr std::chrono::milliseconds kLookAround{20};
          while (!stop.stop_requested()) {
            board.report(std::cerr);
            keep_faults(board, retained);
            std::this_thread::sleep_for(kLookAround);
          }
        }) {}

 private:
  std::jthread thread_;
};

void serve(capstan::LinuxRtBoard& board, capstan::Console& console, const BoardOptions& options) {
  using std::chrono::steady_clock;
  constexpr std::chrono::milliseconds kLookAround{20};
  capstan::Shell shell(board.machine(), console, board, console.is_terminal());
  capstan::ShellFeed feed(console, shell);
  const auto end = steady_clock::now() + std::chrono::duration<double>(options.seconds.value_or(0.0));
  while (board.running() && !interrupted() && !board.reboot_wanted() &&
         (!options.seconds || steady_clock::now() < end)) {
    if (feed.poll()) {
      board.link_lost();
    }
    if (feed.done() && !options.seconds) {
      break;
    }
    feed.wait(kLookAround);
  }
}

void say_where(const capstan::Console& console, const BoardOptions& options) {
  std::cerr << "capstan_linux_rt: " << (options.can.buses.empty() ? "simulated joint" : "drives on CAN")
            << ", console on " << console.name();
  if (options.console == "pty") {
    std::cerr << " (attach with: screen " << console.name() << ')';
  }
  std::cerr << (options.storage.empty() ? ", parameters are not kept (--storage FILE keeps them)\n" : "\n");
}

void say_how_it_went(const capstan::RtReport& report, const capstan::Console& console) {
  for (const std::string& remark : report.remarks) {
    std::cerr << "capstan_linux_rt: " << remark << ".\n";
  }
  std::cerr << "capstan_linux_rt: " << report.cycles << " cycles, " << report.overruns << " missed, "
            << report.minor_faults + report.major_faults << " page faults";
  if (console.dropped() != 0) {
    std::cerr << ", " << console.dropped() << " characters not read by the console's peer";
  }
  std::cerr << '\n';
}

auto run(const BoardOptions& options) -> int {
  static_cast<void>(capstan::lock_memory());  // before threads exist; the loop looks whether it is so, and says it
  for (const int signal_number : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) {
    static_cast<void>(std::signal(signal_number, request_stop));
  }
  capstan::FileBanks banks =
      options.storage.empty() ? capstan::FileBanks::temporary() : capstan::FileBanks(options.storage);
  if (options.action == BoardOptions::Action::kSelftest) {
    capstan::LinuxRtBoard board(options.rt, make_joints(options, banks, {}));
    constexpr double kUsualS = 10.0;
    const capstan::SelftestResult result = capstan::run_selftest(board, options.seconds.value_or(kUsualS), interrupted);
    capstan::print_selftest(std::cout, result);
    return capstan::judge(result).failures.empty() ? 0 : 1;
  }
  capstan::Console console = capstan::Console::open(options.console);
  say_where(console, options);
  const auto retained = retained_memory(options);
  for (bool again = true; again;) {
    capstan::LinuxRtBoard board(options.rt, make_joints(options, banks, retained->words()));
    board.describe(options.simulated_drives, {.brake = options.gpio.brake.has_value()});
    board.start();
    const capstan::RtReport report = [&] {
      const Chronicle chronicle(board, *retained);
      serve(board, console, options);
      return board.stop();  // before anybody waits for the chronicle
    }();
    keep_faults(board, *retained);
    board.report(std::cerr);
    say_how_it_went(report, console);
    again = board.reboot_wanted();
  }
  return 0;
}

}  // namespace

auto main(int argc, char* argv[]) -> int {
  try {
    const BoardOptions options = capstan::parse_options({argv, static_cast<std::size_t>(argc)});
    if (options.action == BoardOptions::Action::kHelp) {
      std::cout << capstan::help_text();
      return 0;
    }
    if (options.action == BoardOptions::Action::kVersion) {
      std::cout << "capstan linux_rt " << CAPSTAN_VERSION << '\n';
      return 0;
    }
    return run(options);
  } catch (const capstan::SetUpInterrupted& end) {
    std::cerr << "capstan_linux_rt: " << end.what() << '\n';
    return 0;
  } catch (const std::exception& problem) {
    std::cerr << "capstan_linux_rt: " << problem.what() << '\n';
    return 2;
  }
}
