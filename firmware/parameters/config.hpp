// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>

#include "capstan/model/disturbance.hpp"
#include "capstan/model/force_law.hpp"
#include "capstan/model/motion_law.hpp"
#include "capstan/model/wrist_kinematics.hpp"

namespace capstan {

/// The cycle's rate. A constant: measured time is telemetry and never enters the law.
inline constexpr std::int32_t kCycleRateHz = 1000;

/// A rate's share of one cycle: rate / kCycleRateHz by the one rounding rule (nearest, ties towards plus infinity).
constexpr auto per_cycle(Q24 rate) -> Q24 {
  const std::int32_t quotient = rate.raw() / kCycleRateHz;
  const std::int32_t twice_the_rest = 2 * (rate.raw() % kCycleRateHz);
  return Q24::from_raw(quotient + (twice_the_rest >= kCycleRateHz ? 1 : 0) - (twice_the_rest < -kCycleRateHz ? 1 : 0));
}
static_assert(per_cycle(Q24::from_raw(1499)).raw() == 1 && per_cycle(Q24::from_raw(-1499)).raw() == -1);
static_assert(per_cycle(Q24::from_raw(1500)).raw() == 2 && per_cycle(Q24::from_raw(-1500)).raw() == -1 &&
              per_cycle(Q24::from_raw(-1501)).raw() == -2);
static_assert(per_cycle(Q24::max()).raw() > 0 && per_cycle(Q24::lowest()).raw() < 0);

/// Motor, gear and encoder, as seen at the transmission's input pulley.
struct MotorConfig {
  std::int32_t encoder_counts_per_turn = 40960;  ///< counts per turn of the input pulley
  std::int32_t encoder_sign = 1;                 ///< +1 or -1
  Q24 torque_per_current_nm_per_a = Q24::from_double(0.1);
  Q24 speed_limit_rad_s = Q24::from_double(60.0);  ///< a faster encoder is a fault
  std::int32_t fitted = 1;                         ///< 0: there is no joint here; nothing is sensed, judged or driven
};

/// Gains. The joint loop (PID on the estimated joint angle) shifts the motor angle that the inverse law asks for; the
/// motor servo follows it.
struct ControlConfig {
  Q24 kp = Q24::from_double(0.2);                      ///< motor rad per joint rad
  Q24 ki_per_s = Q24::from_double(4.0);                ///< 1/s
  Q24 kd_s{};                                          ///< s, on the estimate, not on the error
  Q24 integral_limit_rad = Q24::from_double(0.3);      ///< anti-windup, rad of motor angle
  Q24 stiffness_nm_per_rad = Q24::from_double(1.0);    ///< motor servo
  Q24 damping_nms_per_rad = Q24::from_double(0.006);   ///< motor servo
  Q24 rate_time_constant_s = Q24::from_double(0.002);  ///< filter of the rate that the damping acts on
  Q24 torque_forward_nm{};                             ///< feedforward: torque that keeps the motor moving forward
  Q24 torque_backward_nm{};                            ///< the same backward (negative)
  Q24 reversal_time_s = Q24::from_double(0.02);        ///< the feedforward changes direction within about this time
  Q24 reversal_angle_rad{};  ///< and, of the motor's reference, within about this way; 0: at once
};

struct LimitConfig {
  Q24 current_a = Q24::from_double(3.0);             ///< peak
  Q24 continuous_current_a = Q24::from_double(1.5);  ///< what the winding carries continuously
  Q24 thermal_time_s = Q24::from_double(10.0);       ///< of the winding
  Q24 current_rate_a_per_cycle = Q24::from_double(0.5);
  Q24 motor_min_rad = Q24::from_double(-6.0);  ///< tendon travel, in motor space
  Q24 motor_max_rad = Q24::from_double(6.0);
  Q24 joint_min_rad = Q24::from_double(-2.0);  ///< references outside are refused
  Q24 joint_max_rad = Q24::from_double(2.0);
  Q24 joint_speed_rad_s = Q24::from_double(2.0);  ///< of moves
  Q24 joint_acceleration_rad_s2 = Q24::from_double(10.0);
  Q24 joint_jerk_krad_s3 = Q24::from_double(120.0);  ///< of moves; the default is what any acceleration does in a cycle
  Q24 following_error_rad = Q24::from_double(0.35);
  Q24 following_time_s = Q24::from_double(0.25);
  Q24 current_mismatch_a = Q24::from_double(0.5);  ///< measured against wanted
  Q24 joint_torque_nm = Q24::from_double(0.2);     ///< largest that force control may be asked for
  Q24 supply_min_v{};                              ///< of the amplifier; 0: not watched
  Q24 fault_travel_rad = Q24::from_double(0.05);   ///< of the joint after a fault, until it stands
};

/// How far the joint's torque may be from its estimate, as the force law's logs had it. steady_nm 0: nobody knows.
struct ForceErrorConfig {
  Q24 steady_nm{};   ///< what 95 of 100 samples kept within
  Q24 turning_nm{};  ///< the same of those within turn_nm of a reversal of the motor's torque
  Q24 turn_nm{};
  Q24 torque_nm{};  ///< largest motor torque that the logs have seen
};

/// Motor torque to joint torque, tip held: what `capstan identify --model pull_push` or `preisach` finds.
struct ForceConfig {
  /// From CMake: 11 is the thesis's grid, and with levels that the log chose better than print (docs/thesis.md). Each
  /// copy of a joint's parameters holds n (n + 3) / 2 words of it, the table of parameters as many rows.
  static constexpr std::size_t kLevels = CAPSTAN_PREISACH_LEVELS;
  static_assert(kLevels >= 2 && kLevels <= 41, "CAPSTAN_PREISACH_LEVELS must be 2 to 41");
  static constexpr std::size_t kDepth = 16;  ///< reversals that are remembered
  using Law = ForceLaw<Q24, kLevels, kDepth>;

