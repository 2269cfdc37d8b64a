// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "capstan/hal/cia402/drive_state.hpp"
#include "capstan/hal/cia402/journal.hpp"
#include "capstan/hal/cia402/pdo_map.hpp"
#include "capstan/hal/joint_io.hpp"

namespace capstan::cia402 {

/// What the cycle needs to know of a drive that has been set up.
struct DriveSetting {
  std::uint8_t node = 0;
  std::int32_t rated_current_ma = 0;  ///< object 6075; torques on the bus are thousandths of the rated one
  DriveMaps maps;
  std::int16_t max_torque_permille = INT16_MAX;  ///< what the limits stored in the drive allow, either way
  bool asks_mode = false;  ///< it shows its mode (6061) only when enabled; torque waits until it was asked then
  std::uint32_t most_cycles_to_answer = kMostCyclesToAnswer;  ///< a controlword, at best

  /// A drive that follows none of three controlwords within this many cycles lets its status messages wait, or its
  /// state machine is that slow. Chosen 2026-11-22: half of the 20 ms that swung a joint, ten times what the simulated
  /// drive needs; no real one was measured.
  static constexpr std::uint32_t kMostCyclesToAnswer = 10;
};

/// One drive in cyclic synchronous torque mode, as the cycle sees it: messages in, controlword and torque out. What it
/// sends is judged here; nothing that is late, doubtful or of the wrong form is used. Does not allocate; no clock.
class DriveLink {
 public:
  /// @param source  the drive's number in the journal, from 1
  DriveLink(const DriveSetting& setting, Journal& journal, std::size_t source);

  /// A status message (TPDO 1 or 2). @param arrived  when  @param sync  when the SYNC that it should answer was sent
  void rt_status(const Frame& frame, Time arrived, Time sync, std::size_t part = 0);
  /// An answer to the question for its mode.
  void rt_mode(const Frame& frame);
  void rt_heartbeat(const Frame& frame, Time arrived);
  void rt_emergency(const Frame& frame);

  /// After all messages of a cycle: the sensors, marked missing or invalid where there is nothing to rely on.
  /// @param answer_due  a SYNC went out since the last call
  auto rt_sense(Time now, bool answer_due) -> AxisSensed;

  struct Command {
    std::uint16_t controlword = controlword::kDisableVoltage;
    std::int16_t torque_permille = 0;  ///< of the rated torque; that of current alike
  };
  /// Steps the drive towards torque or takes it away.
  auto rt_command(const AxisDrive& drive) -> Command;
  /// Whether the drive has to be asked for its mode now (an SDO read of 6061).
  auto rt_asks_mode() -> bool;

  /// False: torque must go and stay away.
  [[nodiscard]] auto rt_sound() const -> bool {
    return !lost_ && !dropped_ && cycles_of_doubt_ == 0 && state_ != DriveState::kFault &&
           state_ != DriveState::kFaultReaction && state_ != DriveState::kUnknown;
  }
  [[nodiscard]] auto state() const -> DriveState { return state_; }
  [[nodiscard]] auto setting() const -> const DriveSetting& { return setting_; }

 private:
  void rt_lose(Anomaly why, std::uint32_t detail);
  void rt_enter(std::uint16_t statusword);
  void rt_await();
  auto rt_gives_torque() -> bool;
  void rt_drop(Anomaly why);
  auto rt_rest() -> Command;
  [[nodiscard]] auto rt_follows() const -> bool;
  [[nodiscard]] auto rt_value(const Object& object) const -> std::uint32_t;

  enum class Mode : std::uint8_t { kUnknown, kToAsk, kAsked, kRight };

  DriveSetting setting_;
  Journal& journal_;
  std::size_t source_;
  std::array<Frame, kMostStatusParts> status_{};  // the last ones
  std::array<bool, kMostStatusParts> fresh_{};    // they came since the last rt_sense()
  bool contradicted_ = false;                     // and so did others
  bool lost_ = false;                             // until it is set up anew
  bool dropped_ = false;                          // until the firmware takes the torque away
  bool reached_ = false;                          // operation enabled, since torque is wanted
  bool looked_ = false;                           // rt_sense() was called before
  Time last_heartbeat_{};
  std::uint32_t cycles_waiting_ = 0;  // for operation enabled
  std::uint32_t cycles_in_fault_ = 0;
  std::uint32_t cycles_of_doubt_ = 0;          // still, because somebody contradicted it
  std::uint32_t cycles_unanswered_ = 0;        // since the controlword changed
  std::uint32_t fastest_answer_ = UINT32_MAX;  // of this arming, cycles
  Mode mode_ = Mode::kUnknown;                 // asked when enabled
  std::uint32_t times_asked_ = 0;              // for the mode
  DriveState state_ = DriveState::kNotReady;
};

}  // namespace capstan::cia402
