// SPDX-License-Identifier: Apache-2.0
#include <poll.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <iostream>
#include <memory>
#include <optional>
#include <string_view>

#include "capstan/tools/apply/shell_client.hpp"
#include "capstan/tools/capstan/commands.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/first_repeat.hpp"
#include "capstan/tools/support/text.hpp"
#include "capstan/tools/telemetry/frame_recorder.hpp"

namespace capstan::tools {
namespace {

using std::chrono::steady_clock;

struct RecordOptions {
  std::string port;
  std::string output;
  std::vector<std::string> signals;
  int every_ms = 10;
  std::optional<double> seconds;
};

volatile std::sig_atomic_t stop_requested = 0;
extern "C" void stop_recording(int /*signal_number*/) {
  stop_requested = 1;
}

void send(const ShellClient& shell, const std::string& line) {
  const std::string text = line + "\n";
  if (::write(shell.descriptor(), text.data(), text.size()) != static_cast<ssize_t>(text.size())) {
    throw Refusal("the line broke while sending; check the cable");
  }
}

/// Feeds the recorder until the time is over, somebody wants to stop or the board is gone; false then. Text goes into
/// `said`. @param asked  the line that the board may refuse
auto receive(const ShellClient& shell, FrameRecorder& recorder, steady_clock::time_point end, const std::string& asked,
             std::string& said) -> bool {
  constexpr int kLookAroundMs = 50;
  while (stop_requested == 0 && steady_clock::now() < end) {
    pollfd set{shell.descriptor(), POLLIN, 0};
    if (::poll(&set, 1, kLookAroundMs) <= 0) {
      continue;
    }
    std::array<char, 4096> buffer{};
    const auto count = ::read(shell.descriptor(), buffer.data(), buffer.size());
    if (count <= 0) {
      return false;
    }
    said += recorder.feed({buffer.data(), static_cast<std::size_t>(count)});
    constexpr std::string_view kError = "error ";
    if (const auto at = said.find(kError); at != std::string::npos && said.ends_with('\n')) {
      const std::string why = said.substr(at + kError.size(), said.find('\n', at) - at - kError.size());
      throw Refusal("the board refused '" + asked + "': " + std::string(trimmed(why)));
    }
  }
  return true;
}

auto run_record(const RecordOptions& options) -> int {
  if (const auto signal = first_repeat(options.signals); signal != options.signals.end()) {
    throw BadInput(*signal + " is given twice, and would be two columns of one name; name it once");
  }
  const ShellClient shell(options.port);
  const auto log = file_sink(options.output);
  FrameRecorder recorder(*log);
  for (const int signal_number : {SIGINT, SIGTERM}) {
    static_cast<void>(std::signal(signal_number, stop_recording));
  }
  const std::string asked = "frames " + std::to_string(options.every_ms) + " " + joined(options.signals, " ");
  send(shell, asked);
  const auto end = options.seconds ? steady_clock::now() + std::chrono::duration_cast<steady_clock::duration>(
                                                               std::chrono::duration<double>(*options.seconds))
                                   : steady_clock::time_point::max();
  std::string said;
  const bool there = receive(shell, recorder, end, asked, said);
  if (there) {
    stop_requested = 0;
    send(shell, "frames off");
    constexpr std::chrono::milliseconds kFarewell{200};
    static_cast<void>(receive(shell, recorder, steady_clock::now() + kFarewell, asked, said));
  }
  log->end();
  if (recorder.rows() == 0) {
    throw Refusal("no frame arrived in this time, and no log was written; check the port, or record for longer");
  }
  std::cout << "recorded " << recorder.rows() << " samples in " << options.output << ", " << recorder.lost()
            << " lost, " << recorder.damaged() << " frames damaged\n";
  if (!there) {
    throw Refusal(options.port + ": the board closed the line; what came before is in the log");
  }
  return kExitDone;
}

}  // namespace

void add_record(CLI::App& app, int& exit_status) {
  auto options = std::make_shared<RecordOptions>();
  CLI::App* command = app.add_subcommand("record", "record a running board's signals to CSV or MCAP, as binary frames");
  command->add_option("port", options->port, "the board's shell: tcp:PORT, or its serial device")->required();
  command->add_option("signals", options->signals, "joint0.q2 and so on; 'scope signals' in the shell lists them")
      ->required()
      ->expected(1, 8);
  command->add_option("-o,--output", options->output, "log to write: MCAP if the name ends in .mcap, else CSV")
      ->required();
  command->add_option("--every", options->every_ms, "sample interval in milliseconds")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000));
  command->add_option("--for", options->seconds, "seconds; without it until Ctrl-C")->check(CLI::Range(0.01, 1e6));
  command->callback([options, &exit_status] { exit_status = run_record(*options); });
}

}  // namespace capstan::tools
