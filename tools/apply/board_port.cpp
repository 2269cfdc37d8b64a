// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/apply/board_port.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <sys/file.h>
#include <sys/socket.h>
#include <termios.h>

#include <cerrno>
#include <charconv>
#include <cstring>
#include <string_view>

#include "capstan/boards/common/terminal_mode.hpp"
#include "capstan/tools/support/errors.hpp"

namespace capstan::tools {
namespace {

auto connect_loopback(const std::string& port, std::string_view number) -> FileDescriptor {
  std::uint16_t value = 0;
  const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), value);
  if (error != std::errc{} || end != number.data() + number.size() || value == 0) {
    throw BadInput(port + ": the port is not a number from 1 to 65535; write for instance tcp:4000");
  }
  FileDescriptor line(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(value);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (!line || ::connect(line.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    throw BadInput(port + ": nothing answers (" + std::strerror(errno) + "); start the board with --shell " + port);
  }
  return line;
}

}  // namespace

auto open_board_port(const std::string& port) -> FileDescriptor {
  constexpr std::string_view kTcp = "tcp:";
  if (port.starts_with(kTcp)) {
    return connect_loopback(port, std::string_view(port).substr(kTcp.size()));
  }
  FileDescriptor line(::open(port.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC));
  if (!line) {
    throw BadInput(port + ": the port does not open (" + std::strerror(errno) +
                   "); give tcp:PORT or the board's device");
  }
  if (::flock(line.get(), LOCK_EX | LOCK_NB) != 0) {
    throw BadInput(port + ": another Capstan program uses this port; end it first");
  }
  if (!make_raw(line.get(), B115200)) {
    throw BadInput(port + ": this is not a serial line; give tcp:PORT or the board's device");
  }
  return line;
}

}  // namespace capstan::tools
