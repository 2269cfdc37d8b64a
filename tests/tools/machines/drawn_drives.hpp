// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <utility>

#include "capstan/tests/tools/machines/drawn_motion.hpp"

namespace capstan::tools::machines {

/// What a drive's log holds, a value for each of its rows.
struct DriveLog {
  Eigen::ArrayXd time_s, motor_angle, effort;
  Eigen::ArrayXd output_torque;  ///< of a gear between two torques; else none
};

/// A pendulum on a servo that is told where to go: its motion is what comes of it, sticks and slips. Its effort is the
/// servo's voltage. Friction of Coulomb and Stribeck, with the load and by its direction, one to all of them; 6 to 25 s
/// at 100 to 200 Hz with 4096 counts a turn.
using GoalKind = Eigen::ArrayXd (*)(Draw&, const Eigen::ArrayXd& t);
/// A sum of two sines, a sine that grows faster, up and down once, a lift that is held, and places at random.
extern const std::array<std::pair<const char*, GoalKind>, 5> kGoals;
auto servo_log(Draw& draw, GoalKind goal) -> DriveLog;

/// A gear whose motor has a torque while its output is turned, and a sensor behind it: torque that saturates or does
/// not, friction of its own and with the load that begins within some way, drag, inertia, teeth, and a channel of the
/// torque up to four rows late or two early. 25 to 60 s at 100 to 500 Hz.
using TurnKind = Eigen::ArrayXd (*)(Draw&, const Eigen::ArrayXd& t);
/// By hand, in sines, and at steady speeds.
extern const std::array<std::pair<const char*, TurnKind>, 3> kTurns;
auto gear_log(Draw& draw, TurnKind turn) -> DriveLog;

}  // namespace capstan::tools::machines
