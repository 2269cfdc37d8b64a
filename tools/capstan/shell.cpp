// SPDX-License-Identifier: Apache-2.0
#include <poll.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <iostream>
#include <memory>
#include <optional>

#include "capstan/boards/common/terminal_mode.hpp"
#include "capstan/tools/apply/shell_client.hpp"
#include "capstan/tools/capstan/commands.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"
#include "capstan/tools/telemetry/frame_recorder.hpp"

namespace capstan::tools {
namespace {

volatile std::sig_atomic_t leave_requested = 0;
extern "C" void leave(int /*signal_number*/) {
  leave_requested = 1;
}

/// Carries what is there from one descriptor to the other, what the recorder leaves of it if there is one. Returns how
/// much was carried; nothing at the end.
auto carry(int from, int to, FrameRecorder* recorder) -> std::optional<std::size_t> {
  std::array<char, 512> buffer{};
  const auto count = ::read(from, buffer.data(), buffer.size());
  if (count <= 0) {
    return std::nullopt;
  }
  const std::string_view received(buffer.data(), static_cast<std::size_t>(count));
  const std::string text = recorder != nullptr ? recorder->feed(received) : std::string(received);
  for (std::size_t sent = 0; sent < text.size();) {
    const auto written = ::write(to, text.data() + sent, text.size() - sent);
    if (written < 0) {
      return std::nullopt;
    }
    sent += static_cast<std::size_t>(written);
  }
  return text.size();
}

/// Which board this is, how it stands and what to type next.
void print_banner(ShellClient& shell, const std::string& port) {
  std::cerr << "connected to " << port << "; Ctrl-C leaves, 'help' lists the commands, 'disarm' takes torque away\n";
  try {
    for (const char* line : {"version", "status"}) {
      for (const std::string& answer : shell.ask(line)) {
        std::cerr << "  " << answer << "\n";
      }
    }
  } catch (const Refusal& nobody_or_busy) {
    std::cerr << nobody_or_busy.what() << "\n";
  }
  std::cout << shell.take_rest() << std::flush;
}

auto talk(const std::string& port, FrameRecorder* recorder) -> int {
  ShellClient shell(port);
  const CharacterMode character_mode;
  if (character_mode.active()) {
    print_banner(shell, port);
  }
  if (recorder != nullptr) {
    static_cast<void>(std::signal(SIGINT, leave));  // or the last rows would not reach the log
  }
  using std::chrono::steady_clock;
  constexpr std::chrono::milliseconds kLastWords{300};  // what the board still says after standard input has ended
  bool typing = true;
  auto said_at = steady_clock::now();
  while (leave_requested == 0 && (typing || steady_clock::now() - said_at < kLastWords)) {
    std::array<pollfd, 2> set{{{shell.descriptor(), POLLIN, 0}, {typing ? STDIN_FILENO : -1, POLLIN, 0}}};
    if (::poll(set.data(), set.size(), typing ? -1 : static_cast<int>(kLastWords.count())) < 0) {
      continue;  // a signal
    }
    if ((set[0].revents & (POLLIN | POLLHUP)) != 0) {
      const auto carried = carry(shell.descriptor(), STDOUT_FILENO, recorder);
      if (!carried) {
        break;
      }
      said_at = *carried > 0 ? steady_clock::now() : said_at;  // frames alone are no words
    }
    if ((set[1].revents & (POLLIN | POLLHUP)) != 0) {
      typing = carry(STDIN_FILENO, shell.descriptor(), nullptr).has_value();
      said_at = steady_clock::now();
    }
  }
  return kExitDone;
}

struct ShellOptions {
  std::string port;
  std::string record;
};

auto run_shell(const ShellOptions& options) -> int {
  if (options.record.empty()) {
    return talk(options.port, nullptr);
  }
  const auto log = file_sink(options.record);
  FrameRecorder recorder(*log);
  const int status = talk(options.port, &recorder);
  log->end();
  std::cerr << "recorded " << recorder.rows() << " samples in " << options.record << ", " << recorder.lost()
            << " lost, " << recorder.damaged() << " frames damaged, " << recorder.foreign() << " of other signals\n";
  if (recorder.rows() == 0) {
    std::cerr << "so no log was written; 'frames 10 joint0.q2' at the prompt sends what a log is made of\n";
  }
  return status;
}

}  // namespace

void add_shell(CLI::App& app, int& exit_status) {
  auto options = std::make_shared<ShellOptions>();
  CLI::App* command = app.add_subcommand("shell", "talk to a board's shell");
  command->add_option("port", options->port, "tcp:PORT, or the board's serial device")->required();
  command->add_option(
      "--record", options->record,
      "log (MCAP if the name ends in .mcap, else CSV) of what 'frames EVERY SIGNAL...' sends meanwhile");
  command->callback([options, &exit_status] { exit_status = run_shell(*options); });
}

}  // namespace capstan::tools
