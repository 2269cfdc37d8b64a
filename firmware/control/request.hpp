// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "capstan/model/fixed.hpp"

namespace capstan {

inline constexpr std::uint8_t kAllJoints = 0xFF;  ///< a bit a joint

/// What somebody asks of one joint, or of the machine: the operator's shell, a bus, a host that streams, an experiment.
/// It goes down the cycle as it came.
struct Request {
  enum class Kind : std::uint8_t {
    kNone,    ///< go on with what it does
    kMove,    ///< to position_rad at no more than speed_rad_s
    kStop,    ///< brake and stand
    kFollow,  ///< a streamed reference: position_rad now, the next one within 100 ms
    kZero,    ///< the motor stands at position_rad, whatever its encoder says; only without torque
    kTorque,  ///< streamed too: motor-side torque_nm instead of a position. A joint that gets faster than its moves may
              ///< or leaves its range is held where it then is
    kForce,  ///< force control: the joint's torque to joint_torque_nm at torque_rate_nm_s, and there from then on; from
             ///< rest only. Watched as kTorque is. With corridor_rad the joint goes no further than that to either
             ///< side of where force control began: there it is held, until it is pressed back harder than wanted
    kFollowForce,  ///< the same as a stream, the next one within 100 ms
    kMoveMotor,    ///< motor position control: the motor to position_rad, so that the joint gets no faster than
                   ///< speed_rad_s makes it and accelerates no more; from rest only. A joint that leaves its range is
                   ///< held there
    kArm,          ///< of the machine: torque, if nothing blocks it
    kDisarm,       ///< of the machine: no torque; acknowledges a fault
    kRest,         ///< of the machine: no torque; leaves a fault for the operator
  };
  Kind kind = Kind::kNone;
  /// Of kArm, a bit a joint: those that keep to cautious_limits() where their observer is not commissioned.
  std::uint8_t cautious = 0;
  std::uint8_t axis = 0;  ///< whose; where requests stand in the order of the joints, their place says it
  Q24 position_rad{};
  Q24 speed_rad_s{};
  Q24 torque_nm{};
  Q24 joint_torque_nm{};
  Q24 torque_rate_nm_s{};
  Q24 corridor_rad{};  ///< of kForce, kFollowForce: half of its width; 0: none
  Q24 dither_nm{};     ///< added to the motor's torque in this cycle, whatever else it does
};

}  // namespace capstan
