// SPDX-License-Identifier: Apache-2.0
#include "capstan/boards/linux_rt/can_report.hpp"

#include <algorithm>
#include <cstring>
#include <iomanip>

namespace capstan {
namespace {

using cia402::Anomaly;
using cia402::Journal;

/// What the journal's detail is for this anomaly, in words; empty if there is nothing to say.
auto detail_text(Anomaly anomaly, std::uint32_t detail) -> std::string {
  const auto hex = [](std::uint32_t value) {
    std::array<char, 12> text{};
    static_cast<void>(std::snprintf(text.data(), text.size(), "%04Xh", value));
    return std::string(text.data());
  };
  switch (anomaly) {
    case Anomaly::kStatusLength:
    case Anomaly::kHeartbeatLength:
    case Anomaly::kEmergencyLength:
    case Anomaly::kSdoLength:
      return std::to_string(detail) + " bytes";
    case Anomaly::kStatusUnknown:
    case Anomaly::kDriveFault:
    case Anomaly::kDroppedOut:
    case Anomaly::kNotEnabled:
    case Anomaly::kAnswersLate:
    case Anomaly::kModeUnknown:
      return "statusword " + hex(detail);
    case Anomaly::kUnknownId:
    case Anomaly::kRemoteFrame:
    case Anomaly::kExtendedFrame:
      return "identifier " + hex(detail);
    case Anomaly::kNotOperational:
    case Anomaly::kHeartbeatState:
      return "state " + std::to_string(detail);
    case Anomaly::kWrongMode:
      return "mode " + std::to_string(detail);
    case Anomaly::kSdoOtherObject:
    case Anomaly::kSdoSize:
    case Anomaly::kSdoTimeout:
      return "object " + hex(detail);
    case Anomaly::kLinkDown:
    case Anomaly::kSendFailed:
    case Anomaly::kSendQueueFull:
    case Anomaly::kReceiveFailed:
      return detail == 0 ? "the other end closed it" : std::strerror(static_cast<int>(detail));
    case Anomaly::kReceiveLost:
      return std::to_string(detail) + " messages";
    default:
      return "";
  }
}

void say_who(std::ostream& out, const CanBus& bus, std::size_t source) {
  out << bus.name();
  if (source != Journal::kBus) {
    out << ", drive " << static_cast<int>(bus.master().drive(source - 1).setting().node);
  }
  out << ": ";
}

}  // namespace

void print_counters(Print& out, const CanBus& bus) {
  const Journal& journal = bus.journal();
  out << std::string_view(bus.name()) << ':';
  for (std::size_t i = 0; i < bus.master().drives(); ++i) {
    const cia402::DriveLink& drive = bus.master().drive(i);
    out << (i == 0 ? " drive " : ", drive ") << std::uint32_t{drive.setting().node} << ' ' << name(drive.state());
  }
  out << "\r\n";
  for (std::size_t i = 0; i < cia402::kAnomalies; ++i) {
    const auto anomaly = static_cast<Anomaly>(i);
    if (const std::uint32_t count = journal.count(anomaly); count != 0) {
      out << "  " << count << " x " << cia402::info(anomaly).name << ": " << cia402::info(anomaly).sentence << "\r\n";
    }
  }
}

void CanReport::say_emergencies(std::ostream& out, const CanBus& bus, std::size_t source) {
  std::uint32_t& said = said_[source][static_cast<std::size_t>(Anomaly::kEmergency)];
  const std::uint32_t count = bus.journal().count(Anomaly::kEmergency, source);
  const auto kept = static_cast<std::uint32_t>(Journal::kEmergencies);
  for (said = std::max(said, count > kept ? count - kept : 0); said != count; ++said) {
    const cia402::Emergency emergency = bus.journal().emergency(source, said);
    say_who(out, bus, source);
    out << "emergency message " << std::hex << std::uppercase << std::setw(4) << std::setfill('0') << emergency.code
        << std::dec << "h, " << cia402::emergency_text(emergency.code) << "; " << cia402::info(Anomaly::kEmergency).cure
        << '\n';
  }
}

void CanReport::say_news(std::ostream& out, const CanBus& bus) {
  for (std::size_t source = 0; source <= bus.master().drives(); ++source) {
    say_emergencies(out, bus, source);
    for (std::size_t i = 0; i < cia402::kAnomalies; ++i) {
      const auto anomaly = static_cast<Anomaly>(i);
      const std::uint32_t count = bus.journal().count(anomaly, source);
      std::uint32_t& said = said_[source][i];
      if (count == said || count < 2 * said) {
        continue;
      }
      const cia402::AnomalyInfo& entry = cia402::info(anomaly);
      const std::string detail = detail_text(anomaly, bus.journal().detail(anomaly, source));
      say_who(out, bus, source);
      out << entry.sentence << (detail.empty() ? "" : " (" + detail + ')');
      if (count > 1) {
        out << ", " << count << " times by now";
      }
      out << "; " << entry.cure << '\n';
      said = count;
    }
  }
  out << std::flush;
}

}  // namespace capstan
