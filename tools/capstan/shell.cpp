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

#include "capstan/boards/common/terminal_mode.hpp"
#include "capstan/boards/stm32f405/image.hpp"
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

/// What is there; nothing at the end.
auto read_some(int from) -> std::optional<std::string> {
  std::array<char, 512> buffer{};
  const auto count = ::read(from, buffer.data(), buffer.size());
  return count > 0 ? std::optional(std::string(buffer.data(), static_cast<std::size_t>(count))) : std::nullopt;
}

/// False: nobody takes it any more.
auto write_all(int to, std::string_view text) -> bool {
  while (!text.empty()) {
    const auto written = ::write(to, text.data(), text.size());
    if (written < 0) {
      return false;
    }
    text.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

/// The lines of a script that the board owes an answer to.
class Owed {
 public:
  void sent(std::string_view text) {
    for (const char c : text) {
      if (c == kCtrlC) {
        lines_ = 0;  // the board forgets those that wait
      }
      lines_ += c == '\r' || (c == '\n' && last_ != '\r') ? 1 : 0;
      last_ = c;
    }
  }
  void received(std::string_view text) {
    said_ += text;
    for (std::size_t end = 0; (end = said_.find('\n')) != std::string::npos; said_.erase(0, end + 1)) {
      const std::string_view line = bare_line(std::string_view(said_).substr(0, end));
      if (line == stm32f405::kDamagedImage) {
        throw Refusal(std::string(line.substr(2)));  // it will never answer
      }
      const bool refused = line.starts_with("error ");
      refused_ += refused ? 1 : 0;
      lines_ -= (refused || line == "ok") && lines_ > 0 ? 1 : 0;
    }
  }
  [[nodiscard]] auto lines() const -> int { return lines_; }
  [[nodiscard]] auto refused() const -> int { return refused_; }
  [[nodiscard]] auto in_line() const -> bool { return last_ != '\n' && last_ != '\r' && last_ != kCtrlC; }
  [[nodiscard]] auto sentence() const -> std::string {
    return lines_ == 0 ? ""
                       : "; " + std::to_string(lines_) + (lines_ == 1 ? " line was" : " lines were") + " not answered";
  }

 private:
  static constexpr char kCtrlC = 0x03;
  int lines_ = 0, refused_ = 0;
  char last_ = '\n';
  std::string said_;  // of a line whose end has not come
};

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

/// A person leaves with Ctrl-C and has seen the answers. A script, standard input that is no terminal, is over when all
/// of its lines are answered; what streams goes on.
class Talk {
 public:
  Talk(const std::string& port, FrameRecorder* recorder) : port_(port), recorder_(recorder), shell_(port) {
    if (!script_) {
      print_banner(shell_, port);
    }
    static_cast<void>(std::signal(SIGPIPE, SIG_IGN));  // the write says it
    for (const int signal_number : {SIGINT, SIGTERM, SIGHUP}) {
      static_cast<void>(std::signal(signal_number, leave));  // or the last rows would not reach the log
    }
  }

  auto carry_on() -> int {
    while (leave_requested == 0 && (typing_ || Clock::now() - said_at_ < silence())) {
      std::array<pollfd, 2> set{{{shell_.descriptor(), POLLIN, 0}, {typing_ ? STDIN_FILENO : -1, POLLIN, 0}}};
      if (::poll(set.data(), set.size(), typing_ ? -1 : static_cast<int>(silence().count())) < 0) {
        continue;  // a signal
      }
      if ((set[0].revents & (POLLIN | POLLHUP)) != 0 && !hear()) {
        return kExitDone;
      }
      if ((set[1].revents & (POLLIN | POLLHUP)) != 0) {
        say();
      }
    }
    if (!port_.starts_with("tcp:")) {
      say_torque();
    }
    if (script_ && owed_.lines() > 0) {
      throw Refusal(port_ +
                    (leave_requested != 0 ? ": left while the board was answering"
                                          : ": no answer from the shell in time; check that a board is connected") +
                    owed_.sentence());
    }
    return script_ && owed_.refused() > 0 ? kExitRefused : kExitDone;
  }

 private:
  using Clock = std::chrono::steady_clock;

  /// A serial line does not tell the board that nobody is there any more.
  void say_torque() {
    constexpr std::chrono::seconds kPatience{2};
    std::string state = "no answer to 'status'";
    try {
      for (const std::string& line : shell_.ask("status", kPatience)) {
        state = line.starts_with("state ") ? line.substr(0, line.find(' ', 6)) : state;
      }
    } catch (const Refusal&) {
      // It may have.
    }
    if (state != "state disarmed" && state != "state faulted" && state != "state boot") {
      std::cerr << "capstan: the joints may have torque (" << state << ") and keep it over a serial line; 'disarm' "
                << "takes it away\n";
    }
  }

  /// How long the board may be silent when nobody types any more.
  [[nodiscard]] auto silence() const -> std::chrono::milliseconds {
    constexpr std::chrono::milliseconds kLastWords{300};  // behind its last answer
    constexpr std::chrono::minutes kFirstWord{1};         // nobody is there
    return owed_.lines() == 0 ? kLastWords : heard_ ? std::chrono::milliseconds(kLongestAnswer) : kFirstWord;
  }

  /// What the board says, to standard output; but frames to the recorder. False: nobody reads it any more.
  auto hear() -> bool {
    const auto received = read_some(shell_.descriptor());
    if (!received) {
      throw Refusal(port_ + ": the board closed the line; check its supply and that no other program uses its shell" +
                    (script_ ? owed_.sentence() : ""));
    }
    const std::string text = recorder_ != nullptr ? recorder_->feed(*received) : *received;
    owed_.received(text);
    said_at_ = text.empty() ? said_at_ : Clock::now();
    heard_ = true;
    return write_all(STDOUT_FILENO, text);
  }

  /// What is typed, to the board.
  void say() {
    const auto typed = read_some(STDIN_FILENO);
    typing_ = typed.has_value();
    const std::string text = typed ? *typed : script_ && owed_.in_line() ? "\n" : "";  // the last line lacks it
    owed_.sent(text);
    if (!write_all(shell_.descriptor(), text)) {
      throw Refusal(port_ + ": the line broke while sending; check the cable" + owed_.sentence());
    }
    said_at_ = Clock::now();
  }

  std::string port_;
  FrameRecorder* recorder_;
  ShellClient shell_;
  CharacterMode character_mode_;
  bool script_ = !character_mode_.active();
  Owed owed_;
  bool typing_ = true, heard_ = false;
  Clock::time_point said_at_ = Clock::now();
};

struct ShellOptions {
  std::string port;
  std::string record;
};

auto run_shell(const ShellOptions& options) -> int {
  if (options.record.empty()) {
    return Talk(options.port, nullptr).carry_on();
  }
  const auto log = file_sink(options.record);
  FrameRecorder recorder(*log);
  int status = kExitDone;
  std::string lost;
  try {
    status = Talk(options.port, &recorder).carry_on();
  } catch (const Refusal& refusal) {
    lost = refusal.what();
  }
  log->end();
  std::cerr << "recorded " << recorder.rows() << " samples in " << options.record << ", " << recorder.lost()
            << " lost, " << recorder.damaged() << " frames damaged, " << recorder.foreign() << " of other signals\n";
  if (recorder.after_restart() > 0) {
    std::cerr << "the board started anew, and the " << recorder.after_restart()
              << " samples from then on are not in the log; record them into another\n";
  }
  if (recorder.rows() == 0) {
    std::cerr << "so no log was written; 'frames 10 joint0.q2' at the prompt sends what a log is made of\n";
  }
  if (!lost.empty()) {
    throw Refusal(lost);
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
