// SPDX-License-Identifier: Apache-2.0
#include "capstan/hal/linux/can_link.hpp"

#include <linux/can/netlink.h>
#include <linux/if_link.h>
#include <linux/rtnetlink.h>
#include <net/if.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <functional>
#include <stdexcept>

#include "capstan/hal/linux/file_descriptor.hpp"

namespace capstan {
namespace {

constexpr std::uint32_t kLongestQueue = 20;  // frames; two cycles' worth, for what is queued goes out old

/// A request to the kernel about links, and its answer. One attribute after the other, nested ones closed again.
class LinkMessage {
 public:
  LinkMessage(std::uint16_t type, unsigned index) {
    header().nlmsg_len = NLMSG_LENGTH(sizeof(ifinfomsg));
    header().nlmsg_type = type;
    header().nlmsg_flags = NLM_F_REQUEST | NLM_F_ACK;
    info().ifi_family = AF_UNSPEC;
    info().ifi_index = static_cast<int>(index);
  }
  auto header() -> nlmsghdr& { return *reinterpret_cast<nlmsghdr*>(bytes_.data()); }
  auto info() -> ifinfomsg& { return *static_cast<ifinfomsg*>(NLMSG_DATA(&header())); }

  void add(std::uint16_t type, const void* data, std::size_t size) {
    auto* attribute = reinterpret_cast<rtattr*>(bytes_.data() + NLMSG_ALIGN(header().nlmsg_len));
    attribute->rta_type = type;
    attribute->rta_len = static_cast<std::uint16_t>(RTA_LENGTH(size));
    if (size != 0) {
      std::memcpy(RTA_DATA(attribute), data, size);
    }
    header().nlmsg_len = NLMSG_ALIGN(header().nlmsg_len) + static_cast<std::uint32_t>(RTA_ALIGN(attribute->rta_len));
  }
  void nest(std::uint16_t type, const std::function<void()>& inside) {
    const std::size_t start = NLMSG_ALIGN(header().nlmsg_len);
    add(type, nullptr, 0);
    inside();
    reinterpret_cast<rtattr*>(bytes_.data() + start)->rta_len = static_cast<std::uint16_t>(header().nlmsg_len - start);
  }

  /// Sends it and puts the answer in its place. @returns 0 or an errno
  auto exchange() -> int {
    const FileDescriptor socket(::socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC, NETLINK_ROUTE));
    if (!socket || send(socket.get(), bytes_.data(), header().nlmsg_len, 0) < 0) {
      return errno;
    }
    const ssize_t size = recv(socket.get(), bytes_.data(), bytes_.size(), 0);
    if (size < static_cast<ssize_t>(sizeof(nlmsghdr))) {
      return size < 0 ? errno : EBADMSG;
    }
    if (header().nlmsg_type == NLMSG_ERROR) {
      return -static_cast<nlmsgerr*>(NLMSG_DATA(&header()))->error;
    }
    return 0;
  }
  /// Calls `look(type, data)` for the answer's attributes.
  void each(const std::function<void(std::uint16_t, const void*, std::size_t)>& look) {
    each_of(IFLA_RTA(&info()), IFLA_PAYLOAD(&header()), look);
  }
  static void each_of(const void* first, std::size_t size,
                      const std::function<void(std::uint16_t, const void*, std::size_t)>& look) {
    auto* attribute = static_cast<rtattr*>(const_cast<void*>(first));
    for (auto left = static_cast<int>(size); RTA_OK(attribute, left); attribute = RTA_NEXT(attribute, left)) {
      look(attribute->rta_type & NLA_TYPE_MASK, RTA_DATA(attribute), RTA_PAYLOAD(attribute));
    }
  }

