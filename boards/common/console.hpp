// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <poll.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "capstan/boards/common/terminal_mode.hpp"
#include "capstan/firmware/console/text.hpp"
#include "capstan/hal/linux/file_descriptor.hpp"

namespace capstan {

/// The shell's line on a host: standard streams, a pseudo-terminal, TCP on loopback or a serial device. For one thread,
/// never the cycle's. Nothing blocks: what is written waits in a bounded buffer and goes out with the next newline,
/// receive() or wait(). Factories throw std::runtime_error with "sentence; cure". SIGPIPE is ignored from then on.
class Console final : public TextSink {
 public:
  static constexpr std::size_t kOutgoingBytes = std::size_t{64} * 1024;
  /// How long a write may wait once for a peer that does not read; then it drops until the peer reads again.
  static constexpr std::chrono::milliseconds kPatience{20};

  /// "stdio", "pty", "tcp:PORT" or "serial:PATH", as on the command line.
  static auto open(std::string_view what) -> Console;
  static auto stdio() -> Console;
  /// name() is the device to attach a terminal program to.
  static auto pty() -> Console;
  /// One client at a time, from this machine only; others are told and turned away. Port 0: any free one, see name().
  static auto tcp(std::uint16_t port) -> Console;
  /// 115200 8N1.
  static auto serial(const std::string& path) -> Console;

  Console(Console&&) = default;
  Console(const Console&) = delete;
  auto operator=(const Console&) -> Console& = delete;
  auto operator=(Console&&) -> Console& = delete;
  ~Console();

  /// Takes what has arrived, 0 if nothing has. Also sends, accepts a client and notices who came and went: call it
  /// often.
  auto receive(std::span<char> into) -> std::size_t;
  /// True once each time the peer went away: end of standard input, terminal closed, client gone, device unplugged.
  auto hung_up() -> bool { return std::exchange(hung_up_, false); }
  /// True if nobody can come any more: standard input has ended or the serial device is gone.
  [[nodiscard]] auto finished() const -> bool {
    return !attached_ && (kind_ == Kind::kStdio || kind_ == Kind::kSerial);
  }
  /// True while somebody is there.
  [[nodiscard]] auto attached() const -> bool { return attached_; }
  /// True if a person is expected, who wants echo and a prompt: pty, serial, and stdio on a terminal.
  [[nodiscard]] auto is_terminal() const -> bool { return terminal_; }
  /// True if the input was given as a whole beforehand (a pipe or a file): what is in it counts even after its end.
  [[nodiscard]] auto is_script() const -> bool { return kind_ == Kind::kStdio && !terminal_; }

  /// Sleeps until something arrives or the time is over.
  void wait(std::chrono::milliseconds at_most);
  /// What to wait for in a poll of one's own; unused places are -1. Nobody wakes it when a pty is attached: bound the
  /// time.
  [[nodiscard]] auto poll_set() const -> std::array<pollfd, 2>;
  /// Sends what the peer takes now.
  void flush();
  /// Gives the peer some time to take all of it; the destructor does so too.
  void drain(std::chrono::milliseconds at_most);
  /// Where to attach: "stdio", "/dev/pts/3", "127.0.0.1:4000" or the serial device.
  [[nodiscard]] auto name() const -> const std::string& { return name_; }

 private:
  enum class Kind : std::uint8_t { kStdio, kPty, kTcp, kSerial };
  Console(Kind kind, std::string name, FileDescriptor line);

  void do_write(std::string_view text) override;
  /// Because the peer did not read.
  [[nodiscard]] auto do_dropped() const -> std::uint32_t override { return static_cast<std::uint32_t>(dropped_); }
  void watch_line();
  void accept_client();
  void turn_away();
  void lose_peer();
  auto make_room() -> bool;
  auto send(std::string_view bytes) -> std::ptrdiff_t;
  [[nodiscard]] auto output() const -> int { return kind_ == Kind::kStdio ? output_.get() : line_.get(); }

  Kind kind_;
  std::string name_;
  FileDescriptor line_;      // what is read: standard input, pty master, client or device
  FileDescriptor output_;    // stdio only
  FileDescriptor listener_;  // tcp only
  std::optional<CharacterMode> character_mode_;
  bool output_may_block_ = false;
  bool attached_ = false;
  bool terminal_ = false;
  bool hung_up_ = false;
  bool stalled_ = false;
  std::string outgoing_;
  std::uint64_t dropped_ = 0;
};

}  // namespace capstan
