// SPDX-License-Identifier: Apache-2.0
// The shell's commands that move a joint, its motor or its torque, and the one that says where the motor stands.
#include "capstan/firmware/console/shell_commands.hpp"

namespace capstan {

namespace {

class MoveStream final : public ConsentStream {
 public:
  void step(Session& session) override {
    if (!session.machine().requests_taken()) {
      return;
    }
    if (energised(session.machine().telemetry().state)) {
      session.ok();
    } else {
      session.error("not_armed", "torque went away before the move began", "'faults' says why");
    }
  }
};

struct MoveRange {
  const char* what;  ///< "joint" or "motor"
  Q24 lowest_rad, highest_rad;
};

/// Says so where there is no joint. True: nothing may be done.
auto refuses_missing(Session& session, std::size_t axis) -> bool {
  const bool missing = session.machine().config()[axis].motor.fitted == 0;
  if (missing) {
    session.error("not_fitted", "there is no joint (motor.fitted is 0), and nothing was done", "choose another");
  }
  return missing;
}

/// An angle within limits that bear these names. False: it was refused.
auto parse_target(Session& session, std::string_view text, const MoveRange& range, Q24& angle_rad) -> bool {
  const ValueError problem = parse_quantity(text, "rad", angle_rad);
  if (problem == ValueError::kNotANumber || problem == ValueError::kUnit) {
    session.error("not_an_angle", "the target is not an angle, and nothing was done",
                  "write 'move joint0 0.5 rad', 'move joint0 30 deg' or 'move joint0 motor=30 deg'");
    return false;
  }
  if (problem == ValueError::kRange || angle_rad < range.lowest_rad || angle_rad > range.highest_rad) {
    session.out() << "error range: the " << range.what << " moves only from limits." << range.what << "_min "
                  << range.lowest_rad << " to limits." << range.what << "_max " << range.highest_rad
                  << " rad, and nothing was done; give a target in that range\r\n";
    session.refused();
    return false;
  }
  return true;
}

/// Says why the joint can not be given to this mode now. True: nothing may be done.
auto refuses_mode(Session& session, std::size_t axis, ControlMode mode) -> bool {
  const State state = session.machine().telemetry().state;
  const AxisTelemetry joint = session.machine().axis_telemetry(axis);
  if (!energised(state)) {
    session.error("not_armed", "nothing moves or presses without torque", "'arm' first");
    return true;
  }
  if (state == State::kArmed) {
    session.error("not_holding", "the drives do not follow yet, and nothing was done",
                  "wait until 'status' says holding");
    return true;
  }
  // Into joint position from anywhere but a motor on its way; into the others from rest only.
  const bool from_rest = mode != ControlMode::kPosition || joint.mode == ControlMode::kMotor;
  if (from_rest && joint.mode != mode && (state == State::kExperiment || joint.moving)) {
    session.error("moving", "the control mode can change only while the joint is at rest, and it moves",
                  "'hold' it first");
    return true;
  }
  return false;
}

/// Says where the joint is, if it may not be moved from there. True: nothing may be done.
/// @param margin_rad  that it may be outside its limits
auto refuses_outside(Session& session, std::size_t axis, Q24 margin_rad) -> bool {
  const AxisTelemetry joint = session.machine().axis_telemetry(axis);
  const LimitConfig& limits = session.machine().config()[axis].limits;
  const bool outside = is_outside(limits, joint.q2_rad, margin_rad);
  if (outside) {
    session.out() << "error outside: by its law the joint is at " << joint.q2_rad << " rad, outside limits.joint_min "
                  << limits.joint_min_rad << " to limits.joint_max " << limits.joint_max_rad
                  << " rad, and nothing was done; if this angle is wrong, check the law with 'model', or 'disarm' and "
                     "'zero'; if it is right, 'disarm' and turn the joint back by hand\r\n";
    session.refused();
  }
  return outside;
}

void move_joint(Session& session, std::size_t axis, std::string_view target) {
  Request request{.kind = Request::Kind::kMove, .axis = static_cast<std::uint8_t>(axis)};
  const LimitConfig& limits = session.machine().config()[axis].limits;
  if (!parse_target(session, target, {"joint", limits.joint_min_rad, limits.joint_max_rad}, request.position_rad) ||
      refuses_mode(session, axis, ControlMode::kPosition) ||
      refuses_outside(session, axis, limits.following_error_rad)) {
    return;
  }
  request.speed_rad_s = limits.joint_speed_rad_s;
  session.post<MoveStream>(request);
}

void move_motor(Session& session, std::size_t axis, std::string_view target) {
  Request request{.kind = Request::Kind::kMoveMotor, .axis = static_cast<std::uint8_t>(axis)};
  const LimitConfig& limits = session.machine().config()[axis].limits;
  if (!parse_target(session, target, {"motor", limits.motor_min_rad, limits.motor_max_rad}, request.position_rad) ||
      refuses_mode(session, axis, ControlMode::kMotor) || refuses_outside(session, axis, Q24{})) {
    return;
  }
  request.speed_rad_s = limits.joint_speed_rad_s;
  session.post<MoveStream>(request);
}

struct ForceWord {
  std::string_view name;
  std::string_view unit;
  Q24 Request::*value;
};
constexpr std::array<ForceWord, 3> kForceWords = {{{"force", "Nm", &Request::joint_torque_nm},
                                                   {"rate", "Nm/s", &Request::torque_rate_nm_s},
                                                   {"corridor", "rad", &Request::corridor_rad}}};

auto parse_force_word(std::string_view name, std::string_view value, Request& request) -> bool {
  const auto* const word =
      std::find_if(kForceWords.begin(), kForceWords.end(), [&](const ForceWord& w) { return w.name == name; });
  return word != kForceWords.end() && parse_quantity(value, word->unit, request.*word->value) == ValueError::kNone;
}

/// "force=TORQUE [rate=R] [corridor=ANGLE]"
void move_force(Session& session, std::size_t axis, std::string_view arguments) {
  const AxisConfig& config = session.machine().config()[axis];
  Request request{.kind = Request::Kind::kForce,
                  .axis = static_cast<std::uint8_t>(axis),
                  .torque_rate_nm_s = config.force.rate_nm_per_s};
  for (std::string_view word = next_word(arguments); !word.empty(); word = next_word(arguments)) {
    if (refuses_repeat(session, word, arguments)) {
      return;
    }
    const std::size_t sign = std::min(word.find('='), word.size());
    const std::string_view name(word.data(), sign);
    std::string_view value(word.data() + std::min(sign + 1, word.size()),
                           word.size() - std::min(sign + 1, word.size()));
    if (!parse_force_word(name, value, request)) {
      session.error("not_a_torque",
                    "the target is not a joint torque with an optional rate and corridor, and nothing was done",
                    "write 'move joint0 force=0.05Nm rate=0.02Nm/s corridor=5deg'");
      return;
    }
  }
  if (abs(request.joint_torque_nm) > config.limits.joint_torque_nm || request.torque_rate_nm_s <= Q24{}) {
    session.out() << "error range: the joint's torque goes up to limits.joint_torque " << config.limits.joint_torque_nm
                  << " Nm at a rate above 0, and nothing was done; give a target in that range\r\n";
    session.refused();
    return;
  }
  if (request.corridor_rad < Q24{}) {
    session.error("range", "a corridor is an angle to either side, and nothing was done", "give one above 0, or none");
    return;
  }
  if (config.force.law == 0) {
    session.error("no_force_law", "force control inverts a force law, and this joint has none",
                  "identify one with the tip held and 'capstan apply' it");
    return;
  }
  if (!refuses_mode(session, axis, ControlMode::kForce)) {
    session.post<MoveStream>(request);
  }
}

}  // namespace

void commands::move(Session& session, std::string_view arguments) {
  std::string_view joint = next_word(arguments);
  std::size_t axis = 0;
  if (!session.parse_axis(joint, axis) || !joint.empty()) {
    session.error("unknown_joint", "there is no such joint", "write 'move joint0 30 deg'");
    return;
  }
  if (refuses_missing(session, axis)) {
    return;
  }
  constexpr std::string_view kMotor = "motor=";
  skip_blanks(arguments);
  std::string_view rest = arguments;
  if (arguments.starts_with(kMotor)) {
    arguments.remove_prefix(kMotor.size());
    move_motor(session, axis, arguments);
  } else if (next_word(rest).find('=') != std::string_view::npos) {
    move_force(session, axis, arguments);
  } else {
    move_joint(session, axis, arguments);
  }
}

void commands::hold(Session& session, std::string_view arguments) {
  std::string_view joint = next_word(arguments);
  std::size_t axis = 0;
  if (!session.parse_axis(joint, axis) || !joint.empty()) {
    session.error("unknown_joint", "there is no such joint", "write 'hold joint0'");
    return;
  }
  if (refuses_missing(session, axis)) {
    return;
  }
  if (!energised(session.machine().telemetry().state)) {
    session.error("not_armed", "nothing is held without torque", "'arm' first");
    return;
  }
  session.post<MoveStream>({.kind = Request::Kind::kStop, .axis = static_cast<std::uint8_t>(axis)});
}

void commands::zero(Session& session, std::string_view arguments) {
  std::string_view joint = next_word(arguments);
  std::size_t axis = 0;
  if (!session.parse_axis(joint, axis) || !joint.empty()) {
    session.error("unknown_joint", "there is no such joint", "write 'zero joint0' or 'zero joint0 30 deg'");
    return;
  }
  Request request{.kind = Request::Kind::kZero, .axis = static_cast<std::uint8_t>(axis)};
  skip_blanks(arguments);
  const LimitConfig& limits = session.machine().config()[axis].limits;
  const ValueError problem =
      arguments.empty() ? ValueError::kNone : parse_quantity(arguments, "rad", request.position_rad);
  if (problem == ValueError::kNotANumber || problem == ValueError::kUnit) {
    session.error("not_an_angle", "the motor's position is not an angle, and nothing was changed",
                  "write 'zero joint0' or 'zero joint0 30 deg'");
    return;
  }
  if (problem == ValueError::kRange || request.position_rad < limits.motor_min_rad ||
      request.position_rad > limits.motor_max_rad) {
    session.error("range", "a motor cannot stand outside limits.motor_min to limits.motor_max, and nothing was changed",
                  "give the angle at which it stands");
    return;
  }
  if (energised(session.machine().telemetry().state)) {
    session.error("armed", "a new zero would make a joint that is held jump", "'disarm' first");
    return;
  }
  if (session.machine().post(request)) {
    session.answer_when_taken();
  } else {
    session.busy_cycle();
  }
}

}  // namespace capstan