  std::int32_t law = 0;  ///< a ForceLawKind
  Q24 eta_top{};
  Q24 eta_bottom{};
  Q24 pretension_nm{};
  Q24 ratio = Q24::from_int(1);
  Q24 pull_weight{};  ///< of kBlend, as is the next
  Q24 pull_push_weight = Q24::from_int(1);
  Q24 friction_nm{};               ///< the motor's own
  Q24 offset_nm{};                 ///< of the motor's torque
  Q24 stiffness_top_nm_per_rad{};  ///< r1^2 Kn, for palpation; 0: not known
  Q24 stiffness_bottom_nm_per_rad{};
  Q24 rate_nm_per_s = Q24::from_double(0.05);    ///< of `move jointN force=`
  Q24 reversal_time_s = Q24::from_double(0.03);  ///< the motor's torque crosses the hysteresis within about this
  ForceErrorConfig error;
  Q24 threshold_nm = Q24::from_double(0.0002);     ///< return of the wanted torque that counts as a reversal
  ReversalTable<Q24, kLevels> grid{.forces = {}};  ///< of preisach
};

/// What the monitor takes for right. 0: not watched.
struct MonitorConfig {
  Q24 joint_rms_rad{};                      ///< of the law's error against a joint sensor
  Q24 torque_rms_nm{};                      ///< of the mean friction torque of a stretch of motion
  Q24 excess = Q24::from_double(1.5);       ///< of either that is still allowed, times
  Q24 settle_rad = Q24::from_double(0.35);  ///< motor's travel after a reversal until its torque is steady
  Q24 tendon_friction_nm{};                 ///< of the healthy friction that of the tendons; 0: all but the motor's own
  Q24 pretension_n{};                       ///< of the healthy joint; 0: not known
  Q24 pretension_95_n{};                    ///< half of its 95 % interval
};

/// How far the joint may be from its estimate, as the law's logs had it. steady_rad 0: nobody knows.
struct ErrorBarConfig {
  Q24 steady_rad{};   ///< what 95 of 100 samples kept within
  Q24 turning_rad{};  ///< the same of those within turn_rad of a reversal
  Q24 turn_rad{};     ///< of the motor since it turned
  Q24 from_rad{};     ///< motor angles that the logs have seen
  Q24 to_rad{};
  Q24 torque_nm{};  ///< largest motor torque that they have seen
};

/// How sure the law of a joint is, as its joint.toml says.
enum class LawStatus : std::int32_t {
  kConfirmed,    ///< its effects are certain, or it was asked for by name
  kProvisional,  ///< it lowers the error for certain; what it is made of is not
  kBase,         ///< nothing was found that lowers the error
};

/// The motor itself, as commissioning finds it: what the motor observer takes for right. Inertia 0: not commissioned.
struct ObserverConfig {
  Q24 inertia_gm2{};   ///< of motor and input pulley, 1 g m2 being 1e-3 kg m2
  Q24 coulomb_nm{};    ///< half of the largest torque that a healthy motor left without a count
  Q24 against_nm{};    ///< largest torque against its own motion that a healthy motor had
  Q24 slack_counts{};  ///< most that a healthy motor slowed down in a cycle, beyond what its torque explains
  Q24 noise_a{};       ///< rms of the measured current about the wanted one, offset included
  /// Share of the wanted current by which the measured one may be off beside that; 0: a sixteenth.
  Q24 gain_error{};
  /// Torque that each radian of motion answers for when it turns round: of tendons, friction along them included. 0:
  /// not watched.
  Q24 stiffness_nm_per_rad{};
  Q24 excess_nm{};  ///< largest torque of a healthy motor beyond what that answered for
  /// Angle for each A of a look by which it moves the motor at rest without a load; 0: not judged.
  Q24 answer_rad_per_a{};
  /// LookAnswer::mark of the gains with which it was found: the servo answers a look too. With others it is not
  /// judged.
  std::int32_t answer_gains = 0;
};

/// The motor torque that a motion takes: what `capstan diagnose --target axis0/tau_Nm` finds. Without coefficients
/// there is no such law.
struct EffortConfig {
  TorqueLawParameters<Q24> law;
  MotionView<Q24> view;
  std::int32_t feedforward = 1;  ///< 1: position control adds the law's torque for the reference's motion
  std::int32_t status = 0;       ///< a LawStatus
};

/// What a jaw of a wrist like the da Vinci's needs to say where its tip is.
struct TipConfig {
  std::int32_t pitch = -1;  ///< the joint that the jaw turns on; -1: this one is no jaw
  JawLinks<Q24> links;
};

/// Every parameter of one joint. Plain numbers only: the parameter table addresses them by offset.
struct AxisConfig {
  MotorConfig motor;
  ControlConfig control;
  LimitConfig limits;
  LawParameters<Q24> law;
  ForceConfig force;
  MonitorConfig monitor;
  ErrorBarConfig error_bar;
  ObserverConfig observer;
  EffortConfig effort;
  /// Joints whose motors pull at this one, by the slots of the law's coupling; -1: none.
  std::array<std::int32_t, kMostOthers> coupled_to = {-1, -1, -1};
  TipConfig tip;
  std::int32_t law_status = 0;  ///< a LawStatus: what `apply` knows of the law and the shell says

  constexpr AxisConfig() { law.coefficients[0] = Q24::from_int(1); }  // rigid until a model is loaded
};
static_assert(std::is_standard_layout_v<AxisConfig>);
/// What a joint has before anybody writes to it. In the program, not on a stack: it is more than a kilobyte.
inline constexpr AxisConfig kDefaultAxis{};

/// Whether another motor pulls at the joint.
inline auto is_pulled(const AxisConfig& config) -> bool {
  const auto& [first, second, third] = config.coupled_to;
  return (first & second & third) >= 0;  // by their signs at once: every cycle asks
}

template <std::size_t Axes>
using Config = std::array<AxisConfig, Axes>;

}  // namespace capstan
