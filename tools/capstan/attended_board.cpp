// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/capstan/attended_board.hpp"

#include <array>
#include <csignal>
#include <filesystem>
#include <iostream>

namespace capstan::tools {
namespace {

constexpr std::array kStops{SIGINT, SIGTERM, SIGHUP};
volatile std::sig_atomic_t stop_asked = 0;

/// Nothing ends what it begins: a terminal that is closed may hang up twice.
void stop(int /*signal_number*/) {
  stop_asked = 1;
  for (const int signal_number : kStops) {
    static_cast<void>(std::signal(signal_number, SIG_IGN));
  }
}

void stop_on_signals() {
  static_cast<void>(std::signal(SIGPIPE, SIG_IGN));  // who reads what this says may go before it
  for (const int signal_number : kStops) {
    struct sigaction now {};
    static_cast<void>(::sigaction(signal_number, nullptr, &now));
    if (signal_number != SIGHUP || now.sa_handler != SIG_IGN) {  // nohup
      now = {};
      now.sa_handler = stop;
      static_cast<void>(::sigaction(signal_number, &now, nullptr));
    }
  }
}

}  // namespace

auto open_board(const std::string& port) -> std::unique_ptr<BoardShell> {
  stop_on_signals();
  auto board = std::make_unique<PortShell>(port);
  board->stop_by(stop_asked);
  return board;
}

auto agrees(bool yes, const std::string& question) -> bool {
  if (yes) {
    return true;
  }
  std::cerr << "  " << question << " [y/N] " << std::flush;
  std::string answer;
  return std::getline(std::cin, answer) && (answer == "y" || answer == "yes");
}

auto with_joint(const std::string& name, int axis) -> std::string {
  std::filesystem::path path(name);
  const std::string extension = path.extension().string();
  return path.replace_extension().string() + ".joint" + std::to_string(axis) + extension;
}

}  // namespace capstan::tools
