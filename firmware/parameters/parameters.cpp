// SPDX-License-Identifier: Apache-2.0
#include "capstan/firmware/parameters/parameters.hpp"

#include <algorithm>
#include <array>
#include <cstring>

#include "capstan/firmware/control/trajectory.hpp"
#include "capstan/firmware/parameters/effort_rows.hpp"
#include "capstan/firmware/parameters/name_hash.hpp"
#include "capstan/firmware/parameters/preisach_rows.hpp"
#include "capstan/firmware/safety/motor_observer.hpp"

namespace capstan {
namespace {

constexpr auto kTunable = ParameterChange::kAnyTime;
constexpr auto kSafety = ParameterChange::kMaintenance;
constexpr std::size_t kMotor = offsetof(AxisConfig, motor);
constexpr std::size_t kControl = offsetof(AxisConfig, control);
constexpr std::size_t kLimits = offsetof(AxisConfig, limits);
constexpr std::size_t kLaw = offsetof(AxisConfig, law);
constexpr std::size_t kForce = offsetof(AxisConfig, force);
constexpr std::size_t kMonitor = offsetof(AxisConfig, monitor);
constexpr std::size_t kErrorBar = offsetof(AxisConfig, error_bar);
constexpr std::size_t kCoupledTo = offsetof(AxisConfig, coupled_to);
constexpr std::size_t kObserver = offsetof(AxisConfig, observer);
constexpr std::size_t kTip = offsetof(AxisConfig, tip);
constexpr std::size_t kLinks = kTip + offsetof(TipConfig, links);
constexpr std::size_t kConditioner = kLaw + offsetof(LawParameters<Q24>, conditioner);

constexpr std::array kFixedParameters = {
    integer("motor", "encoder_counts", "1",
            "encoder counts per turn of the input pulley; a safety limit once the joint is commissioned",
            kMotor + offsetof(MotorConfig, encoder_counts_per_turn), 16, 1 << 24),
    integer("motor", "encoder_sign", "1",
            "+1, or -1 if the encoder counts against the torque; a safety limit once the joint is commissioned",
            kMotor + offsetof(MotorConfig, encoder_sign), -1, 1),
    real("motor", "torque_per_current", "Nm/A",
         "torque at the input pulley per motor current; a safety limit once the joint is commissioned",
         kMotor + offsetof(MotorConfig, torque_per_current_nm_per_a), 0.0001, 100.0),
    real("motor", "speed_limit", "rad/s", "an encoder that moves faster is a fault",
         kMotor + offsetof(MotorConfig, speed_limit_rad_s), 0.1, 120.0, kSafety),
    integer("motor", "fitted", "1",
            "1, or 0 if no joint is connected here: it then never blocks arming and never moves",
            kMotor + offsetof(MotorConfig, fitted), 0, 1, kSafety),
    real("control", "kp", "1", "joint loop, proportional: motor rad per joint rad",
         kControl + offsetof(ControlConfig, kp), 0.0, 20.0, kTunable),
    real("control", "ki", "1/s", "joint loop, integral", kControl + offsetof(ControlConfig, ki_per_s), 0.0, 100.0,
         kTunable),
    real("control", "kd", "s", "joint loop, derivative of the estimate", kControl + offsetof(ControlConfig, kd_s), 0.0,
         1.0, kTunable),
    real("control", "integral_limit", "rad", "bound of the integral, motor side",
         kControl + offsetof(ControlConfig, integral_limit_rad), 0.0, 10.0, kTunable),
    real("control", "stiffness", "Nm/rad", "motor servo, proportional",
         kControl + offsetof(ControlConfig, stiffness_nm_per_rad), 0.0, 100.0, kTunable),
    real("control", "damping", "Nms/rad", "motor servo, derivative",
         kControl + offsetof(ControlConfig, damping_nms_per_rad), 0.0, 10.0, kTunable),
    real("control", "rate_time_constant", "s", "motor servo: filter of the rate that the damping acts on",
         kControl + offsetof(ControlConfig, rate_time_constant_s), 0.0, 1.0, kTunable),
    real("control", "torque_forward", "Nm", "torque that keeps the motor moving forward",
         kControl + offsetof(ControlConfig, torque_forward_nm), -50.0, 50.0, kTunable),
    real("control", "torque_backward", "Nm",
         "torque that keeps the motor moving backward, negative where friction rules",
         kControl + offsetof(ControlConfig, torque_backward_nm), -50.0, 50.0, kTunable),
    real("control", "reversal_time", "s", "the feedforward changes direction within about this time",
         kControl + offsetof(ControlConfig, reversal_time_s), 0.001, 2.0, kTunable),
    real("control", "reversal_angle", "rad", "also within about this travel of the motor's reference; 0: at once",
         kControl + offsetof(ControlConfig, reversal_angle_rad), 0.0, 10.0, kTunable),
    real("limits", "current", "A", "peak current", kLimits + offsetof(LimitConfig, current_a), 0.001, 100.0, kSafety),
    real("limits", "continuous_current", "A", "current that the winding carries continuously",
         kLimits + offsetof(LimitConfig, continuous_current_a), 0.001, 100.0, kSafety),
    real("limits", "thermal_time", "s", "thermal time constant of the winding",
         kLimits + offsetof(LimitConfig, thermal_time_s), 0.1, 120.0, kSafety),
    real("limits", "current_rate", "A/cycle", "largest change of the set value in one cycle",
         kLimits + offsetof(LimitConfig, current_rate_a_per_cycle), 0.0001, 100.0, kSafety),
    real("limits", "motor_min", "rad", "tendon travel: no torque further out",
         kLimits + offsetof(LimitConfig, motor_min_rad), -125.0, 125.0, kSafety),
    real("limits", "motor_max", "rad", "tendon travel: no torque further out",
         kLimits + offsetof(LimitConfig, motor_max_rad), -125.0, 125.0, kSafety),
    real("limits", "joint_min", "rad", "smallest reference", kLimits + offsetof(LimitConfig, joint_min_rad), -125.0,
         125.0, kSafety),
    real("limits", "joint_max", "rad", "largest reference", kLimits + offsetof(LimitConfig, joint_max_rad), -125.0,
         125.0, kSafety),
    real("limits", "joint_speed", "rad/s", "largest speed of a reference",
         kLimits + offsetof(LimitConfig, joint_speed_rad_s), 0.001, 100.0, kSafety),
    real("limits", "joint_acceleration", "rad/s2", "acceleration of moves and streams",
         kLimits + offsetof(LimitConfig, joint_acceleration_rad_s2), 0.01, 60.0, kSafety),
    real("limits", "joint_jerk", "krad/s3", "change of the acceleration of moves, 1 krad/s3 being 1 rad/s2 in 1 ms",
         kLimits + offsetof(LimitConfig, joint_jerk_krad_s3), 0.01, 120.0, kSafety),
    real("limits", "following_error", "rad", "larger for longer than following_time is a fault",
         kLimits + offsetof(LimitConfig, following_error_rad), 0.001, 10.0, kSafety),
    real("limits", "following_time", "s", "how long following_error may be exceeded",
         kLimits + offsetof(LimitConfig, following_time_s), 0.001, 10.0, kSafety),
    real("limits", "current_mismatch", "A", "measured and wanted current may differ by this for 50 ms",
         kLimits + offsetof(LimitConfig, current_mismatch_a), 0.001, 100.0, kSafety),
    real("limits", "joint_torque", "Nm", "largest torque that force control may be asked for",
         kLimits + offsetof(LimitConfig, joint_torque_nm), 0.0, 100.0, kSafety),
    real("limits", "supply_min", "V", "a lower supply of the amplifier is a fault; 0: not watched",
         kLimits + offsetof(LimitConfig, supply_min_v), 0.0, 127.0, kSafety),
    real("limits", "fault_travel", "rad",
         "how far a fault may move the joint until it stands; bounds the torque's slew",
         kLimits + offsetof(LimitConfig, fault_travel_rad), 0.001, 10.0, kSafety),
    real("conditioner", "direction_threshold", "rad", "return of the motor that counts as a reversal",
         kConditioner + offsetof(ConditionerShape<Q24>, direction_threshold_rad), 0.0, 1.0),
    real("conditioner", "rate_time_constant", "s", "filter of the motor's rate",
         kConditioner + offsetof(ConditionerShape<Q24>, rate_time_constant_s), 0.0, 1.0),
    integer("axis_coupling", "joint", "1", "joint whose motor pulls at this one; -1: none", kCoupledTo, -1, 3),
    integer("axis_coupling", "joint_2", "1", "the second such joint, for coupled_hysteresis_2; -1: none",
            kCoupledTo + sizeof(std::int32_t), -1, 3),
    integer("axis_coupling", "joint_3", "1", "the third, for coupled_hysteresis_3; -1: none",
            kCoupledTo + 2 * sizeof(std::int32_t), -1, 3),
    integer("tip", "pitch", "1", "joint that carries this one, if it is a wrist's jaw, for its tip; -1: it is no jaw",
            kTip + offsetof(TipConfig, pitch), -1, 3),
    real("tip", "pitch_to_jaw", "m", "distance from the pitch's axis to the jaw's",
         kLinks + offsetof(JawLinks<Q24>, pitch_to_jaw_m), 0.0, 0.5),
    real("tip", "jaw", "m", "distance from the jaw's axis to its tip", kLinks + offsetof(JawLinks<Q24>, jaw_m), 0.0,
         0.5),
    real("tip", "offset", "m", "offset of the tip along the jaw's axis", kLinks + offsetof(JawLinks<Q24>, offset_m),
         -0.1, 0.1),
    integer("law", "status", "1", "status of the law: 0 confirmed, 1 provisional, 2 base",
            offsetof(AxisConfig, law_status), 0, 2),
    integer("force", "law", "1", "motor torque to joint torque: 0 none, 1 pull, 2 pull-push, 3 preisach, 4 blend",
            kForce + offsetof(ForceConfig, law), 0, 4),
    real("force", "eta_top", "1", "friction-bending number of the top tendon", kForce + offsetof(ForceConfig, eta_top),
         0.0, 3.0),
    real("force", "eta_bottom", "1", "friction-bending number of the bottom tendon",
         kForce + offsetof(ForceConfig, eta_bottom), 0.0, 3.0),
    real("force", "pretension", "Nm", "tendon integral times the input radius, I r1",
         kForce + offsetof(ForceConfig, pretension_nm), 0.0, 8.0),
    real("force", "ratio", "1", "output radius over input radius, r2 / r1", kForce + offsetof(ForceConfig, ratio),
         0.001, 4.0),
    real("force", "pull_weight", "1", "weight of the pull model in the blend (2.27)",
         kForce + offsetof(ForceConfig, pull_weight), 0.0, 2.0),
    real("force", "pull_push_weight", "1", "weight of the pull-push model in the blend (2.27)",
         kForce + offsetof(ForceConfig, pull_push_weight), 0.0, 2.0),
    real("force", "friction", "Nm", "the motor's own friction", kForce + offsetof(ForceConfig, friction_nm), 0.0, 8.0),
    real("force", "offset", "Nm", "offset of the motor's torque", kForce + offsetof(ForceConfig, offset_nm), -8.0, 8.0),
    real("force", "stiffness_top", "Nm/rad",
         "stiffness of the top tendon at the motor, r1^2 K, for palpation; 0: unknown",
         kForce + offsetof(ForceConfig, stiffness_top_nm_per_rad), 0.0, 127.0),
    real("force", "stiffness_bottom", "Nm/rad", "stiffness of the bottom tendon at the motor; 0: unknown",
         kForce + offsetof(ForceConfig, stiffness_bottom_nm_per_rad), 0.0, 127.0),
    real("force", "rate", "Nm/s", "how fast 'move jointN force=' changes the joint's torque",
         kForce + offsetof(ForceConfig, rate_nm_per_s), 0.0001, 100.0, kTunable),
    real("force", "reversal_time", "s", "the motor's torque crosses the hysteresis within about this time",
         kForce + offsetof(ForceConfig, reversal_time_s), 0.001, 2.0, kTunable),
    real("force", "threshold", "Nm", "return of the wanted joint torque that counts as a reversal",
         kForce + offsetof(ForceConfig, threshold_nm), 0.0, 1.0, kTunable),
    real("force", "error_steady", "Nm", "95 % error bound of the joint torque; 0: unknown",
         kForce + offsetof(ForceConfig, error) + offsetof(ForceErrorConfig, steady_nm), 0.0, 100.0),
    real("force", "error_turning", "Nm", "95 % error bound within force.error_turn of a reversal of the motor's torque",
         kForce + offsetof(ForceConfig, error) + offsetof(ForceErrorConfig, turning_nm), 0.0, 100.0),
    real("force", "error_turn", "Nm",
         "change of the motor's torque after a reversal for which force.error_turning holds",
         kForce + offsetof(ForceConfig, error) + offsetof(ForceErrorConfig, turn_nm), 0.0, 100.0),
    real("force", "error_torque", "Nm", "largest motor torque in the identification logs, either way",
         kForce + offsetof(ForceConfig, error) + offsetof(ForceErrorConfig, torque_nm), 0.0, 100.0),
    real("monitor", "joint_rms", "rad", "expected error of the law against the joint's sensor; 0: not monitored",
         kMonitor + offsetof(MonitorConfig, joint_rms_rad), 0.0, 1.0),
    real("monitor", "torque_rms", "Nm",
         "expected error of the mean friction torque, without a joint sensor; 0: not monitored",
         kMonitor + offsetof(MonitorConfig, torque_rms_nm), 0.0, 10.0),
    real("monitor", "excess", "1", "a warning comes when either error is larger than this times the expected",
         kMonitor + offsetof(MonitorConfig, excess), 1.1, 5.0),
    real("monitor", "settle", "rad", "motor's travel after a reversal until its torque is steady",
         kMonitor + offsetof(MonitorConfig, settle_rad), 0.0, 10.0),
    real("monitor", "tendon_friction", "Nm",
         "the tendons' share of the steady friction, eta I r1; 0: all of it except observer.coulomb",
         kMonitor + offsetof(MonitorConfig, tendon_friction_nm), 0.0, 100.0),
    real("monitor", "pretension", "N", "pretension of the healthy joint's tendons; 0: unknown",
         kMonitor + offsetof(MonitorConfig, pretension_n), 0.0, 127.0),
    real("monitor", "pretension_error", "N", "half of the 95 % interval of monitor.pretension",
         kMonitor + offsetof(MonitorConfig, pretension_95_n), 0.0, 127.0),
    real("error_bar", "steady", "rad", "95 % error bound of the joint angle; 0: unknown",
         kErrorBar + offsetof(ErrorBarConfig, steady_rad), 0.0, 7.0),
    real("error_bar", "turning", "rad", "95 % error bound within error_bar.turn of a reversal",
         kErrorBar + offsetof(ErrorBarConfig, turning_rad), 0.0, 7.0),
    real("error_bar", "turn", "rad", "motor's travel after a reversal for which error_bar.turning holds",
         kErrorBar + offsetof(ErrorBarConfig, turn_rad), 0.0, 100.0),
    real("error_bar", "from", "rad", "smallest motor angle in the identification logs",
         kErrorBar + offsetof(ErrorBarConfig, from_rad), -127.0, 127.0),
    real("error_bar", "to", "rad", "largest motor angle in the identification logs",
         kErrorBar + offsetof(ErrorBarConfig, to_rad), -127.0, 127.0),
    real("error_bar", "torque", "Nm", "largest motor torque in the identification logs, either way",
         kErrorBar + offsetof(ErrorBarConfig, torque_nm), 0.0, 127.0),
    real("observer", "inertia", "gm2",
         "inertia of motor and input pulley, as commissioned; 0: unknown, and nothing is monitored with it",
         kObserver + offsetof(ObserverConfig, inertia_gm2), 0.0, 100.0, kSafety),
    real("observer", "coulomb", "Nm", "half of the largest torque that a healthy motor leaves without a count",
         kObserver + offsetof(ObserverConfig, coulomb_nm), 0.0, 100.0, kSafety),
    real("observer", "against", "Nm", "largest torque against its own motion that a healthy motor had",
         kObserver + offsetof(ObserverConfig, against_nm), 0.0, 100.0, kSafety),
    real("observer", "slack", "1",
         "counts a cycle that a healthy motor slows down by in one cycle, beyond what its torque explains",
         kObserver + offsetof(ObserverConfig, slack_counts), 0.0, 100.0, kSafety),
    real("observer", "noise", "A", "noise of the measured current about the commanded one, offset included",
         kObserver + offsetof(ObserverConfig, noise_a), 0.0, 10.0, kSafety),
    real("observer", "gain_error", "1", "relative error of the measured current beyond its noise; 0: a sixteenth",
         kObserver + offsetof(ObserverConfig, gain_error), 0.0, 0.5, kSafety),
    real("observer", "stiffness", "Nm/rad", "torque per radian of travel after the motor reverses; 0: not monitored",
         kObserver + offsetof(ObserverConfig, stiffness_nm_per_rad), 0.0, 100.0, kSafety),
    real("observer", "excess", "Nm", "largest torque of a healthy motor beyond observer.stiffness times travel",
         kObserver + offsetof(ObserverConfig, excess_nm), 0.0, 100.0, kSafety),
    real("observer", "answer", "rad/A", "motor angle per A of a test pulse at rest without load; 0: not checked",
         kObserver + offsetof(ObserverConfig, answer_rad_per_a), 0.0, 100.0, kSafety),
    integer("observer", "answer_gains", "1",
            "checksum of the control.* gains used for observer.answer; with other gains the answer is not checked",
            kObserver + offsetof(ObserverConfig, answer_gains), 0, (1 << 24) - 1, kSafety),
};

constexpr std::size_t kLawAt = kFixedParameters.size() + kPreisachTable.size();
constexpr std::size_t kEffortAt = kLawAt + kCoefficientCount + kShapeCount;
constexpr std::size_t kCount = kEffortAt + kEffortRows;
static_assert(kCount <= kMostParameters);

/// Walks a list of terms and writes a row for every coefficient and shape it declares.
class LawRows {
 public:
  constexpr explicit LawRows(std::array<ParameterInfo, kCount>& table) : table_(table) {}
  template <typename Term>
  constexpr void operator()() {
    for (const CoefficientInfo& c : Term::kInfo.coefficients) {
      table_[next_++] = real(Term::kInfo.name, c.name, c.unit, c.doc,
                             kLaw + offsetof(LawParameters<Q24>, coefficients) + coefficient_++ * sizeof(Q24),
                             c.sign == Sign::kNonNegative ? 0.0 : -kCoefficientLimit,
                             c.sign == Sign::kNonPositive ? 0.0 : kCoefficientLimit);
    }
    for (const ShapeInfo& s : Term::kInfo.shapes) {
      table_[next_++] =
          shape(Term::kInfo.name, s, kLaw + offsetof(LawParameters<Q24>, shapes) + shape_++ * sizeof(Q24));
    }
  }

