// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "capstan/firmware/safety/code_info.hpp"

namespace capstan {

/// Reasons to take the torque away. Numbers are append-only and never reused: they are in logs and on the wire.
enum class Fault : std::uint8_t {
  kNone = 0,
  kOverrun = 1,
  kSensorMissing = 2,
  kSensorInvalid = 3,
  kEncoderJump = 4,
  kFollowingError = 5,
  kOverCurrent = 6,
  kEstimatorRange = 7,
  kLinkLost = 8,
  kEmergencyStop = 9,
  kModelInvalid = 10,
  kDriveFailed = 11,
  kBoardClock = 12,
  kEncoderFrozen = 13,
  kCurrentMismatch = 14,
  kWindingHot = 15,
  kStorageFailed = 16,
  kSupplyLow = 17,
  kWatchdog = 18,
  kEncoderMotion = 19,
  kLimitCycle = 20,
  kOverspeed = 21,
};

using FaultInfo = CodeInfo<Fault>;

/// One table for shell, log, heartbeat and documentation.
inline constexpr std::array<FaultInfo, 22> kFaultTable = {{
    {Fault::kNone, "none", "nothing is wrong", "nothing to do"},
    {Fault::kOverrun, "overrun", "three or more cycles within a second began late or were skipped",
     "take load off the processor; on Linux run the board's timing check"},
    {Fault::kSensorMissing, "sensor_missing", "a sensor gave no new value in this cycle",
     "check the sensor's cable and supply, then 'disarm' and 'arm'"},
    {Fault::kSensorInvalid, "sensor_invalid", "a sensor gave a value that is not a number or is outside its range",
     "check the sensor's cable and configuration, then 'disarm' and 'arm'"},
    {Fault::kEncoderJump, "encoder_jump",
     "the motor encoder moved further in one cycle than the motor can, or was not read since 'zero'",
     "check the encoder's cable and shielding, or raise motor.speed_limit if the motor is really that fast; then bring "
     "the joint to a known place and 'zero' it, for its position is no longer known"},
    {Fault::kFollowingError, "following_error",
     "the estimated joint angle stayed too far from its reference for too long",
     "check for a blocked joint, lower the speed, or raise limits.following_error"},
    {Fault::kOverCurrent, "over_current", "the measured current stayed above limits.current by a fifth for 20 ms",
     "check the amplifier and the motor's winding"},
    {Fault::kEstimatorRange, "estimator_range", "a number in the estimator reached the end of its range",
     "check the model's parameters with 'list', and the motor's zero position"},
    {Fault::kLinkLost, "link_lost",
     "the stream of references stopped for more than 100 ms while the joint was following it",
     "restart the sender, then 'disarm' and 'arm'"},
    {Fault::kEmergencyStop, "emergency_stop", "the emergency stop is open",
     "close the emergency stop, then 'disarm' and 'arm'"},
    {Fault::kModelInvalid, "model_invalid",
     "the stored parameters are corrupt or from another version, and defaults are in use; or another joint's motor is "
     "in "
     "the law and its motor.fitted is 0",
     "load a model and 'save' it, or set axis_coupling.joint to -1"},
    {Fault::kDriveFailed, "drive_failed", "the amplifier did not take its set value in the last cycle",
     "check the amplifier's cable, supply and enable line, then 'disarm' and 'arm'"},
    {Fault::kBoardClock, "board_clock",
     "the crystal did not start, so the cycle runs on an internal oscillator and its period may be 1 % off",
     "check the crystal and its capacitors, then 'reboot'"},
    {Fault::kEncoderFrozen, "encoder_frozen",
     "the motor encoder gave no count while the torque changed by more than the motor's friction holds, or the "
     "reference by half of limits.following_error",
     "check the encoder's cable, and whether the motor is blocked, then 'disarm' and 'arm'"},
    {Fault::kCurrentMismatch, "current_mismatch",
     "the measured current differed from the wanted one by more than limits.current_mismatch for 50 ms in all",
     "check the amplifier's enable and supply, the winding, and the sign and scale of the current sensor"},
    {Fault::kWindingHot, "winding_hot",
     "the winding's heat (I2t) is a quarter above its steady state at limits.continuous_current",
     "let it cool, look for a blocked or overloaded joint, and compare limits.continuous_current with the motor's "
     "data"},
    {Fault::kStorageFailed, "storage_failed", "the memory of the parameters can not be read; defaults are in use",
     "'reboot', and if this comes back replace the board's memory or give its file the right to be read"},
    {Fault::kSupplyLow, "supply_low",
     "the amplifier's supply was below limits.supply_min for 10 ms in all, or is not measured",
     "check the supply and its cable, then 'disarm' and 'arm'; where the board does not measure it, set "
     "limits.supply_min to 0"},
    {Fault::kWatchdog, "watchdog",
     "the last run ended because the cycle had stopped or the core had failed, or the watchdog does not take its "
     "setting",
     "read 'faults' and what the start reported, then 'reboot'; if this comes back report it"},
    {Fault::kEncoderMotion, "encoder_motion",
     "the motor encoder showed a motion that the motor's torque and inertia cannot explain: the encoder is late, slips "
     "or counts wrong, or something struck the motor",
     "check the encoder's cable and coupling and what the joint has hit; if neither is it, commission the joint again"},
    {Fault::kLimitCycle, "limit_cycle", "the joint oscillated for 4 s by its own control, without a command to move",
     "lower control.stiffness, damping, kp and ki, or take gains from 'capstan tune'"},
    {Fault::kOverspeed, "overspeed",
     "within 8 ms the motor took the joint further than twice limits.joint_speed would, by limits.fault_travel",
     "undo what was set last: control.stiffness, damping, kp, ki or a law that is not this joint's; or raise "
     "limits.joint_speed if the joint may really be that fast"},
}};
static_assert(in_order(kFaultTable));

constexpr auto info(Fault fault) -> const FaultInfo& {
  return kFaultTable[static_cast<std::size_t>(fault)];
}

/// A set of faults, one bit each.
using FaultSet = std::uint32_t;
static_assert(kFaultTable.size() <= 32);
constexpr auto bit(Fault fault) -> FaultSet {
  return 1U << static_cast<unsigned>(fault) & ~1U;  // kNone is number 0, and has none
}
static_assert(std::all_of(kFaultTable.begin(), kFaultTable.end(), [](const FaultInfo& row) {
  return bit(row.code) == (row.code == Fault::kNone ? 0U : FaultSet{1} << static_cast<unsigned>(row.code));
}));
/// The one of a set with the lowest number; kNone of an empty set, of which 32 zeros are counted.
constexpr auto lowest(FaultSet faults) -> Fault {
  return static_cast<Fault>(std::countr_zero(faults) % 32);
}

}  // namespace capstan
