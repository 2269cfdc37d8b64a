// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/socket.h>

#include <optional>
#include <span>
#include <string>
#include <utility>

#include "capstan/hal/cia402/bus_master.hpp"
#include "capstan/hal/linux/file_descriptor.hpp"

namespace capstan {

/// Now, on CLOCK_MONOTONIC.
auto monotonic_now() -> cia402::Time;

/// One end of a CAN bus: a SocketCAN interface, or a local socket that carries the same frames where there is no CAN.
/// Never waits. What the kernel or the controller reports comes out as events between the frames.
class CanSocket {
 public:
  /// `name`: an interface (can0) or unix:PATH, where a drive simulator listens. Receives everything until filtered.
  /// Throws std::runtime_error with "sentence; cure".
  /// @param confirms  our own frames come back as Received::Kind::kSent when they have left; not on a local socket
  static auto open(const std::string& name, bool fd, bool confirms) -> CanSocket;
  /// For the simulator's end of unix:PATH: waits for the other one, at most this long.
  static auto listen(const std::string& path, std::chrono::milliseconds patience) -> CanSocket;
  using Clock = cia402::Time (*)();
  /// Two ends of one bus, for tests; their time is this clock's.
  static auto pair(Clock clock) -> std::pair<CanSocket, CanSocket>;

  /// From now on only data frames with exactly these 11-bit identifiers, filtered by the kernel; of a local socket
  /// everything still comes.
  void filter(std::span<const std::uint32_t> ids);

  /// @returns what went wrong, as an event; a frame that was not sent is not sent later
  auto rt_send(const cia402::Frame& frame) -> std::optional<cia402::Received>;
  /// False: nothing has arrived.
  auto rt_receive(cia402::Received& received) -> bool;
  /// Waits until something has arrived, at most this long. Not for the cycle.
  void wait(std::chrono::milliseconds patience) const;

  [[nodiscard]] auto now() const -> cia402::Time { return clock_(); }
  [[nodiscard]] auto confirms() const -> bool { return confirms_; }

 private:
  CanSocket(FileDescriptor socket, bool confirms, Clock clock = monotonic_now)
      : socket_(std::move(socket)), confirms_(confirms), clock_(clock) {}
  auto rt_failed(cia402::Received& received, int error) -> bool;
  void rt_note_control(msghdr& message, cia402::Received& received);

  FileDescriptor socket_;
  bool confirms_;
  Clock clock_;
  bool down_ = false;
  std::uint32_t lost_ = 0;  // by the kernel since the socket was opened
  std::uint32_t reported_lost_ = 0;
};

}  // namespace capstan
