// SPDX-License-Identifier: Apache-2.0
#include "capstan/tests/tools/blind/blind_joint.hpp"

#include <array>
#include <cmath>
#include <numbers>

#include "capstan/tests/tools/blind/blind_effects.hpp"
#include "capstan/tests/tools/blind/blind_world.hpp"

namespace capstan::tools::blind {
namespace {

auto names_of(const std::map<std::string, Effect>& effects) -> std::vector<std::string> {
  std::vector<std::string> names;
  for (const auto& entry : effects) {
    names.push_back(entry.first);
  }
  return names;
}

constexpr double kVisibleShare = 0.03;

/// The joint's angle without noise, in this world and to somebody who sees the motor through an encoder of this step.
struct JointAngles {
  Signal actual, seen;
  bool visible = true;  ///< the base law could not have taken up nearly all of it
};
auto joint_angles(const Case& c, const World& w, double noise_rad, double step, Draw& draw) -> JointAngles {
  const World late = as_seen(w, step);
  JointAngles joint{w.joint, late.joint, true};
  for (const auto& name : c.truths) {
    const Effect& effect = effect_of(name);
    Draw same = draw;
    const Signal actual = effect(w, draw);
    const double outside = std::sqrt(outside_base(w, actual).square().mean());
    joint.visible = joint.visible && outside > kVisibleShare * std::sqrt((actual - actual.mean()).square().mean());
    const double size = c.strength * noise_rad / outside;
    joint.actual += sized(name, w, actual, size);
    joint.seen += sized(name, late, effect(late, same), size);
  }
  return joint;
}

/// Every so many steps of the world, by its sensors.
struct Sensors {
  int every = 1;
  double step_rad = 0.0;         ///< of the encoders
  double torque_noise_nm = 0.0;  ///< standard deviation
  double joint_noise_rad = 0.0;  ///< standard deviation
  double coloured_share = 0.0, coloured_memory = 0.0;
};

auto record(const World& w, const Signal& joint, const Sensors& sensors, Draw& draw) -> AxisLog {
  const auto to_step = [&sensors](double angle) { return std::round(angle / sensors.step_rad) * sensors.step_rad; };
  AxisLog log;
  log.name = "blind";
  log.target = "axis0/q2_rad";
  log.period_s = kStep * sensors.every;
  log.has_torque = true;
  const Eigen::Index rows = w.q.size() / sensors.every;
  for (Eigen::VectorXd* signal : {&log.time_s, &log.q1_rad, &log.tau_nm, &log.q2_rad}) {
    signal->resize(rows);
  }
  OtherAxis other{1, Eigen::VectorXd(rows), Eigen::VectorXd(rows)};
  log.temperature_c.resize(rows);
  const double memory = sensors.coloured_memory;
  double coloured = draw.normal();
  for (Eigen::Index i = 0; i < rows; ++i) {
    const Eigen::Index at = i * sensors.every;
    coloured = memory * coloured + std::sqrt(1.0 - memory * memory) * draw.normal();
    log.time_s[i] = w.time[at];
    log.q1_rad[i] = to_step(w.q[at]);
    log.tau_nm[i] = w.tau[at] + sensors.torque_noise_nm * draw.normal();
    log.q2_rad[i] = joint[at] + sensors.joint_noise_rad * (std::sqrt(sensors.coloured_share) * coloured +
                                                           std::sqrt(1.0 - sensors.coloured_share) * draw.normal());
    other.q1_rad[i] = to_step(w.other_q[at]);
    other.tau_nm[i] = w.other_tau[at];
    log.temperature_c[i] = w.temperature[at] + 0.05 * draw.normal();
  }
  log.side = {{"temperature_C", log.temperature_c}, {"axis1/q1_rad", other.q1_rad}, {"axis1/tau_Nm", other.tau_nm}};
  log.others = {std::move(other)};
  return log;
}

}  // namespace

auto motion_name(Motion motion) -> const char* {
  constexpr std::array<const char*, 4> kNames = {"sine", "multisine", "ladder", "triangles"};
  return kNames[static_cast<std::size_t>(motion)];
}

auto listed_effects() -> const std::vector<std::string>& {
  static const std::vector<std::string> kNames = names_of(listed());
  return kNames;
}

auto unlisted_effects() -> const std::vector<std::string>& {
  static const std::vector<std::string> kNames = names_of(unlisted());
  return kNames;
}
auto blind_joint(const Case& c) -> BlindJoint {
  Draw draw(c.seed);
  const World w = world_of(c, draw);
  Sensors sensors;
  constexpr std::array<int, 4> kEvery = {1, 2, 5, 10};
  sensors.every = kEvery[static_cast<std::size_t>(draw.one_of(4))];
  sensors.step_rad = 2.0 * std::numbers::pi / draw.ratio_between(8192.0, 160000.0);
  sensors.torque_noise_nm = draw.between(0.0, 0.006) * w.tau_span;
  sensors.joint_noise_rad = draw.ratio_between(0.0004, 0.002);
  sensors.coloured_memory = std::exp(-kStep * sensors.every / draw.ratio_between(0.01, 0.15));
  sensors.coloured_share = draw.between(0.0, 0.8);
  const JointAngles joint = joint_angles(c, w, sensors.joint_noise_rad, sensors.step_rad, draw);
  const double elongation =
      std::sqrt(0.5 * (std::pow(w.elongation_top, 2) + std::pow(w.elongation_bottom, 2)));  // rad/Nm
  const double resolution = w.beta * sensors.step_rad / std::sqrt(12.0);
  const double lateness = std::sqrt((joint.actual - joint.seen).square().mean());
  const double floor = std::hypot(std::hypot(sensors.joint_noise_rad, elongation * sensors.torque_noise_nm),
                                  std::hypot(resolution, lateness));
  return {record(w, joint.actual, sensors, draw), sensors.joint_noise_rad, floor, joint.visible};
}

}  // namespace capstan::tools::blind
