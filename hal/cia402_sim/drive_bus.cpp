// SPDX-License-Identifier: Apache-2.0
#include "capstan/hal/cia402_sim/drive_bus.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <iomanip>
#include <stdexcept>

namespace capstan::drive_sim {
namespace {

constexpr std::array<const char*, 13> kNames = {
    "silence",         "no-heartbeat",  "short-status",    "double-status", "bad-status",   "fault", "restart",
    "short-heartbeat", "bad-heartbeat", "short-emergency", "foreign-sync",  "foreign-node", "flood"};

auto name(Mischief mischief) -> const char* {
  return kNames[static_cast<std::size_t>(mischief)];
}

auto in_ms(Time time) -> double {
  return std::chrono::duration<double, std::milli>(time).count();
}

template <typename T>
auto number(std::string_view text, T& value) -> bool {
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
  return problem == std::errc{} && end == text.data() + text.size();
}

}  // namespace

auto incident_kinds() -> std::string {
  std::string list;
  for (const char* kind : kNames) {
    list += std::string(list.empty() ? "" : ", ") + kind;
  }
  return list;
}

auto parse_incident(const std::string& text) -> Incident {
  const std::size_t first = text.find(':');
  const std::size_t second = text.find(':', first == std::string::npos ? first : first + 1);
  Incident incident;
  int node = 0;
  if (second == std::string::npos || !number(std::string_view(text).substr(0, first), incident.at_s) ||
      !(incident.at_s >= 0.0 && std::isfinite(incident.at_s)) ||
      !number(std::string_view(text).substr(second + 1), node) || node < 1 || node > cia402::kLastNode) {
    throw std::runtime_error("'" + text + "' is no incident; write SECONDS:KIND:NODE, as in 2.5:silence:1");
  }
  const std::string kind = text.substr(first + 1, second - first - 1);
  const auto* const found = std::find(kNames.begin(), kNames.end(), kind);
  if (found == kNames.end()) {
    throw std::runtime_error("'" + kind + "' is nothing that can happen; choose one of " + incident_kinds());
  }
  incident.mischief = static_cast<Mischief>(found - kNames.begin());
  incident.node = static_cast<std::uint8_t>(node);
  return incident;
}

DriveBus::DriveBus(std::span<const std::uint8_t> nodes, std::vector<Incident> incidents, std::ostream& out,
                   const std::map<std::uint8_t, Peculiarities>& peculiarities)
    : enabled_(nodes.size()), waiting_(std::move(incidents)), out_(out) {
  for (const std::uint8_t node : nodes) {
    const auto found = peculiarities.find(node);
    drives_.emplace_back(node, sim::PlantParameters{}, node,
                         found == peculiarities.end() ? Peculiarities{} : found->second);
  }
}

auto DriveBus::suffers(std::uint8_t node, Mischief mischief) const -> bool {
  return std::any_of(active_.begin(), active_.end(),
                     [&](const Incident& incident) { return incident.node == node && incident.mischief == mischief; });
}

auto DriveBus::since_s(Time now) const -> double {
  return began_ ? std::chrono::duration<double>(now - *began_).count() : 0.0;
}

auto DriveBus::receive(const Frame& frame, Time now) -> std::vector<Frame> {
  if (frame.id == 0x080) {
    ++syncs_;
    if (last_sync_ && began_) {
      shortest_ = std::min(shortest_, now - *last_sync_);
      longest_ = std::max(longest_, now - *last_sync_);
    }
    last_sync_ = now;
  }
  std::vector<Frame> out;
  for (SimulatedDrive& drive : drives_) {
    std::vector<Frame> answers;
    drive.receive(frame, now, answers);
    answers = spoil(drive, std::move(answers));
    out.insert(out.end(), answers.begin(), answers.end());
  }
  watch(now);
  return out;
}

auto DriveBus::tick(Time now) -> std::vector<Frame> {
  std::vector<Frame> out;
  while (!waiting_.empty() && began_ && since_s(now) >= waiting_.front().at_s) {
    strike(waiting_.front(), now, out);
    waiting_.erase(waiting_.begin());
  }
  for (SimulatedDrive& drive : drives_) {
    std::vector<Frame> frames;
    drive.tick(now, frames);
    frames = spoil(drive, std::move(frames));
    out.insert(out.end(), frames.begin(), frames.end());
  }
  go_on(now, out);
  watch(now);
  return out;
}

void DriveBus::strike(const Incident& incident, Time now, std::vector<Frame>& out) {
  active_.push_back(incident);
  struck_ = now;
  syncs_at_strike_ = syncs_;
  out_ << std::fixed << std::setprecision(3) << since_s(now) << " s: " << name(incident.mischief) << ", node "
       << static_cast<int>(incident.node) << '\n'
       << std::flush;
  for (SimulatedDrive& drive : drives_) {
    if (drive.node() == incident.node && incident.mischief == Mischief::kFault) {
      drive.fail(0x2310, out);
    } else if (drive.node() == incident.node && incident.mischief == Mischief::kRestart) {
      drive.restart();
    }
  }
}

auto DriveBus::spoil(const SimulatedDrive& drive, std::vector<Frame> frames) const -> std::vector<Frame> {
  const std::uint8_t node = drive.node();
  const auto is = [&](const Frame& frame, std::uint32_t base) { return frame.id == base + node; };
  if (suffers(node, Mischief::kSilence)) {
    return {};
  }
  if (suffers(node, Mischief::kNoHeartbeat)) {
    std::erase_if(frames, [&](const Frame& frame) { return is(frame, 0x700); });
  }
  const std::size_t count = frames.size();
  for (std::size_t i = 0; i < count; ++i) {
    if (is(frames[i], 0x180) && suffers(node, Mischief::kShortStatus)) {
      frames[i].size = 3;
    } else if (is(frames[i], 0x180) && suffers(node, Mischief::kBadStatus)) {
      frames[i].data[0] = 0x4F;
    } else if (is(frames[i], 0x180) && suffers(node, Mischief::kDoubleStatus)) {
      frames.push_back(frames[i]);
      frames.back().data[2] ^= 0x40U;
    } else if (is(frames[i], 0x700) && suffers(node, Mischief::kShortHeartbeat)) {
      frames[i].size = 0;
    } else if (is(frames[i], 0x700) && suffers(node, Mischief::kBadHeartbeat)) {
      frames[i].data[0] = 0x33;
    }
  }
  return frames;
}

void DriveBus::go_on(Time now, std::vector<Frame>& out) {
  constexpr std::size_t kFloodPerTick =
      4;  // in a millisecond; with the cycle's own messages more than a bus of 1 Mbit/s takes
  for (const Incident& incident : active_) {
    const std::uint32_t node = incident.node;
    switch (incident.mischief) {
      case Mischief::kShortEmergency:
        out.push_back({.id = 0x080U + node, .size = 2});
        break;
      case Mischief::kForeignSync:
        out.push_back({.id = 0x080});
        for (SimulatedDrive& drive : drives_) {
          drive.receive({.id = 0x080}, now, out);
        }
        break;
      case Mischief::kForeignNode:
        out.push_back({.id = 0x180U + (node ^ 0x40U), .size = 8});
        out.push_back({.id = 0x1234567, .size = 8, .extended = true});
        break;
      case Mischief::kFlood:
        out.insert(out.end(), kFloodPerTick, Frame{.id = 0x180U + node, .size = 8});
        break;
      default:
        break;
    }
  }
}

void DriveBus::watch(Time now) {
  for (std::size_t i = 0; i < drives_.size(); ++i) {
    const bool enabled = drives_[i].enabled();
    if (enabled == enabled_[i]) {
      continue;
    }
    enabled_[i] = enabled;
    began_ = began_.value_or(now);
    out_ << std::fixed << std::setprecision(3) << since_s(now) << " s: drive " << static_cast<int>(drives_[i].node())
         << (enabled                ? " gives torque"
             : drives_[i].faulted() ? " torque off, in fault"
                                    : " torque off")
         << std::setprecision(1);
    if (!enabled && last_sync_) {
      out_ << ", " << in_ms(now - *last_sync_) << " ms after the last SYNC";
    }
    if (!enabled && struck_) {
      out_ << ", " << syncs_ - syncs_at_strike_ << " SYNC and " << in_ms(now - *struck_) << " ms after the incident";
    }
    out_ << '\n' << std::flush;
  }
}

void DriveBus::print_summary() {
  out_ << syncs_ << " SYNCs";
  if (longest_ > Time{}) {
    out_ << std::fixed << std::setprecision(3) << ", " << in_ms(shortest_) << " to " << in_ms(longest_) << " ms apart";
  }
  for (const SimulatedDrive& drive : drives_) {
    out_ << std::fixed << std::setprecision(4) << "; drive " << static_cast<int>(drive.node()) << " joint at "
         << drive.truth().q2_rad << " rad";
  }
  out_ << '\n' << std::flush;
}

}  // namespace capstan::drive_sim
