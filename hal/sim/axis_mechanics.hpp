// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

#include "capstan/hal/sim/deterministic_math.hpp"
#include "capstan/hal/sim/parameters.hpp"

/// What one axis needs besides its tendons: torque balances of motor and joint as functions of their increments in one
/// implicit Euler step. Each balance grows with its own increment, which is what makes the solvers' solution unique.
namespace capstan::sim {

constexpr double kBalanceToleranceNm = 1.0e-10;
// Where the first attempt at a balance fails, rounding may be why: see balance_tolerance().
constexpr double kRoundingShare = 1.0e-11;

// Of the solvers over all angles at once.
constexpr int kMaxRounds = 40;
constexpr int kFullRounds = 12;  // a Newton iteration not at rest by then goes half way, lest it cycle
constexpr int kMaxRelaxations = 40;
constexpr int kSweepsPerNewton = 4;
constexpr double kLargestAngleRad = 1.0e4;

/// The instant within a step, as a share of it, at which all torques balance: at its end (implicit Euler, which damps
/// what it cannot resolve), or just behind its middle (second order but for a trace of damping, 0.02 w h of critical at
/// the frequency w).
inline double balance_instant(const PlantParameters& p) {
  return p.mode == SolverMode::kDynamic ? 0.52 : 1.0;
}

/// What acts on the drivetrain from outside during one step.
struct Loads {
  double motor_torque_nm = 0.0;
  double tip_torque_nm = 0.0;
  double extra_joint_coulomb_nm = 0.0;
  double extra_motor_coulomb_nm = 0.0;
  double path_move_m = 0.0;  ///< the tendons' way past another joint grows on the top run, shrinks on the bottom run
};

struct DrivetrainState {
  double q1_rad = 0.0;
  double q1_rate_rad_per_s = 0.0;
  double pulley_rad = 0.0;  ///< output pulley; equals q2 unless there is play
  double q2_rad = 0.0;
  double q2_rate_rad_per_s = 0.0;
  double tau_in_nm = 0.0;
  double tau_out_nm = 0.0;         ///< of the axis' own tendons
  double joint_torque_nm = 0.0;    ///< of all tendons that pass the joint
  double motor_bristle_rad = 0.0;  ///< deflection of elastic friction, see bristle()
  double joint_bristle_rad = 0.0;
};

struct Balance {
  double residual, slope, coulomb;  // torque balance without Coulomb friction, N m and N m/rad
  bool prescribed;
  double target;      // increment if prescribed
  double size = 0.0;  // of the torques that cancel in the residual, beyond slope and tendons, N m
};

struct Row {
  bool fixed;  // the increment is known to become move + step
  bool satisfied;
  double step;      // if fixed
  double residual;  // otherwise, Coulomb friction included
};

// How small a residual must be. `rounding_share` of what adds up to it is good enough too: the rest may be rounding.
inline double balance_tolerance(const Balance& b, double slope, double move, double torque, double rounding_share) {
  return std::max(kBalanceToleranceNm, rounding_share * (std::fabs(slope * move) + std::fabs(torque) + b.size));
}

// Which branch of residual in -coulomb sgn(move) the projection picks.
inline Row pick_row(double residual, double slope, double coulomb, double move, double tolerance) {
  const double push = slope * move - residual;
  if (std::fabs(push) <= coulomb)
    return {true, std::fabs(slope * move) <= tolerance, -move, 0.0};
  const double total = residual + (push > 0.0 ? coulomb : -coulomb);
  return {false, std::fabs(total) <= tolerance, 0.0, total};
}

/// The increment of one angle whose balance grows with it, everything else held: Newton kept inside a bracket.
/// @param balance_at  the Balance at a trial increment, tendons included
template <class BalanceAt>
double balanced_move(BalanceAt&& balance_at) {
  const Balance still = balance_at(0.0);
  if (still.prescribed)
    return still.target;
  if (std::fabs(still.residual) <= still.coulomb)
    return 0.0;
  const double direction = still.residual > 0.0 ? -1.0 : 1.0;
  double low = 0.0;
  double high = kLargestAngleRad;
  double distance = 1.0e-9;
  for (int round = 0; round < 200 && high - low > 1.0e-16 * high; ++round) {
    const Balance b = balance_at(direction * distance);
    const double excess = b.residual * direction + b.coulomb;
    if (std::fabs(excess) <= 0.1 * kBalanceToleranceNm)
      break;
    (excess < 0.0 ? low : high) = distance;
    const double next = distance - excess / b.slope;
    distance = next > low && next < high ? next : (high < kLargestAngleRad ? 0.5 * (low + high) : 4.0 * distance);
  }
  return direction * distance;
}

struct Torque {
  double value, slope_angle, slope_rate;
};

// Two layers from the surface down and an inclusion somewhere below it, whose share falls off with the distance along
// the surface. Continuous, and stiffer with depth wherever the stiffnesses are positive.
inline Torque layered_tissue(const Environment& env, double depth) {
  const double near = std::min(depth, env.layer_depth_rad);
  const double deep = std::max(depth - env.layer_depth_rad, 0.0);
  Torque t{env.stiffness * near + env.deep_stiffness * deep, deep > 0.0 ? env.deep_stiffness : env.stiffness, 0.0};
  if (env.inclusion_stiffness > 0.0 && depth > env.inclusion_depth_rad) {
    const double away = (env.site_m - env.inclusion_site_m) / env.inclusion_width_m;
    const double share = env.inclusion_stiffness * det_exp(-std::min(away * away, 100.0));
    t.value += share * (depth - env.inclusion_depth_rad);
    t.slope_angle += share;
  }
  return t;
}

inline Torque environment_torque(const Environment& env, double angle, double rate) {
  const double depth = angle - env.angle_rad;
  switch (env.kind) {
    case EnvironmentKind::kFree:
    case EnvironmentKind::kLocked:
      return {0.0, 0.0, 0.0};
    case EnvironmentKind::kSpring:
      return {env.stiffness * depth, env.stiffness, 0.0};
    case EnvironmentKind::kKelvinVoigt:
      return {env.stiffness * depth + env.damping * rate, env.stiffness, env.damping};
    case EnvironmentKind::kHuntCrossley:
    case EnvironmentKind::kLayered:
      break;
  }
  const double damp = 1.0 + env.damping * rate;
  if (depth <= 0.0 || damp <= 0.0)
    return {0.0, 0.0, 0.0};  // contact never pulls
  if (env.kind == EnvironmentKind::kLayered) {
    const Torque still = layered_tissue(env, depth);
    return {still.value * damp, still.slope_angle * damp, still.value * env.damping};
  }
  const double root = std::sqrt(depth);
  return {env.stiffness * depth * root * damp, 1.5 * env.stiffness * root * damp,
          env.stiffness * depth * root * env.damping};
}

/// Elastic friction: a spring that yields at +-force, `width` its deflection there. `z` is its deflection before the
/// step.
inline Torque bristle(double force, double width, double z, double move) {
  const double deflection = z + move;
  if (std::fabs(deflection) >= width)
    return {deflection > 0.0 ? force : -force, 0.0, 0.0};
  return {force * deflection / width, force / width, 0.0};
}

inline double bristle_after(double width, double z, double move) {
  return std::clamp(z + move, -width, width);
}

/// The joint's end stops push back as springs, and never pull.
inline Torque stop_torque(const PlantParameters& p, double angle) {
  const double beyond = angle - std::clamp(angle, p.stop_low_rad, p.stop_high_rad);
  if (beyond == 0.0 || p.stop_stiffness_nm_per_rad == 0.0)
    return {0.0, 0.0, 0.0};
  return {p.stop_stiffness_nm_per_rad * beyond, p.stop_stiffness_nm_per_rad, 0.0};
}

inline Balance motor_balance(const PlantParameters& p, const DrivetrainState& s, const Loads& loads, double h,
                             double move) {
  const Effects& e = p.effects;
  const double instant = balance_instant(p);
  const double inertia = p.motor_inertia_kgm2 / (h * h) / instant;
  double viscous = (p.motor_viscous_nms_per_rad + e.viscous_friction_nms_per_rad) / h;
  const double coulomb = p.motor_coulomb_nm + e.coulomb_friction_nm + loads.extra_motor_coulomb_nm;
  double extra = 0.0;
  if (e.friction_asymmetry != 0.0) {
    // Friction forward (1 + share), backward (1 - share): for Coulomb friction that is the same as a constant torque.
    viscous *= move > 0.0 ? 1.0 + e.friction_asymmetry : 1.0 - e.friction_asymmetry;
    extra = e.friction_asymmetry * coulomb;
  }
  Balance b{inertia * (move - h * s.q1_rate_rad_per_s) + viscous * move - loads.motor_torque_nm,
            inertia + viscous,
            coulomb,
            false,
            0.0,
            0.0};
  if (e.play_friction_nm > 0.0) {
    const Torque t = bristle(e.play_friction_nm, e.play_friction_width_rad, s.motor_bristle_rad, instant * move);
    extra += t.value;
    b.slope += instant * t.slope_angle;
  }
  b.residual += extra;
  return b;
}

inline Balance joint_balance(const PlantParameters& p, const DrivetrainState& s, const Loads& loads, double h,
                             double move) {
  const Effects& e = p.effects;
  const double instant = balance_instant(p);
  const double angle = s.q2_rad + instant * move;
  const double inertia = (p.joint_inertia_kgm2 + e.load_inertia_kgm2) / (h * h) / instant;
  const double viscous = p.joint_viscous_nms_per_rad / h;
  const Torque env = environment_torque(p.environment, angle, move / h);
  double gravity = 0.0;
  double gravity_slope = 0.0;
  if (e.gravity_torque_nm != 0.0) {
    gravity = e.gravity_torque_nm * det_sin(angle + e.gravity_angle_rad);
    gravity_slope = e.gravity_torque_nm * det_cos(angle + e.gravity_angle_rad);
  }
  Balance b{inertia * (move - h * s.q2_rate_rad_per_s) + viscous * move + env.value + gravity - loads.tip_torque_nm,
            inertia + viscous + instant * env.slope_angle + env.slope_rate / h + instant * gravity_slope,
            p.joint_coulomb_nm + loads.extra_joint_coulomb_nm,
            p.environment.kind == EnvironmentKind::kLocked,
            0.0,
            std::fabs(env.value)};
  if (p.stop_stiffness_nm_per_rad > 0.0) {
    const Torque t = stop_torque(p, angle);
    b.residual += t.value;
    b.slope += instant * t.slope_angle;
    b.size += std::fabs(t.value);
  }
  if (e.presliding_nm > 0.0) {
    const Torque t = bristle(e.presliding_nm, e.presliding_width_rad, s.joint_bristle_rad, instant * move);
    b.residual += t.value;
    b.slope += instant * t.slope_angle;
  }
  return b;
}

/// With play the output pulley has a bearing of its own: a share of the joint's viscous friction, and a floor. N m
/// s/rad
inline double pulley_viscous(const PlantParameters& p) {
  return 1.0e-7 + 0.05 * p.joint_viscous_nms_per_rad;
}

/// Speed after a step. What friction held through all of it stands.
inline double rate_after(double instant, double rate, double move, double h) {
  if (instant == 1.0 || move == 0.0)
    return move / h;
  return rate + (move / h - rate) / instant;
}

/// Rotations and deflections after a step of `h` in which motor and joint moved so far.
inline void advance_state(const PlantParameters& p, DrivetrainState& s, double h, double q1_move, double q2_move) {
  s.q1_rad += q1_move;
  s.q2_rad += q2_move;
  const double instant = balance_instant(p);
  s.q1_rate_rad_per_s = rate_after(instant, s.q1_rate_rad_per_s, q1_move, h);
  s.q2_rate_rad_per_s = rate_after(instant, s.q2_rate_rad_per_s, q2_move, h);
  if (p.effects.play_friction_nm > 0.0)
    s.motor_bristle_rad = bristle_after(p.effects.play_friction_width_rad, s.motor_bristle_rad, q1_move);
  if (p.effects.presliding_nm > 0.0)
    s.joint_bristle_rad = bristle_after(p.effects.presliding_width_rad, s.joint_bristle_rad, q2_move);
}

}  // namespace capstan::sim
