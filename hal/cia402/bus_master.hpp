// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>

#include "capstan/hal/cia402/drive_link.hpp"

namespace capstan::cia402 {

/// What comes out of a CAN port.
struct Received {
  enum class Kind : std::uint8_t {
    kFrame,  ///< somebody else's
    kSent,   ///< our own, now that it has left
    kEvent,  ///< something happened on the bus or in the kernel: `event`, `detail`
  };
  Kind kind = Kind::kFrame;
  Frame frame{};
  Anomaly event = Anomaly::kBusError;
  std::uint32_t detail = 0;
  Time at{};  ///< when it arrived, left or happened
};

/// The firmware's side of one bus of one to four drives: who is meant by a message, what is sent in a cycle and in
/// which order. Does not allocate; no clock, no socket.
class BusMaster {
 public:
  static constexpr std::size_t kMostDrives = 4;

  /// Messages of one cycle, in order.
  struct Outbox {
    std::array<Frame, 3 * kMostDrives + 2> frames{};
    std::size_t count = 0;
    void add(const Frame& frame) { frames[count++] = frame; }
  };

  struct Options {
    PdoLayout layout = PdoLayout::kSeparate;
    bool fd = false;        ///< set values go in FD frames
    bool confirms = false;  ///< the port tells when our SYNC has left
  };

  /// @param drives  one to four, set up and operational   @param journal  outlives this object
  BusMaster(std::span<const DriveSetting> drives, const Options& options, Journal& journal);

  void rt_receive(const Received& received);
  /// After everything that has arrived was received: the sensors of each drive.
  void rt_sense(Time now, std::span<AxisSensed> axes);
  /// Steps every drive towards what is wanted; rt_sound() then says whether torque may be given.
  void rt_decide(std::span<const AxisDrive> axes);
  /// What to send now: set values, then a heartbeat if it is time, SYNC last. Empty while the bus can take nothing.
  /// @param torque  false: whatever was decided, all drives are told to take their voltage off
  auto rt_messages(bool torque, Time now) -> Outbox;
  /// SYNC was handed to the port at this moment, and with it everything before it. Without this call all of it counts
  /// as not sent.
  void rt_sync_sent(Time at);

  /// False: torque must go and stay away from all drives of the machine.
  [[nodiscard]] auto rt_sound() const -> bool;
  [[nodiscard]] auto drives() const -> std::size_t { return count_; }
  [[nodiscard]] auto drive(std::size_t place) const -> const DriveLink& { return drives_[place]; }

 private:
  static constexpr std::uint8_t kNobody = 0xFF;

  void rt_dispatch(const Frame& frame, Time at);
  void rt_event(const Received& received);
  using Commands = std::array<DriveLink::Command, kMostDrives>;
  void rt_separate(const Commands& commands, Outbox& out) const;
  void rt_packed(const Commands& commands, Outbox& out);

  template <std::size_t... I>
  BusMaster(std::span<const DriveSetting> drives, const Options& options, Journal& journal, std::index_sequence<I...>);

  Options options_;
  Journal& journal_;
  std::size_t count_;
  std::array<DriveLink, kMostDrives> drives_;
  std::array<std::uint8_t, 128> place_{};  // of a node
  Commands decided_{};
  std::array<std::uint16_t, kMostDrives> offered_controlword_{};  // sent once SYNC has been taken behind them
  std::array<std::uint16_t, kMostDrives> sent_controlword_{};
  std::size_t next_to_repeat_ = 0;
  Time sync_at_{};
  Time heartbeat_at_{};
  Time offered_heartbeat_at_{};
  bool answer_due_ = false;
  bool sync_pending_ = false;
  bool stuck_ = false;
  std::uint32_t cycles_disturbed_ = 0;  // by another master, still to be waited for
  bool off_ = false;
};

/// Identifiers that BusMaster needs from the bus; all others may be filtered out before.
/// @returns how many there are
auto wanted_ids(std::span<const DriveSetting> drives, std::span<std::uint32_t> ids) -> std::size_t;
inline constexpr std::size_t kMostWantedIds = 1 + 5 * BusMaster::kMostDrives;

}  // namespace capstan::cia402