 private:
  std::array<ParameterInfo, kCount>& table_;
  std::size_t next_ = kLawAt;
  std::size_t coefficient_ = 0;
  std::size_t shape_ = 0;
};

constexpr auto make_table() -> std::array<ParameterInfo, kCount> {
  std::array<ParameterInfo, kCount> table{};
  std::copy(kFixedParameters.begin(), kFixedParameters.end(), table.begin());
  std::copy(kPreisachTable.begin(), kPreisachTable.end(), table.begin() + kFixedParameters.size());
  LawRows rows(table);
  for_each_term<Q24>(rows);
  std::copy(kEffortTable.begin(), kEffortTable.end(), table.begin() + kEffortAt);
  return table;
}

constexpr std::array<ParameterInfo, kCount> kTable = make_table();

// Two names with one hash would share their stored value. FNV-1a begins with the joint's number, so what is unique for
// one joint is checked for each.
template <std::size_t Axis>
consteval auto hashes_are_unique() -> bool {
  std::array<std::uint32_t, kCount> hashes{};
  for (std::size_t i = 0; i < kCount; ++i) {
    hashes[i] = name_hash(Axis, kTable[i].group, kTable[i].name);
  }
  std::sort(hashes.begin(), hashes.end());
  return std::adjacent_find(hashes.begin(), hashes.end()) == hashes.end();
}
static_assert(hashes_are_unique<0>() && hashes_are_unique<1>() && hashes_are_unique<2>() && hashes_are_unique<3>());

}  // namespace

auto parameters() -> std::span<const ParameterInfo> {
  return kTable;
}

auto find_parameter(std::string_view group_dot_name) -> const ParameterInfo* {
  const std::size_t dot = group_dot_name.find('.');
  if (dot == std::string_view::npos) {
    return nullptr;
  }
  const std::string_view group(group_dot_name.data(), dot);
  const std::string_view name(group_dot_name.data() + dot + 1, group_dot_name.size() - dot - 1);
  for (const ParameterInfo& parameter : kTable) {
    if (group == parameter.group && name == parameter.name) {
      return &parameter;
    }
  }
  return nullptr;
}

auto raw_value(const AxisConfig& config, const ParameterInfo& parameter) -> std::int32_t {
  std::int32_t raw = 0;
  std::memcpy(&raw, reinterpret_cast<const char*>(&config) + parameter.offset, sizeof raw);
  return raw;
}

void set_raw_value(AxisConfig& config, const ParameterInfo& parameter, std::int32_t raw) {
  std::memcpy(reinterpret_cast<char*>(&config) + parameter.offset, &raw, sizeof raw);
}

namespace {

auto check_law(const LawParameters<Q24>& law) -> const char* {
  if (abs(law.coefficients[0]) < Q24::from_double(0.01)) {
    return "motor_angle.beta is nearly zero, so the law can not be inverted; set it to the ratio of the pulley radii";
  }
  if (!fits(law)) {
    return "the law's coefficients add up to 256 or more, which its numbers do not hold; look for one that is far too "
           "large";
  }
  switch (check_parts(law)) {
    case LawFault::kRatioTurnsBack:
      return "the curve of curved_ratio turns back within its span, so the law can not be inverted; make square and "
             "cube smaller or span larger";
    case LawFault::kTableEnds:
      return "a table with values needs table.low below table.high; set these two in order first";
    case LawFault::kNone:
      break;
  }
  return nullptr;
}

}  // namespace

auto check(const AxisConfig& config) -> const char* {
  if (const char* fault = check_law(config.law); fault != nullptr) {
    return fault;
  }
  if (!fits(config.effort.law)) {
    return "the effort law's coefficients add up to 256 or more, which its numbers do not hold; look for one "
           "that is far too large";
  }
  if (config.motor.encoder_sign == 0) {
    return "motor.encoder_sign is 0; set it to 1 or -1";
  }
  if (config.limits.motor_min_rad >= config.limits.motor_max_rad) {
    return "limits.motor_min is not below limits.motor_max; set them in order";
  }
  if (config.limits.joint_min_rad >= config.limits.joint_max_rad) {
    return "limits.joint_min is not below limits.joint_max; set them in order";
  }
  if (!Trajectory::can_keep(config.limits)) {
    return "limits.joint_jerk is below a sixteenth of limits.joint_acceleration, so that would take longer than 32 ms "
           "to build up; raise the one or lower the other";
  }
  if (config.limits.continuous_current_a > config.limits.current_a) {
    return "limits.continuous_current is above limits.current; lower it or raise limits.current";
  }
  // Of numbers that may be near the end of Q24 each, so the product is not taken in it.
  const std::int64_t most_nm =
      static_cast<std::int64_t>(config.limits.current_a.raw()) * config.motor.torque_per_current_nm_per_a.raw();
  const std::int64_t steady_nm =
      std::max(abs(config.control.torque_forward_nm), abs(config.control.torque_backward_nm)).raw();
  if (steady_nm << Q24::kFrac > most_nm) {
    return "control.torque_forward or torque_backward is more than limits.current gives; they are in N m, "
           "and units may be given, as in 10mNm";
  }
  if (const char* sentence = MotorObserver::check(config)) {
    return sentence;
  }
  if (config.force.law == static_cast<std::int32_t>(ForceLawKind::kBlend) && config.force.pull_weight == Q24{} &&
      config.force.pull_push_weight == Q24{}) {
    return "force.pull_weight and force.pull_push_weight are both 0; give the blend one of them, or set force.law to 2";
  }
  const TableCheck grid = check_grid(config);
  return grid.ok() ? nullptr : describe(grid.fault);
}

auto check_grid(const AxisConfig& config) -> TableCheck {
  return config.force.law == static_cast<std::int32_t>(ForceLawKind::kPreisach)
             ? check(config.force.grid, ForceConfig::Law::kRounding)
             : TableCheck{};
}

}  // namespace capstan
