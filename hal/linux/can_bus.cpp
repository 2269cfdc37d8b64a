// SPDX-License-Identifier: Apache-2.0
#include "capstan/hal/linux/can_bus.hpp"

#include <array>
#include <stdexcept>

#include "capstan/hal/cia402/drive_setup.hpp"
#include "capstan/hal/linux/can_link.hpp"

namespace capstan {
namespace {

using cia402::DriveSetup;
using cia402::Received;

// Where nobody says what the bit rates are: a local socket or vcan. What a usual controller is set to.
constexpr std::uint32_t kUsualBitS = 1'000'000;
constexpr std::uint32_t kUsualDataBitS = 5'000'000;
constexpr std::string_view kLocal = "unix:";

auto rates_of(const CanBusSetup& bus, const CanSetup& setup) -> cia402::BitRates {
  cia402::BitRates rates{0, 0};
  if (!bus.name.starts_with(kLocal)) {
    const CanLink link = read_can_link(bus.name);
    if (const std::string objection = objection_to(link, setup.fd); !objection.empty()) {
      throw std::runtime_error(objection);
    }
    rates = link.rates;
  }
  rates.nominal_bit_s = rates.nominal_bit_s == 0 ? kUsualBitS : rates.nominal_bit_s;
  rates.data_bit_s = !setup.fd ? 0 : rates.data_bit_s == 0 ? kUsualDataBitS : rates.data_bit_s;
  return rates;
}

auto checked_socket(const CanBusSetup& bus, const CanSetup& setup, std::ostream& out) -> CanSocket {
  const cia402::BitRates rates = rates_of(bus, setup);
  const cia402::BusBudget budget = cia402::bus_budget(setup.layout, bus.nodes.size(), rates);
  out << budget_line(bus.name, bus.nodes.size(), budget, rates) << '\n';
  return CanSocket::open(bus.name, setup.fd, true);
}

[[noreturn]] void refuse(const std::string& bus, const Received& event) {
  const cia402::AnomalyInfo& entry = cia402::info(event.event);
  throw std::runtime_error(bus + ": " + entry.sentence + "; " + entry.cure);
}

auto ends_set_up(cia402::Anomaly event) -> bool {
  return event == cia402::Anomaly::kBusOff || event == cia402::Anomaly::kLinkDown ||
         event == cia402::Anomaly::kSendFailed || event == cia402::Anomaly::kSendQueueFull;
}

/// Until the drive has come to this phase.
void lead(CanSocket& socket, const std::string& bus, const CanSetup& setup, DriveSetup& drive,
          DriveSetup::Phase phase) {
  constexpr std::chrono::milliseconds kLookAround{2};
  while (drive.phase() != phase) {
    if (setup.interrupted != nullptr && setup.interrupted()) {
      throw SetUpInterrupted(bus + ": ended while the drives were set up, and they were taken out of operation");
    }
    if (const auto request = drive.next(socket.now())) {
      if (const auto problem = socket.rt_send(*request)) {
        refuse(bus, *problem);
      }
    }
    if (drive.phase() == DriveSetup::Phase::kFailed) {
      throw std::runtime_error(bus + ": " + drive.problem());
    }
    socket.wait(kLookAround);
    for (Received received; socket.rt_receive(received);) {
      if (received.kind == Received::Kind::kFrame) {
        drive.receive(received.frame);
      } else if (received.kind == Received::Kind::kEvent && ends_set_up(received.event)) {
        refuse(bus, received);
      }
    }
  }
}

/// Drives that need more messages than were planned for need more of the bus.
void check_budget(std::span<const cia402::DriveSetting> settings, const CanBusSetup& bus, const CanSetup& setup,
                  std::ostream& out) {
  std::vector<cia402::DriveMaps> maps;
  for (const cia402::DriveSetting& setting : settings) {
    maps.push_back(setting.maps);
  }
  const cia402::BitRates rates = rates_of(bus, setup);
  const cia402::BusBudget budget = cia402::bus_budget(setup.layout, maps, rates);
  if (budget.frames != cia402::bus_budget(setup.layout, maps.size(), rates).frames) {
    out << budget_line(bus.name, maps.size(), budget, rates) << '\n';
  }
}

void take_out_of_operation(CanSocket& socket, std::span<const std::uint8_t> nodes) {
  for (const std::uint8_t node : nodes) {
    static_cast<void>(socket.rt_send(cia402::nmt_frame(cia402::NmtCommand::kPreOperational, node)));
  }
}

auto set_up_each(CanSocket& socket, const CanBusSetup& bus, const CanSetup& setup, cia402::Journal& journal,
                 std::ostream& out) -> std::vector<cia402::DriveSetting> {
  std::vector<std::unique_ptr<DriveSetup>> drives;
  std::vector<cia402::DriveSetting> settings;
  for (std::size_t place = 0; place < bus.nodes.size(); ++place) {
    const cia402::SetupTask task{.node = bus.nodes[place],
                                 .layout = setup.layout,
                                 .place = place,
                                 .drives = bus.nodes.size(),
                                 .watchdog = setup.watchdog,
                                 .profiles = setup.profiles};
    drives.push_back(std::make_unique<DriveSetup>(task, journal, place + 1));
    lead(socket, bus.name, setup, *drives.back(), DriveSetup::Phase::kReady);
    for (const std::string& note : drives.back()->notes()) {
      out << bus.name << ": " << note << '\n';
    }
    settings.push_back(drives.back()->setting());
  }
  check_budget(settings, bus, setup, out);
  for (const auto& drive : drives) {
    drive->start();
    lead(socket, bus.name, setup, *drive, DriveSetup::Phase::kDone);
  }
  std::array<std::uint32_t, cia402::kMostWantedIds> ids{};
  socket.filter(std::span(ids).first(cia402::wanted_ids(settings, ids)));
  for (Received received; socket.rt_receive(received);) {
  }
  return settings;
}

auto set_up_all(CanSocket& socket, const CanBusSetup& bus, const CanSetup& setup, cia402::Journal& journal,
                std::ostream& out) -> std::vector<cia402::DriveSetting> {
  try {
    return set_up_each(socket, bus, setup, journal, out);
  } catch (...) {
    take_out_of_operation(socket, bus.nodes);
    throw;
  }
}

}  // namespace

auto budget_line(const std::string& bus, std::size_t drives, const cia402::BusBudget& budget,
                 const cia402::BitRates& rates) -> std::string {
  const auto us = [](std::uint64_t time_ns) { return std::to_string((time_ns + 999) / 1000) + " us"; };
  const std::uint64_t percent = (budget.with_retransmission_ns() * 100 + budget.kCycleNs - 1) / budget.kCycleNs;
  const std::string line = bus + ": " + std::to_string(drives) + " drives at " +
                           std::to_string(rates.nominal_bit_s / 1000) + " kbit/s" +
                           (rates.data_bit_s != 0 ? " and " + std::to_string(rates.data_bit_s / 1000) : "") + ", " +
                           std::to_string(budget.frames) + " messages a cycle, at most " + us(budget.cyclic_ns) + ", " +
                           us(budget.with_retransmission_ns()) + " with one of them again: " + std::to_string(percent) +
                           " % of a cycle, of " + std::to_string(budget.kMostPercent) + " % that are allowed";
  if (!budget.fits()) {
    throw std::runtime_error(line +
                             "; give some drives a second bus (--can can1:NODES), let them share a message "
                             "(--pdo packed), use CAN FD (--fd), or raise the bit rate");
  }
  return line;
}

CanBus::CanBus(const CanBusSetup& bus, const CanSetup& setup, std::ostream& out)
    : CanBus(checked_socket(bus, setup, out), bus, setup, out) {}

CanBus::CanBus(CanSocket socket, const CanBusSetup& bus, const CanSetup& setup, std::ostream& out)
    : name_(bus.name),
      socket_(std::move(socket)),
      journal_(std::make_unique<cia402::Journal>()),
      settings_(set_up_all(socket_, bus, setup, *journal_, out)),
      master_(settings_, {.layout = setup.layout, .fd = setup.fd, .confirms = socket_.confirms()}, *journal_) {}

CanBus::~CanBus() {
  std::vector<std::uint8_t> nodes;
  for (const cia402::DriveSetting& drive : settings_) {
    nodes.push_back(drive.node);
  }
  take_out_of_operation(socket_, nodes);
}

void CanBus::catch_up() {
  for (Received received; socket_.rt_receive(received);) {
    master_.rt_receive(received);
  }
}

void CanBus::rt_receive(std::span<AxisSensed> axes) {
  constexpr std::size_t kMostInACycle = 24;  // a bus of 1 Mbit/s carries at most 21 in a millisecond
  Received received;
  std::size_t count = 0;
  while (count < kMostInACycle && socket_.rt_receive(received)) {
    master_.rt_receive(received);
    ++count;
  }
  const cia402::Time now = socket_.now();
  if (count == kMostInACycle) {
    received = {.kind = Received::Kind::kEvent, .frame = {}, .event = cia402::Anomaly::kFlood, .detail = 0, .at = now};
    master_.rt_receive(received);
  }
  master_.rt_sense(now, axes);
}

auto CanBus::rt_send(bool torque) -> bool {
  const cia402::Time now = socket_.now();
  const cia402::BusMaster::Outbox out = master_.rt_messages(torque, now);
  for (std::size_t i = 0; i < out.count; ++i) {
    if (const auto problem = socket_.rt_send(out.frames[i])) {
      master_.rt_receive(*problem);  // and no SYNC: a drive that lacks its new set value must not act on the old one
      return false;
    }
  }
  if (out.count != 0) {
    master_.rt_sync_sent(now);
  }
  return out.count != 0;
}

}  // namespace capstan
