// SPDX-License-Identifier: Apache-2.0
#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <termios.h>

#include <charconv>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <string_view>
#include <thread>

#include "capstan/hal/sim/plant_server.hpp"

namespace capstan::sim {
namespace {

sockaddr_un unix_address(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.empty() || path.size() >= sizeof address.sun_path)
    throw std::runtime_error("the socket's path is empty or too long; give one of at most 107 characters");
  std::memcpy(address.sun_path, path.c_str(), path.size() + 1);
  return address;
}

FileDescriptor connect_unix(const std::string& path) {
  const sockaddr_un address = unix_address(path);
  for (int attempt = 0; attempt < 1000; ++attempt) {
    FileDescriptor line(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
    if (line && ::connect(line.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0)
      return line;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  throw std::runtime_error(path + ": nothing answers there; start the board with this socket");
}

FileDescriptor accept_one(const FileDescriptor& door, const sockaddr* address, socklen_t size,
                          const std::string& name) {
  const bool open = door && ::bind(door.get(), address, size) == 0 && ::listen(door.get(), 1) == 0;
  FileDescriptor line(open ? ::accept4(door.get(), nullptr, nullptr, SOCK_CLOEXEC) : -1);
  if (!line)
    throw std::runtime_error(name + " cannot be opened; give a free one");
  return line;
}

FileDescriptor listen_unix(const std::string& path) {
  const sockaddr_un address = unix_address(path);
  const FileDescriptor door(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
  FileDescriptor line = accept_one(door, reinterpret_cast<const sockaddr*>(&address), sizeof address, path);
  ::unlink(path.c_str());
  return line;
}

FileDescriptor listen_tcp(std::string_view port_text) {
  std::uint16_t port = 0;
  const auto [end, error] = std::from_chars(port_text.data(), port_text.data() + port_text.size(), port);
  if (error != std::errc() || end != port_text.data() + port_text.size() || port == 0)
    throw std::runtime_error("a port is 1 to 65535; write it like tcp:5001");
  const FileDescriptor door(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  const int yes = 1;
  static_cast<void>(::setsockopt(door.get(), SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  return accept_one(door, reinterpret_cast<const sockaddr*>(&address), sizeof address,
                    "port " + std::string(port_text));
}

FileDescriptor make_terminal() {
  FileDescriptor line(::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC));
  termios settings{};
  const char* name =
      line && ::grantpt(line.get()) == 0 && ::unlockpt(line.get()) == 0 ? ::ptsname(line.get()) : nullptr;
  if (name == nullptr || ::tcgetattr(line.get(), &settings) != 0)
    throw std::runtime_error("no terminal can be made; use tcp:PORT instead");
  ::cfmakeraw(&settings);
  static_cast<void>(::tcsetattr(line.get(), TCSANOW, &settings));
  std::printf("plant at %s\n", name);
  std::fflush(stdout);
  return line;
}

}  // namespace

FileDescriptor open_line(const std::string& line) {
  const std::size_t colon = line.find(':');
  const std::string kind = line.substr(0, colon);
  const std::string rest = colon == std::string::npos ? "" : line.substr(colon + 1);
  if (kind == "connect")
    return connect_unix(rest);
  if (kind == "listen")
    return listen_unix(rest);
  if (kind == "tcp")
    return listen_tcp(rest);
  if (line == "pty")
    return make_terminal();
  throw std::runtime_error("`" + line + "` is no line; write connect:PATH, listen:PATH, tcp:PORT or pty");
}

}  // namespace capstan::sim
