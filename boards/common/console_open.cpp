// SPDX-License-Identifier: Apache-2.0
#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <sys/stat.h>

#include <cerrno>
#include <charconv>
#include <cstdlib>
#include <cstring>
#include <stdexcept>

#include "capstan/boards/common/console.hpp"

namespace capstan {
namespace {

[[noreturn]] void fail(const std::string& sentence, const std::string& cure) {
  throw std::runtime_error(sentence + "; " + cure);
}

auto reason() -> std::string {
  return std::strerror(errno);
}

auto quoted(std::string_view text) -> std::string {
  return std::string(1, '\'').append(text).append(1, '\'');
}

/// Standard output, opened anew so that non-blocking mode does not leak into the programs that share it. An invalid
/// result means that this is not possible (a socket) or would do harm (a file would be written from its beginning).
auto reopen_standard_output() -> FileDescriptor {
  struct stat info {};
  if (fstat(STDOUT_FILENO, &info) != 0 || !(S_ISCHR(info.st_mode) || S_ISFIFO(info.st_mode))) {
    return FileDescriptor();
  }
  return FileDescriptor(::open("/proc/self/fd/1", O_WRONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC));
}

auto loopback(std::uint16_t port) -> sockaddr_in {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  return address;
}

}  // namespace

auto Console::open(std::string_view what) -> Console {
  constexpr std::string_view kTcp = "tcp:";
  constexpr std::string_view kSerial = "serial:";
  if (what == "stdio") {
    return stdio();
  }
  if (what == "pty") {
    return pty();
  }
  if (what.starts_with(kTcp)) {
    const std::string_view digits = what.substr(kTcp.size());
    std::uint16_t port = 0;
    const auto [end, problem] = std::from_chars(digits.data(), digits.data() + digits.size(), port);
    if (problem == std::errc{} && end == digits.data() + digits.size()) {
      return tcp(port);
    }
    fail(quoted(digits) + " is not a TCP port", "give a number from 1 to 65535, for instance tcp:4000");
  }
  if (what.starts_with(kSerial) && what.size() > kSerial.size()) {
    return serial(std::string(what.substr(kSerial.size())));
  }
  fail("There is no console " + quoted(what), "use stdio, pty, tcp:PORT or serial:PATH");
}

auto Console::stdio() -> Console {
  FileDescriptor input(fcntl(STDIN_FILENO, F_DUPFD_CLOEXEC, 0));
  FileDescriptor output = reopen_standard_output();
  const bool may_block = !output;
  if (may_block) {
    output = FileDescriptor(fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 0));
  }
  Console console(Kind::kStdio, "stdio", std::move(input));
  console.output_ = std::move(output);
  console.output_may_block_ = may_block;
  console.attached_ = static_cast<bool>(console.line_);
  console.hung_up_ = !console.attached_;
  console.terminal_ = isatty(STDIN_FILENO) == 1 && isatty(STDOUT_FILENO) == 1;
  if (console.terminal_) {
    console.character_mode_.emplace();
  }
  return console;
}

auto Console::pty() -> Console {
  FileDescriptor master(posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  if (!master || grantpt(master.get()) != 0 || unlockpt(master.get()) != 0) {
    fail("No pseudo-terminal can be made (" + reason() + ")", "mount /dev/pts or use another console");
  }
  std::array<char, 64> device{};
  if (ptsname_r(master.get(), device.data(), device.size()) != 0) {
    fail("The pseudo-terminal has no name (" + reason() + ")", "mount /dev/pts or use another console");
  }
  // Opened and closed once: the line is transparent for programs that do not set it, and "nobody there" shows as a
  // hang-up.
  const FileDescriptor slave(::open(device.data(), O_RDWR | O_NOCTTY | O_CLOEXEC));
  if (!slave || !make_raw(slave.get())) {
    fail(std::string(device.data()) + " cannot be set up (" + reason() + ")", "check the permissions of /dev/pts");
  }
  Console console(Kind::kPty, device.data(), std::move(master));
  console.terminal_ = true;
  return console;
}

auto Console::tcp(std::uint16_t port) -> Console {
  FileDescriptor listener(::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  const int on = 1;
  sockaddr_in address = loopback(port);
  socklen_t size = sizeof address;
  auto* const any = reinterpret_cast<sockaddr*>(&address);
  if (!listener || setsockopt(listener.get(), SOL_SOCKET, SO_REUSEADDR, &on, sizeof on) != 0 ||
      bind(listener.get(), any, size) != 0 || listen(listener.get(), 4) != 0 ||
      getsockname(listener.get(), any, &size) != 0) {
    fail("Port " + std::to_string(port) + " on 127.0.0.1 cannot be opened (" + reason() + ")",
         "end the program that holds it or choose another one");
  }
  Console console(Kind::kTcp, "127.0.0.1:" + std::to_string(ntohs(address.sin_port)), FileDescriptor());
  console.listener_ = std::move(listener);
  return console;
}

auto Console::serial(const std::string& path) -> Console {
  FileDescriptor device(::open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  if (!device) {
    fail(path + " cannot be opened (" + reason() + ")",
         "check the cable, the name and that you are in the group dialout");
  }
  if (!make_raw(device.get(), B115200)) {
    fail(path + " is not a serial device that does 115200 8N1", "give a device such as /dev/ttyUSB0");
  }
  Console console(Kind::kSerial, path, std::move(device));
  console.attached_ = true;
  console.terminal_ = true;
  return console;
}

void Console::accept_client() {
  line_ = FileDescriptor(accept4(listener_.get(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
  attached_ = static_cast<bool>(line_);
  if (attached_) {
    const int on = 1;  // answers are short and somebody waits for each
    static_cast<void>(setsockopt(line_.get(), IPPROTO_TCP, TCP_NODELAY, &on, sizeof on));
  }
}

void Console::turn_away() {
  constexpr std::string_view kAnswer = "error taken: another client holds this console; try again when it has left\r\n";
  const FileDescriptor visitor(accept4(listener_.get(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
  if (visitor) {
    static_cast<void>(::send(visitor.get(), kAnswer.data(), kAnswer.size(), MSG_NOSIGNAL | MSG_DONTWAIT));
  }
}

}  // namespace capstan
