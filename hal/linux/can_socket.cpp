// SPDX-License-Identifier: Apache-2.0
#include "capstan/hal/linux/can_socket.hpp"

#include <fcntl.h>
#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <stdexcept>
#include <vector>

namespace capstan {
namespace {

using cia402::Anomaly;
using cia402::Frame;
using cia402::Received;
using cia402::Time;

auto now_on(clockid_t clock) -> Time {
  timespec time{};
  static_cast<void>(clock_gettime(clock, &time));
  return std::chrono::seconds(time.tv_sec) + std::chrono::nanoseconds(time.tv_nsec);
}

[[noreturn]] void fail(const std::string& what, const std::string& cure) {
  throw std::runtime_error(what + " (" + std::strerror(errno) + "); " + cure);
}

template <typename T>
void set_option(int socket, int level, int option, const T& value) {
  if (setsockopt(socket, level, option, &value, sizeof value) != 0) {
    fail("The CAN socket refuses an option", "use a kernel from 5.10 on");
  }
}

auto local_address(const std::string& path) -> sockaddr_un {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.empty() || path.size() >= sizeof address.sun_path) {
    throw std::runtime_error("'" + path + "' is no path for a local socket; take one of 1 to 107 characters");
  }
  path.copy(address.sun_path, path.size());
  return address;
}

auto local_socket() -> FileDescriptor {
  FileDescriptor socket(::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  if (!socket) {
    fail("A local socket can not be made", "close other programs");
  }
  return socket;
}

// The worst of what an error frame says (linux/can/error.h).
auto event_of(const canfd_frame& error) -> Anomaly {
  const std::uint8_t controller = error.data[1];
  if ((error.can_id & CAN_ERR_BUSOFF) != 0) {
    return Anomaly::kBusOff;
  }
  if ((error.can_id & CAN_ERR_RESTARTED) != 0) {
    return Anomaly::kControllerRestarted;
  }
  if ((error.can_id & CAN_ERR_CRTL) != 0) {
    if ((controller & (CAN_ERR_CRTL_RX_OVERFLOW | CAN_ERR_CRTL_TX_OVERFLOW)) != 0) {
      return Anomaly::kControllerOverflow;
    }
    if ((controller & (CAN_ERR_CRTL_RX_PASSIVE | CAN_ERR_CRTL_TX_PASSIVE)) != 0) {
      return Anomaly::kErrorPassive;
    }
    if ((controller & (CAN_ERR_CRTL_RX_WARNING | CAN_ERR_CRTL_TX_WARNING)) != 0) {
      return Anomaly::kErrorWarning;
    }
  }
  return (error.can_id & CAN_ERR_ACK) != 0 ? Anomaly::kNoAcknowledge : Anomaly::kBusError;
}

auto frame_of(const canfd_frame& raw, bool fd) -> Frame {
  Frame frame;
  frame.extended = (raw.can_id & CAN_EFF_FLAG) != 0;
  frame.remote = (raw.can_id & CAN_RTR_FLAG) != 0;
  frame.id = raw.can_id & (frame.extended ? CAN_EFF_MASK : CAN_SFF_MASK);
  frame.fd = fd;
  frame.size = std::min<std::uint8_t>(raw.len, fd ? CANFD_MAX_DLEN : CAN_MAX_DLEN);
  std::copy_n(raw.data, frame.size, frame.data.begin());
  return frame;
}

auto anomaly_of_send(int error) -> Anomaly {
  switch (error) {
    case ENOBUFS:
    case EAGAIN:
      return Anomaly::kSendQueueFull;
    case ENETDOWN:
    case ENODEV:
    case ENXIO:
    case EPIPE:
    case ECONNRESET:
      return Anomaly::kLinkDown;
    default:
      return Anomaly::kSendFailed;
  }
}

}  // namespace

auto monotonic_now() -> Time {
  return now_on(CLOCK_MONOTONIC);
}

auto CanSocket::open(const std::string& name, bool fd, bool confirms) -> CanSocket {
  constexpr std::string_view kLocal = "unix:";
  if (name.starts_with(kLocal)) {
    FileDescriptor socket = local_socket();
    const sockaddr_un address = local_address(name.substr(kLocal.size()));
    if (connect(socket.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
      fail("Nothing listens at " + name, "start capstan_drives there first");
    }
    return {std::move(socket), false};
  }
  FileDescriptor socket(::socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW));
  if (!socket) {
    fail("This kernel has no CAN", "load its modules (modprobe can_raw) or use a kernel that has them");
  }
  const unsigned index = if_nametoindex(name.c_str());
  if (index == 0) {
    fail("There is no CAN interface " + name, "ip link shows those that exist");
  }
  const can_err_mask_t errors = CAN_ERR_MASK;
  set_option(socket.get(), SOL_CAN_RAW, CAN_RAW_ERR_FILTER, errors);
  set_option(socket.get(), SOL_CAN_RAW, CAN_RAW_RECV_OWN_MSGS, confirms ? 1 : 0);
  set_option(socket.get(), SOL_CAN_RAW, CAN_RAW_FD_FRAMES, fd ? 1 : 0);
  set_option(socket.get(), SOL_SOCKET, SO_RXQ_OVFL, 1);
  set_option(socket.get(), SOL_SOCKET, SO_TIMESTAMPNS, 1);
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = static_cast<int>(index);
  if (bind(socket.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    fail(name + " cannot be used for CAN", "give a CAN interface that is up");
  }
  return {std::move(socket), confirms};
}

auto CanSocket::listen(const std::string& path, std::chrono::milliseconds patience) -> CanSocket {
  const FileDescriptor door = local_socket();
  const sockaddr_un address = local_address(path);
  if (bind(door.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 ||
      ::listen(door.get(), 1) != 0) {
    fail("Cannot listen on " + path, "remove the file that is there, or take another path");
  }
  pollfd ready{.fd = door.get(), .events = POLLIN, .revents = 0};
  const int arrived = poll(&ready, 1, static_cast<int>(patience.count()));
  FileDescriptor socket(arrived == 1 ? accept4(door.get(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC) : -1);
  static_cast<void>(unlink(path.c_str()));
  if (!socket) {
    throw std::runtime_error("Nothing connected to " + path + " in time; start the firmware with --can unix:" + path +
                             ":...");
  }
  return {std::move(socket), false};
}

auto CanSocket::pair(Clock clock) -> std::pair<CanSocket, CanSocket> {
  std::array<int, 2> ends{};
  if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, ends.data()) != 0) {
    fail("A local bus can not be made", "close other programs");
  }
  return {CanSocket(FileDescriptor(ends[0]), false, clock), CanSocket(FileDescriptor(ends[1]), false, clock)};
}

void CanSocket::filter(std::span<const std::uint32_t> ids) {
  if (!confirms_) {
    return;
  }
  // Filters of this form are in the kernel's indexed list: their number costs nothing
  // (Documentation/networking/can.rst).
  std::vector<can_filter> filters;
  for (const std::uint32_t id : ids) {
    filters.push_back({id, CAN_EFF_FLAG | CAN_RTR_FLAG | CAN_SFF_MASK});
  }
  if (setsockopt(socket_.get(), SOL_CAN_RAW, CAN_RAW_FILTER, filters.data(),
                 static_cast<socklen_t>(filters.size() * sizeof(can_filter))) != 0) {
    fail("The CAN socket refuses its filters", "use a kernel from 5.10 on");
  }
}

auto CanSocket::rt_send(const Frame& frame) -> std::optional<Received> {
  canfd_frame raw{};
  raw.can_id = frame.id | (frame.extended ? CAN_EFF_FLAG : 0U) | (frame.remote ? CAN_RTR_FLAG : 0U);
  raw.len = frame.size;
  raw.flags = frame.fd ? CANFD_BRS : 0;
  std::copy_n(frame.data.begin(), frame.size, raw.data);
  const std::size_t bytes = frame.fd ? CANFD_MTU : CAN_MTU;
  if (::send(socket_.get(), &raw, bytes, MSG_DONTWAIT | MSG_NOSIGNAL) == static_cast<ssize_t>(bytes)) {
    return std::nullopt;
  }
  return Received{.kind = Received::Kind::kEvent,
                  .frame = {},
                  .event = anomaly_of_send(errno),
                  .detail = static_cast<std::uint32_t>(errno),
                  .at = now()};
}

auto CanSocket::rt_failed(Received& received, int error) -> bool {
  if (error == EAGAIN || error == EINTR || down_) {
    return false;
  }
  down_ = error == 0 || error == ENETDOWN || error == ENODEV || error == ECONNRESET;
  received.kind = Received::Kind::kEvent;
  received.event = down_ ? Anomaly::kLinkDown : Anomaly::kReceiveFailed;
  received.detail = static_cast<std::uint32_t>(error);
  received.at = now();
  return true;
}

/// When it arrived, and how many the kernel has dropped before.
void CanSocket::rt_note_control(msghdr& message, Received& received) {
  received.at = now();
  for (cmsghdr* entry = CMSG_FIRSTHDR(&message); entry != nullptr; entry = CMSG_NXTHDR(&message, entry)) {
    if (entry->cmsg_level == SOL_SOCKET && entry->cmsg_type == SCM_TIMESTAMPNS) {
      timespec stamp{};
      std::memcpy(&stamp, CMSG_DATA(entry), sizeof stamp);
      // The kernel stamps in calendar time; what counts here is how long ago that was.
      const Time age = now_on(CLOCK_REALTIME) - std::chrono::seconds(stamp.tv_sec) - Time(stamp.tv_nsec);
      received.at -= std::max(age, Time{});
    } else if (entry->cmsg_level == SOL_SOCKET && entry->cmsg_type == SO_RXQ_OVFL) {
      std::memcpy(&lost_, CMSG_DATA(entry), sizeof lost_);
    }
  }
}

auto CanSocket::rt_receive(Received& received) -> bool {
  if (lost_ != reported_lost_) {
    received = {.kind = Received::Kind::kEvent,
                .frame = {},
                .event = Anomaly::kReceiveLost,
                .detail = lost_ - reported_lost_,
                .at = now()};
    reported_lost_ = lost_;
    return true;
  }
  canfd_frame raw{};
  alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(timespec)) + CMSG_SPACE(sizeof(std::uint32_t))> control{};
  iovec part{.iov_base = &raw, .iov_len = sizeof raw};
  msghdr message{};
  message.msg_iov = &part;
  message.msg_iovlen = 1;
  message.msg_control = control.data();
  message.msg_controllen = control.size();
  const ssize_t bytes = recvmsg(socket_.get(), &message, MSG_DONTWAIT);
  if (bytes != static_cast<ssize_t>(CAN_MTU) && bytes != static_cast<ssize_t>(CANFD_MTU)) {
    return rt_failed(received, bytes < 0 ? errno : bytes == 0 ? 0 : EBADMSG);
  }
  rt_note_control(message, received);
  if ((raw.can_id & CAN_ERR_FLAG) != 0) {
    received.kind = Received::Kind::kEvent;
    received.event = event_of(raw);
    received.detail = raw.can_id & CAN_ERR_MASK;
    return true;
  }
  received.kind = (message.msg_flags & MSG_CONFIRM) != 0 ? Received::Kind::kSent : Received::Kind::kFrame;
  received.frame = frame_of(raw, bytes == static_cast<ssize_t>(CANFD_MTU));
  return true;
}

void CanSocket::wait(std::chrono::milliseconds patience) const {
  pollfd ready{.fd = socket_.get(), .events = POLLIN, .revents = 0};
  static_cast<void>(poll(&ready, 1, static_cast<int>(patience.count())));
}

}  // namespace capstan
