// SPDX-License-Identifier: Apache-2.0
// CiA 402 drives that do not exist, on a bus that may: for the firmware of boards/linux_rt.
#include <sched.h>

#include <algorithm>
#include <charconv>
#include <csignal>
#include <exception>
#include <iostream>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "capstan/hal/cia402_sim/drive_bus.hpp"
#include "capstan/hal/linux/can_link.hpp"
#include "capstan/hal/linux/can_socket.hpp"

namespace {

using capstan::CanSocket;
using capstan::cia402::Frame;
using capstan::cia402::Received;

constexpr const char* kUsage =
    "Usage: capstan_drives --can BUS --nodes N[,N...] [OPTION]...\n"
    "\n"
    "CiA 402 drives in cyclic synchronous torque mode on a CAN bus, each with a simulated axis behind it.\n"
    "\n"
    "  --can BUS         an interface (can1), or unix:PATH, where the firmware comes with --can unix:PATH:N,N\n"
    "  --nodes N[,N...]  node numbers, 1 to 126\n"
    "  --bit-rate N      sets the interface's bit rate in bit/s (0: a virtual bus) and brings it up; needs root\n"
    "  --up NAME         brings that interface up too, with the same bit rate (repeatable)\n"
    "  --at S:KIND:NODE  S seconds after the first torque that node does something wrong (repeatable); kinds:\n"
    "                    ";

constexpr const char* kUsagePeculiar =
    "\n"
    "  --with NAME:NODE  that drive is peculiar, as drives on sale are (repeatable); names:\n"
    "                    ";

constexpr const char* kUsageEnd =
    "\n"
    "  --for SECONDS     ends then, otherwise by Ctrl-C, SIGTERM or when the firmware closes unix:PATH\n"
    "  --help\n"
    "\n"
    "Prints when torque comes and goes, in seconds after the first torque. Exit status: 0 done, 2 bad input.\n";

volatile std::sig_atomic_t stop_requested = 0;

extern "C" void request_stop(int /*signal_number*/) {
  stop_requested = 1;
}

struct Options {
  std::string bus;
  std::vector<std::uint8_t> nodes;
  std::vector<capstan::drive_sim::Incident> incidents;
  std::map<std::uint8_t, capstan::drive_sim::Peculiarities> peculiarities;
  std::vector<std::string> others;
  std::optional<std::uint32_t> bit_s;
  double seconds = 0.0;
};

template <typename T>
auto number(const std::string& option, std::string_view text, T lowest, T highest) -> T {
  T value{};
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (problem != std::errc{} || end != text.data() + text.size() || !(value >= lowest && value <= highest)) {
    throw std::runtime_error("'" + std::string(text) + "' is no value for " + option + "; give a number from " +
                             std::to_string(lowest) + " to " + std::to_string(highest));
  }
  return value;
}

auto nodes_of(const std::string& option, std::string_view text) -> std::vector<std::uint8_t> {
  std::vector<std::uint8_t> nodes;
  for (std::size_t start = 0; start <= text.size();) {
    const std::size_t end = std::min(text.find(',', start), text.size());
    nodes.push_back(static_cast<std::uint8_t>(number(option, text.substr(start, end - start), 1, 126)));
    start = end + 1;
  }
  return nodes;
}

/// What is to go wrong with a node that is not there would go wrong nowhere.
void expect_node(const Options& options, const std::string& option, std::uint8_t node) {
  if (std::find(options.nodes.begin(), options.nodes.end(), node) == options.nodes.end()) {
    throw std::runtime_error(option + " names node " + std::to_string(node) +
                             ", which is none of --nodes; give the number of a node that is there");
  }
}

auto options_of(int count, char** words) -> Options {
  Options options;
  for (int i = 1; i < count; ++i) {
    const std::string word = words[i];
    if (i + 1 == count) {
      throw std::runtime_error("'" + word + "' is no option or needs a value; see --help");
    }
    const std::string value = words[++i];
    if (word == "--can") {
      options.bus = value;
    } else if (word == "--nodes") {
      options.nodes = nodes_of(word, value);
    } else if (word == "--at") {
      options.incidents.push_back(capstan::drive_sim::parse_incident(value));
    } else if (word == "--with") {
      const std::size_t colon = std::min(value.find(':'), value.size());
      const auto node = static_cast<std::uint8_t>(
          number(word, std::string_view(value).substr(std::min(colon + 1, value.size())), 1, 126));
      options.peculiarities[node].insert(capstan::drive_sim::parse_peculiarity(value.substr(0, colon)));
    } else if (word == "--up") {
      options.others.push_back(value);
    } else if (word == "--bit-rate") {
      options.bit_s = number<std::uint32_t>(word, value, 0, 1'000'000);
    } else if (word == "--for") {
      options.seconds = number(word, value, 0.001, 1e7);
    } else {
      throw std::runtime_error("'" + word + "' is no option; see --help");
    }
  }
  if (options.bus.empty() || options.nodes.empty()) {
    throw std::runtime_error("a bus or the nodes are missing; see --help");
  }
  std::vector<std::uint8_t> nodes = options.nodes;
  std::sort(nodes.begin(), nodes.end());
  if (const auto twice = std::adjacent_find(nodes.begin(), nodes.end()); twice != nodes.end()) {
    throw std::runtime_error("--nodes names node " + std::to_string(*twice) + " twice; give each drive its own number");
  }
  for (const auto& incident : options.incidents) {
    expect_node(options, "--at", incident.node);
  }
  for (const auto& [node, ways] : options.peculiarities) {
    expect_node(options, "--with", node);
  }
  std::sort(options.incidents.begin(), options.incidents.end(),
            [](const auto& a, const auto& b) { return a.at_s < b.at_s; });
  return options;
}

auto open_bus(const Options& options) -> CanSocket {
  constexpr std::string_view kLocal = "unix:";
  if (options.bus.starts_with(kLocal)) {
    return CanSocket::listen(options.bus.substr(kLocal.size()), std::chrono::seconds(30));
  }
  if (options.bit_s) {
    for (const std::string& other : options.others) {
      capstan::bring_up_can_link(other, *options.bit_s);
    }
    capstan::bring_up_can_link(options.bus, *options.bit_s);
  }
  return CanSocket::open(options.bus, true, false);
}

/// @returns false once the bus is gone
auto take_in(CanSocket& socket, capstan::drive_sim::DriveBus& bus) -> bool {
  for (Received received; socket.rt_receive(received);) {
    if (received.kind == Received::Kind::kEvent && received.event == capstan::cia402::Anomaly::kLinkDown) {
      return false;
    }
    if (received.kind == Received::Kind::kFrame) {
      for (const Frame& answer : bus.receive(received.frame, capstan::monotonic_now())) {
        static_cast<void>(socket.rt_send(answer));  // a drive does not send again either what found no room
      }
    }
  }
  return true;
}

void run(const Options& options) {
  using std::chrono::milliseconds;
  CanSocket socket = open_bus(options);
  // Drives answer at once whatever else the machine does; below the firmware and the interrupts of the controllers.
  const sched_param priority{.sched_priority = 40};
  static_cast<void>(sched_setscheduler(0, SCHED_FIFO, &priority));
  capstan::drive_sim::DriveBus bus(options.nodes, options.incidents, std::cout, options.peculiarities);
  const auto start = capstan::monotonic_now();
  auto next_tick = start;
  bool there = true;
  while (there && stop_requested == 0) {
    const auto now = capstan::monotonic_now();
    if (options.seconds > 0.0 && std::chrono::duration<double>(now - start).count() > options.seconds) {
      break;
    }
    if (now >= next_tick) {
      for (const Frame& frame : bus.tick(now)) {
        static_cast<void>(socket.rt_send(frame));
      }
      next_tick = now + milliseconds(1);
    }
    socket.wait(milliseconds(1));
    there = take_in(socket, bus);
  }
  bus.print_summary();
}

}  // namespace

auto main(int count, char** words) -> int {
  if (count == 2 && std::string(words[1]) == "--help") {
    std::cout << kUsage << capstan::drive_sim::incident_kinds() << kUsagePeculiar
              << capstan::drive_sim::peculiarity_names() << kUsageEnd;
    return 0;
  }
  for (const int signal_number : {SIGINT, SIGTERM}) {
    static_cast<void>(std::signal(signal_number, request_stop));
  }
  try {
    run(options_of(count, words));
    return 0;
  } catch (const std::exception& problem) {
    std::cerr << "capstan_drives: " << problem.what() << '\n';
    return 2;
  }
}
