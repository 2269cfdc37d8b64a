// SPDX-License-Identifier: Apache-2.0
// A board's gains, and what bounds them, from its `dump`.
#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

#include "capstan/firmware/safety/motor_observer.hpp"
#include "capstan/tools/response/tuning.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

/// Values of the dump that the gains' bounds follow from; what it does not have is the firmware's.
struct Bounds {
  double torque_per_current = 0.1, continuous_a = 1.5;
  double rate_a = LimitConfig{}.current_rate_a_per_cycle.to_double();
  double joint_speed = LimitConfig{}.joint_speed_rad_s.to_double();
  double fault_travel = LimitConfig{}.fault_travel_rad.to_double();
  double inertia_gm2 = 0.0;

  /// As the board's gate has it: limits.current_rate, or less where the observer asks for it.
  [[nodiscard]] auto rate_nm() const -> double {
    AxisConfig board;
    board.motor.torque_per_current_nm_per_a = Q24::from_double(torque_per_current);
    board.limits.joint_speed_rad_s = Q24::from_double(joint_speed);
    board.limits.fault_travel_rad = Q24::from_double(fault_travel);
    board.observer.inertia_gm2 = Q24::from_double(inertia_gm2);
    return torque_per_current * std::min(rate_a, MotorObserver::slew_limit(board).to_double());
  }
};

/// The number of a line 'set NAME NUMBER'; nothing: it is another line.
auto number_of(const std::string& line, const std::string& wanted) -> std::optional<double> {
  std::istringstream words(line);
  std::string set;
  std::string name;
  std::string value;
  words >> set >> name >> value;
  if (set != "set" || name != wanted) {
    return {};
  }
  const std::optional<double> number = parse_number(value);
  if (!number || !std::isfinite(*number) || *number < 0.0) {
    throw BadInput("the dump's line '" + line +
                   "' has no number of 0 or more; write 'dump' at the prompt and keep its answer");
  }
  return number;
}

}  // namespace

auto read_gains(const std::string& dump, int axis) -> LoopGains {
  LoopGains gains;
  Bounds bounds;
  const std::string prefix = "joint" + std::to_string(axis) + ".";
  const std::vector<std::pair<std::string, double*>> rows = {
      {"control.kp", &gains.kp},
      {"control.ki", &gains.ki_per_s},
      {"control.kd", &gains.kd_s},
      {"control.stiffness", &gains.stiffness},
      {"control.damping", &gains.damping},
      {"control.rate_time_constant", &gains.rate_time_constant_s},
      {"motor.encoder_counts", &gains.counts_per_turn},
      {"motor.torque_per_current", &bounds.torque_per_current},
      {"limits.continuous_current", &bounds.continuous_a},
      {"limits.current_rate", &bounds.rate_a},
      {"limits.joint_speed", &bounds.joint_speed},
      {"limits.fault_travel", &bounds.fault_travel},
      {"observer.inertia", &bounds.inertia_gm2}};
  std::istringstream text(dump);
  int found = 0;
  for (std::string line; std::getline(text, line);) {
    for (const auto& [row, into] : rows) {
      if (const std::optional<double> number = number_of(line, prefix + row)) {
        *into = *number;
        ++found;
      }
    }
  }
  if (found == 0) {
    throw BadInput("the dump has no line 'set " + prefix +
                   "control...'; write 'dump' at the board's prompt and keep its answer in a file");
  }
  gains.continuous_nm = bounds.torque_per_current * bounds.continuous_a;
  gains.rate_nm = bounds.rate_nm();
  return gains;
}

}  // namespace capstan::tools
