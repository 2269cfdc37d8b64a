// SPDX-License-Identifier: Apache-2.0
#include "capstan/boards/common/console.hpp"

#include <fcntl.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <csignal>

namespace capstan {
namespace {

auto events_now(int fd, std::int16_t events) -> std::int16_t {
  pollfd entry{.fd = fd, .events = events, .revents = 0};
  return ::poll(&entry, 1, 0) > 0 ? entry.revents : std::int16_t{0};
}

auto try_again_later() -> bool {
  return errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR;
}

}  // namespace

Console::Console(Kind kind, std::string name, FileDescriptor line)
    : kind_(kind), name_(std::move(name)), line_(std::move(line)) {
  static_cast<void>(std::signal(SIGPIPE, SIG_IGN));  // a peer that left is an error of the write, not the program's end
  outgoing_.reserve(kOutgoingBytes);
}

Console::~Console() {
  constexpr std::chrono::milliseconds kFarewell{200};
  drain(kFarewell);
}

auto Console::receive(std::span<char> into) -> std::size_t {
  watch_line();
  flush();
  if (!attached_ || into.empty()) {
    return 0;
  }
  // Standard input is shared with other programs and so keeps its blocking mode: ask first.
  if (kind_ == Kind::kStdio && events_now(line_.get(), POLLIN) == 0) {
    return 0;
  }
  const auto count = ::read(line_.get(), into.data(), into.size());
  if (count > 0) {
    return static_cast<std::size_t>(count);
  }
  if (count == 0 ? kind_ != Kind::kSerial : !try_again_later()) {
    lose_peer();
  }
  return 0;
}

/// Who is there? A pty has a peer as long as somebody holds its device open; one that came, wrote and left counts too.
void Console::watch_line() {
  if (kind_ == Kind::kTcp) {
    // A client that has just left makes room as soon as its last characters are read; until then the next one waits.
    const bool leaving = attached_ && (events_now(line_.get(), POLLRDHUP) & (POLLRDHUP | POLLHUP)) != 0;
    if (!leaving && events_now(listener_.get(), POLLIN) != 0) {
      attached_ ? turn_away() : accept_client();
    }
  } else if (kind_ == Kind::kPty && !attached_) {
    const std::int16_t events = events_now(line_.get(), POLLIN);
    attached_ = (events & POLLHUP) == 0 || (events & POLLIN) != 0;
  } else if (kind_ == Kind::kSerial && attached_ && (events_now(line_.get(), POLLIN) & (POLLHUP | POLLERR)) != 0) {
    lose_peer();
  }
}

void Console::lose_peer() {
  hung_up_ = true;
  attached_ = false;
  stalled_ = false;
  if (kind_ != Kind::kStdio) {  // answers to a peer that left are not for the next one
    outgoing_.clear();
  }
  if (kind_ == Kind::kPty) {  // its device keeps them, and the modes the peer may have set
    const FileDescriptor device(::open(name_.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC));
    static_cast<void>(make_raw(device.get()));
    static_cast<void>(tcflush(device.get(), TCIFLUSH));
  } else if (kind_ != Kind::kStdio) {
    line_.close();
  }
}

auto Console::send(std::string_view bytes) -> std::ptrdiff_t {
  if (kind_ == Kind::kTcp) {
    return ::send(line_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
  }
  if (output_may_block_) {
    if ((events_now(output(), POLLOUT) & POLLOUT) == 0) {
      errno = EAGAIN;
      return -1;
    }
    constexpr std::size_t kSmall = 256;  // so little fits wherever a file says it is writable
    bytes = bytes.substr(0, kSmall);
  }
  return ::write(output(), bytes.data(), bytes.size());
}

void Console::flush() {
  std::size_t sent = 0;
  bool broken = false;
  while (sent < outgoing_.size()) {
    const auto count = send(std::string_view(outgoing_).substr(sent));
    if (count <= 0) {
      broken = count < 0 && !try_again_later();
      break;
    }
    sent += static_cast<std::size_t>(count);
    stalled_ = false;
  }
  outgoing_.erase(0, sent);
  if (broken) {
    outgoing_.clear();
    output_.close();
    lose_peer();
  }
}

void Console::drain(std::chrono::milliseconds at_most) {
  const auto end = std::chrono::steady_clock::now() + at_most;
  flush();
  while (!outgoing_.empty() && output() >= 0 && std::chrono::steady_clock::now() < end) {
    pollfd entry{.fd = output(), .events = POLLOUT, .revents = 0};
    static_cast<void>(::poll(&entry, 1, 1));
    flush();
  }
}

/// Waits once for a peer that does not read. False if there is still no room.
auto Console::make_room() -> bool {
  flush();
  if (!stalled_ && outgoing_.size() >= kOutgoingBytes / 2) {
    pollfd entry{.fd = output(), .events = POLLOUT, .revents = 0};
    static_cast<void>(::poll(&entry, 1, static_cast<int>(kPatience.count())));
    stalled_ = true;
    flush();
  }
  return outgoing_.size() < kOutgoingBytes;
}

void Console::do_write(std::string_view text) {
  const bool line_end = text.ends_with('\n');
  while (!text.empty() && output() >= 0 && (attached_ || kind_ == Kind::kStdio)) {
    const std::size_t taken = std::min(text.size(), kOutgoingBytes - outgoing_.size());
    outgoing_.append(text.substr(0, taken));
    text.remove_prefix(taken);
    if (!text.empty() && !make_room()) {
      dropped_ += text.size();
      return;
    }
  }
  if (line_end) {
    flush();
  }
}

auto Console::poll_set() const -> std::array<pollfd, 2> {
  const std::int16_t wanted = outgoing_.empty() ? POLLIN : POLLIN | POLLOUT;
  std::array<pollfd, 2> set{
      {{.fd = -1, .events = wanted, .revents = 0}, {.fd = listener_.get(), .events = POLLIN, .revents = 0}}};
  if (attached_) {
    set[0].fd = line_.get();
    if (kind_ == Kind::kStdio) {
      set[0].events = POLLIN;
      set[1] = {.fd = outgoing_.empty() ? -1 : output_.get(), .events = POLLOUT, .revents = 0};
    }
  }
  return set;
}

void Console::wait(std::chrono::milliseconds at_most) {
  flush();
  constexpr std::chrono::milliseconds kLookForPty{50};
  const auto time = kind_ == Kind::kPty && !attached_ ? std::min(at_most, kLookForPty) : at_most;
  auto set = poll_set();
  static_cast<void>(::poll(set.data(), set.size(), static_cast<int>(time.count())));
}

}  // namespace capstan
