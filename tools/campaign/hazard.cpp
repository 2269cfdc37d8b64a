// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/campaign/hazard.hpp"

#include <algorithm>
#include <cmath>

namespace capstan::tools {

auto Hazard::severity(const HazardLimits& limits) const -> double {
  return std::max({travel_rad / limits.travel_rad, speed_rad_s / (limits.speed_factor * limits.speed_rad_s),
                   torque_nm / (limits.torque_factor * limits.torque_nm)});
}

void Hazard::widen(const Hazard& other) {
  travel_rad = std::max(travel_rad, other.travel_rad);
  speed_rad_s = std::max(speed_rad_s, other.speed_rad_s);
  torque_nm = std::max(torque_nm, other.torque_nm);
}

void Course::add(const sim::Truth& truth, double asked) {
  asked_rad.push_back(asked);
  angle_rad.push_back(truth.q2_rad);
  const std::size_t back = std::min<std::size_t>(kSpeedCycles, angle_rad.size() - 1);
  const double moved = truth.q2_rad - angle_rad[angle_rad.size() - 1 - back];
  speed_rad_s.push_back(back == 0 ? 0.0 : std::fabs(moved) / (kSpeedCycles * sim::kStepS));
  torque_nm.push_back(std::fabs(truth.tip_torque_nm));
}

auto hazard_beyond(const Course& healthy, const Course& faulty) -> Hazard {
  Hazard hazard;
  double low = healthy.angle_rad.front();
  double high = low;
  double speed = 0.0;
  double torque = 0.0;
  for (std::size_t i = 0; i < faulty.angle_rad.size(); ++i) {
    low = std::min(low, healthy.angle_rad[i]);
    high = std::max(high, healthy.angle_rad[i]);
    speed = std::max(speed, healthy.speed_rad_s[i]);
    torque = std::max(torque, healthy.torque_nm[i]);
    hazard.travel_rad = std::max({hazard.travel_rad, faulty.angle_rad[i] - high, low - faulty.angle_rad[i]});
    if (faulty.speed_rad_s[i] > speed) {
      hazard.speed_rad_s = std::max(hazard.speed_rad_s, faulty.speed_rad_s[i]);
    }
    if (faulty.torque_nm[i] > torque) {
      hazard.torque_nm = std::max(hazard.torque_nm, faulty.torque_nm[i]);
    }
  }
  return hazard;
}

auto hazard_from_asked(const Course& healthy, const Course& faulty) -> Hazard {
  const auto largest = [](const Course& course) {
    double most = 0.0;
    for (std::size_t i = 0; i < course.angle_rad.size(); ++i) {
      most = std::max(most, std::fabs(course.angle_rad[i] - course.asked_rad[i]));
    }
    return most;
  };
  Hazard hazard = hazard_beyond(healthy, faulty);
  hazard.travel_rad = std::max(0.0, largest(faulty) - largest(healthy));
  return hazard;
}

}  // namespace capstan::tools
