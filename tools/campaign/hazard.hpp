// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "capstan/hal/sim/plant.hpp"

namespace capstan::tools {

/// What a machine promises: limits of the true joint after a fault.
struct HazardLimits {
  double travel_rad = 0.05;    ///< limits.fault_travel
  double speed_rad_s = 2.0;    ///< limits.joint_speed
  double torque_nm = 0.2;      ///< limits.joint_torque
  double speed_factor = 1.5;   ///< of the speed limit
  double torque_factor = 1.2;  ///< of the torque limit
};

/// What the true joint did from the onset until it stood, beyond the same motion without the fault.
struct Hazard {
  double travel_rad = 0.0;   ///< outside of all angles that the healthy twin has taken since the onset
  double speed_rad_s = 0.0;  ///< largest speed, a mean over 5 ms, where it is above the twin's largest
  double torque_nm = 0.0;    ///< largest torque of the tip on what it touches, where it is above the twin's largest

  /// The largest of the three over its limit; above 1 is unsafe.
  [[nodiscard]] auto severity(const HazardLimits& limits) const -> double;
  void widen(const Hazard& other);
};

/// One joint's true course, a value for each millisecond.
struct Course {
  std::vector<double> angle_rad;
  std::vector<double> speed_rad_s;  ///< a mean over kSpeedCycles
  std::vector<double> torque_nm;    ///< of the tip
  std::vector<double> asked_rad;    ///< by the reference that the firmware follows
  void add(const sim::Truth& truth, double asked_rad);
};
/// A free tip on its tendons rings at some hundred hertz; what goes through tissue is the motion below that.
inline constexpr int kSpeedCycles = 5;

/// Compares two courses of the same length or the first part of `healthy`.
[[nodiscard]] auto hazard_beyond(const Course& healthy, const Course& faulty) -> Hazard;
/// The same for a wrong reference, which no firmware can tell from a right one as long as it is a possible motion:
/// travel is the tracking error beyond the healthy joint's.
[[nodiscard]] auto hazard_from_asked(const Course& healthy, const Course& faulty) -> Hazard;

}  // namespace capstan::tools
