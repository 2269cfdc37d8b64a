// SPDX-License-Identifier: Apache-2.0
#include <poll.h>
#include <unistd.h>

#include <array>
#include <iostream>
#include <memory>

#include "boards/common/terminal_mode.hpp"
#include "tools/apply/shell_client.hpp"
#include "tools/capstan/commands.hpp"
#include "tools/support/errors.hpp"

namespace capstan::tools {
namespace {

/// Carries what is there from one descriptor to the other; false at its end.
auto carry(int from, int to) -> bool {
  std::array<char, 512> buffer{};
  const auto count = ::read(from, buffer.data(), buffer.size());
  for (ssize_t sent = 0; sent < count;) {
    const auto written = ::write(to, buffer.data() + sent, static_cast<std::size_t>(count - sent));
    if (written < 0) {
      return false;
    }
    sent += written;
  }
  return count > 0;
}

auto talk(const std::string& port) -> int {
  const ShellClient shell(port);
  const CharacterMode character_mode;
  if (character_mode.active()) {
    std::cerr << "connected to " << port << "; Ctrl-C leaves\n";
  }
  bool typing = true;
  for (;;) {
    std::array<pollfd, 2> set{{{shell.descriptor(), POLLIN, 0}, {typing ? STDIN_FILENO : -1, POLLIN, 0}}};
    constexpr int kLastWordsMs = 300;  // what the board still says after standard input has ended
    if (::poll(set.data(), set.size(), typing ? -1 : kLastWordsMs) == 0) {
      return kExitDone;
    }
    if ((set[0].revents & (POLLIN | POLLHUP)) != 0 && !carry(shell.descriptor(), STDOUT_FILENO)) {
      return kExitDone;
    }
    if ((set[1].revents & (POLLIN | POLLHUP)) != 0) {
      typing = carry(STDIN_FILENO, shell.descriptor());
    }
  }
}

}  // namespace

void add_shell(CLI::App& app, int& exit_status) {
  auto port = std::make_shared<std::string>();
  CLI::App* command = app.add_subcommand("shell", "talk to a board's shell");
  command->add_option("port", *port, "tcp:PORT, or the board's serial device")->required();
  command->callback([port, &exit_status] { exit_status = talk(*port); });
}

}  // namespace capstan::tools
