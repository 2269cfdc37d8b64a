// SPDX-License-Identifier: Apache-2.0
#include "capstan/hal/cia402/bus_master.hpp"

#include <algorithm>

#include "capstan/hal/cia402/sdo_client.hpp"

namespace capstan::cia402 {
namespace {

constexpr std::uint32_t kNodeMask = 0x7F;
constexpr std::uint32_t kCyclesOfCalm = 100;  // without another master's SYNC

void put_torque(Frame& frame, const PdoMap& map, std::int16_t torque_permille) {
  put_bytes(frame, map.offset(object::kTargetTorque).value_or(0), 2, static_cast<std::uint16_t>(torque_permille));
}

}  // namespace

template <std::size_t... I>
BusMaster::BusMaster(std::span<const DriveSetting> drives, const Options& options, Journal& journal,
                     std::index_sequence<I...> /*places*/)
    : options_(options),
      journal_(journal),
      count_(drives.size()),
      drives_{DriveLink(I < drives.size() ? drives[I] : DriveSetting{}, journal, I + 1)...} {
  place_.fill(kNobody);
  for (std::size_t i = 0; i < count_; ++i) {
    place_[drives[i].node & kNodeMask] = static_cast<std::uint8_t>(i);
  }
  offered_controlword_.fill(0xFFFF);
  sent_controlword_.fill(0xFFFF);  // nothing yet, so the first one goes out whatever it is
}

BusMaster::BusMaster(std::span<const DriveSetting> drives, const Options& options, Journal& journal)
    : BusMaster(drives, options, journal, std::make_index_sequence<kMostDrives>{}) {}

void BusMaster::rt_receive(const Received& received) {
  switch (received.kind) {
    case Received::Kind::kFrame:
      rt_dispatch(received.frame, received.at);
      break;
    case Received::Kind::kSent:
      if (received.frame.id == cob::kSync) {
        sync_pending_ = false;
      }
      break;
    case Received::Kind::kEvent:
      rt_event(received);
      break;
  }
}

void BusMaster::rt_event(const Received& received) {
  journal_.note(received.event, Journal::kBus, received.detail);
  off_ |= received.event == Anomaly::kBusOff || received.event == Anomaly::kLinkDown;
}

void BusMaster::rt_dispatch(const Frame& frame, Time at) {
  if (frame.extended || frame.remote) {
    journal_.note(frame.extended ? Anomaly::kExtendedFrame : Anomaly::kRemoteFrame, Journal::kBus, frame.id);
    return;
  }
  if (frame.id == cob::kSync) {
    journal_.note(Anomaly::kForeignSync, Journal::kBus);
    cycles_disturbed_ = kCyclesOfCalm;
    return;
  }
  const std::size_t place = place_[frame.id & kNodeMask];
  if (place == kNobody) {
    journal_.note(Anomaly::kUnknownId, Journal::kBus, frame.id);
    return;
  }
  switch (frame.id & ~kNodeMask) {
    case cob::kTpdo1:
      drives_[place].rt_status(frame, at, sync_at_);
      break;
    case cob::kTpdo2:
      if (drives_[place].setting().maps.status[1].count == 0) {
        journal_.note(Anomaly::kUnknownId, Journal::kBus, frame.id);
      } else {
        drives_[place].rt_status(frame, at, sync_at_, 1);
      }
      break;
    case cob::kHeartbeat:
      drives_[place].rt_heartbeat(frame, at);
      break;
    case cob::kEmergency:
      drives_[place].rt_emergency(frame);
      break;
    case cob::kSdoAnswer:
      drives_[place].rt_mode(frame);
      break;
    default:
      journal_.note(Anomaly::kUnknownId, Journal::kBus, frame.id);
      break;
  }
}

void BusMaster::rt_sense(Time now, std::span<AxisSensed> axes) {
  for (std::size_t i = 0; i < count_; ++i) {
    axes[i] = drives_[i].rt_sense(now, answer_due_);
  }
  answer_due_ = false;
}

void BusMaster::rt_decide(std::span<const AxisDrive> axes) {
  for (std::size_t i = 0; i < count_; ++i) {
    decided_[i] = drives_[i].rt_command(axes[i]);
  }
  cycles_disturbed_ -= cycles_disturbed_ > 0 ? 1 : 0;
  stuck_ = sync_pending_;
  if (stuck_) {
    journal_.note(Anomaly::kSyncStuck, Journal::kBus);
  }
}

auto BusMaster::rt_messages(bool torque, Time now) -> Outbox {
  Outbox out;
  if (stuck_ || off_) {
    return out;  // what can not leave now would leave later, as an old set value
  }
  Commands commands = decided_;
  for (DriveLink::Command& command : commands) {
    if (!torque && command.controlword != controlword::kFaultReset) {
      command = {};
    }
  }
  if (options_.layout == PdoLayout::kSeparate) {
    rt_separate(commands, out);
  } else {
    rt_packed(commands, out);
  }
  for (std::size_t i = 0; i < count_; ++i) {
    if (torque && drives_[i].rt_asks_mode()) {
      out.add(SdoClient::read_request(drives_[i].setting().node, object::kModeDisplay));
    }
  }
  constexpr Time kHalfCycle = std::chrono::microseconds(500);
  if (heartbeat_at_ == Time{} || now - heartbeat_at_ > kHeartbeatPeriod - kHalfCycle) {
    out.add(heartbeat_frame(kMasterNode, NmtState::kOperational));
    offered_heartbeat_at_ = now;
  }
  out.add({.id = cob::kSync});
  return out;
}

void BusMaster::rt_separate(const Commands& commands, Outbox& out) const {
  for (std::size_t i = 0; i < count_; ++i) {
    const PdoMap& map = drives_[i].setting().maps.torque;
    Frame frame{.id = map.id, .size = map.bytes(), .fd = options_.fd};
    put_bytes(frame, map.offset(object::kControlword).value_or(0), 2, commands[i].controlword);
    put_torque(frame, map, commands[i].torque_permille);
    out.add(frame);
  }
}

// All torques in one message. A controlword that takes torque away goes out at once; of the others one a cycle, because
// the budget has room for one, each again from time to time in case the drive missed it.
void BusMaster::rt_packed(const Commands& commands, Outbox& out) {
  constexpr std::size_t kRepeatEvery = 50;
  const PdoMap& shared = drives_[0].setting().maps.torque;
  Frame torques{.id = shared.id, .size = shared.bytes(), .fd = options_.fd};
  offered_controlword_ = sent_controlword_;
  bool sent = false;
  next_to_repeat_ = (next_to_repeat_ + 1) % (kRepeatEvery * count_);
  for (std::size_t i = 0; i < count_; ++i) {
    const DriveMaps& maps = drives_[i].setting().maps;
    put_torque(torques, maps.torque, commands[i].torque_permille);
    const std::uint16_t word = commands[i].controlword;
    const bool changed = word != sent_controlword_[i];
    const bool taking_away = changed && word == controlword::kDisableVoltage;
    if (taking_away || (!sent && (changed || next_to_repeat_ == kRepeatEvery * i))) {
      Frame frame{.id = maps.controlword.id, .size = maps.controlword.bytes(), .fd = options_.fd};
      put_bytes(frame, 0, 2, word);
      out.add(frame);
      offered_controlword_[i] = word;
      sent |= !taking_away;
    }
  }
  out.add(torques);
}

void BusMaster::rt_sync_sent(Time at) {
  sync_at_ = at;
  sent_controlword_ = offered_controlword_;
  heartbeat_at_ = offered_heartbeat_at_;
  answer_due_ = true;
  sync_pending_ = options_.confirms;
}

auto BusMaster::rt_sound() const -> bool {
  return !stuck_ && !off_ && cycles_disturbed_ == 0 &&
         std::all_of(drives_.begin(), drives_.begin() + static_cast<std::ptrdiff_t>(count_),
                     [](const DriveLink& drive) { return drive.rt_sound(); });
}

auto wanted_ids(std::span<const DriveSetting> drives, std::span<std::uint32_t> ids) -> std::size_t {
  std::size_t count = 0;
  ids[count++] = cob::kSync;
  for (const DriveSetting& drive : drives) {
    ids[count++] = drive.maps.status[0].id;
    ids[count++] = cob::kHeartbeat + drive.node;
    ids[count++] = cob::kEmergency + drive.node;
    if (drive.maps.status[1].count != 0) {
      ids[count++] = drive.maps.status[1].id;
    }
    if (drive.asks_mode) {
      ids[count++] = cob::kSdoAnswer + drive.node;
    }
  }
  return count;
}

}  // namespace capstan::cia402