 private:
  alignas(nlmsghdr) std::array<char, 16384> bytes_{};
};

void fail(const std::string& what, int error, const std::string& cure) {
  throw std::runtime_error(what + " (" + std::strerror(error) + "); " + cure);
}

template <typename T>
auto as(const void* data, std::size_t size) -> T {
  T value{};
  std::memcpy(&value, data, std::min(size, sizeof value));
  return value;
}

void read_controller(CanLink& link, const void* data, std::size_t size) {
  LinkMessage::each_of(data, size, [&link](std::uint16_t type, const void* value, std::size_t bytes) {
    if (type == IFLA_CAN_BITTIMING) {
      link.rates.nominal_bit_s = as<can_bittiming>(value, bytes).bitrate;
    } else if (type == IFLA_CAN_DATA_BITTIMING) {
      link.rates.data_bit_s = as<can_bittiming>(value, bytes).bitrate;
    } else if (type == IFLA_CAN_RESTART_MS) {
      link.restart_ms = as<std::uint32_t>(value, bytes);
    }
  });
}

auto index_of(const std::string& name) -> unsigned {
  const unsigned index = if_nametoindex(name.c_str());
  if (index == 0) {
    fail("There is no CAN interface " + name, errno, "ip link shows those that exist");
  }
  return index;
}

void change(LinkMessage& message, const std::string& what) {
  if (const int error = message.exchange(); error != 0) {
    fail(what, error, "do it as root, with the interface down, and with a bit rate that the controller has");
  }
}

}  // namespace

auto read_can_link(const std::string& name) -> CanLink {
  LinkMessage message(RTM_GETLINK, index_of(name));
  message.header().nlmsg_flags = NLM_F_REQUEST;
  if (const int error = message.exchange(); error != 0) {
    fail("The kernel does not describe " + name, error, "use a kernel from 5.10 on");
  }
  CanLink link;
  link.name = name;
  link.up = (message.info().ifi_flags & IFF_UP) != 0;
  message.each([&link](std::uint16_t type, const void* data, std::size_t size) {
    if (type == IFLA_TXQLEN) {
      link.send_queue = as<std::uint32_t>(data, size);
    } else if (type == IFLA_LINKINFO) {
      LinkMessage::each_of(data, size, [&link](std::uint16_t inner, const void* value, std::size_t bytes) {
        if (inner == IFLA_INFO_KIND) {
          link.kind = std::string(static_cast<const char*>(value), bytes == 0 ? 0 : bytes - 1);
        } else if (inner == IFLA_INFO_DATA) {
          read_controller(link, value, bytes);
        }
      });
    }
  });
  return link;
}

auto objection_to(const CanLink& link, bool fd) -> std::string {
  const bool controller = link.kind == "can";
  if (!link.up) {
    return link.name + " is down; ip link set " + link.name + " up type can bitrate 1000000 restart-ms 0";
  }
  if (link.restart_ms != 0) {
    return link.name + " goes back on the bus by itself " + std::to_string(link.restart_ms) +
           " ms after bus-off, but a bus that failed is to be started by a person; ip link set " + link.name +
           " type can restart-ms 0";
  }
  if (link.send_queue > kLongestQueue) {
    return link.name + " keeps up to " + std::to_string(link.send_queue) +
           " messages to be sent, which would be old set values; ip link set " + link.name + " txqueuelen 10";
  }
  if (controller && fd && link.rates.data_bit_s == 0) {
    return link.name + " has no second bit rate for --fd; ip link set " + link.name +
           " type can bitrate 1000000 dbitrate 5000000 fd on";
  }
  return "";
}

void bring_up_can_link(const std::string& name, std::uint32_t bit_s) {
  const unsigned index = index_of(name);
  LinkMessage setting(RTM_NEWLINK, index);
  if (bit_s != 0) {
    setting.nest(IFLA_LINKINFO, [&] {
      setting.add(IFLA_INFO_KIND, "can", 3);
      setting.nest(IFLA_INFO_DATA, [&] {
        can_bittiming timing{};
        timing.bitrate = bit_s;
        const std::uint32_t restart_ms = 0;
        setting.add(IFLA_CAN_BITTIMING, &timing, sizeof timing);
        setting.add(IFLA_CAN_RESTART_MS, &restart_ms, sizeof restart_ms);
      });
    });
  }
  constexpr std::uint32_t kQueue = 10;
  setting.add(IFLA_TXQLEN, &kQueue, sizeof kQueue);
  change(setting, name + " can not be set up");
  LinkMessage up(RTM_NEWLINK, index);
  up.info().ifi_flags = IFF_UP;
  up.info().ifi_change = IFF_UP;
  change(up, name + " can not be brought up");
}

}  // namespace capstan
