// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/log/axis_log.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "capstan/tools/log/axis_gate.hpp"
#include "capstan/tools/log/channel_shape.hpp"
#include "capstan/tools/log/common_rows.hpp"
#include "capstan/tools/log/time_scale.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/statistics.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

/// Timing that the maths below can take as even: within a tenth of a period, 99 times of 100.
constexpr double kSmallJitter = 0.1;
/// A step this many periods long is a gap.
constexpr double kGap = 1.5;
/// What is read of other axes.
constexpr std::array kBeside = {"q1_rad", "q1_m", "tau_Nm"};

void check_timing(const CsvLog& csv, AxisLog& axis) {
  const Eigen::Index n = axis.samples();
  if (n < 3) {
    throw BadInput(place(csv.name(), 2) + "the log has only " + std::to_string(n) + (n == 1 ? " row" : " rows") +
                   "; record at least a few seconds");
  }
  const Eigen::VectorXd steps = axis.time_s.tail(n - 1) - axis.time_s.head(n - 1);
  axis.period_s = median(steps);
  if (const std::string fault = time_unit_fault(axis.period_s); !fault.empty() && !csv.time_is_mapped()) {
    throw BadInput(place(csv.name(), csv.line_of(0)) + fault);
  }
  const double jitter = quantile((steps.array() / axis.period_s - 1.0).abs().matrix(), 0.99);
  if (jitter > kSmallJitter) {
    axis.warnings.push_back(csv.name() + ": the time between samples varies by " + rounded(100.0 * jitter, 2) +
                            " % (99th percentile) around " + rounded(1e3 * axis.period_s) +
                            " ms and is taken as even; results on delays and speeds are less sure");
  }
  Eigen::Index longest = 0;
  const double gap = steps.maxCoeff(&longest);
  if (gap > kGap * axis.period_s) {
    const auto count = (steps.array() > kGap * axis.period_s).count();
    axis.warnings.push_back(place(csv.name(), csv.line_of(static_cast<std::size_t>(longest) + 1)) +
                            std::to_string(count) + " gaps in time, the longest " + rounded(1e3 * gap) +
                            " ms, here; nothing was filled in");
  }
}

void check_motion(const CsvLog& csv, const AxisLog& axis, const std::string& name, const Eigen::VectorXd& values) {
  if (varies(values)) {
    return;
  }
  throw BadInput(place(csv.name(), 2) + name + " stands at " + rounded(values[0]) + " from here to line " +
                 std::to_string(csv.line_of(static_cast<std::size_t>(axis.samples()) - 1)) +
                 "; record the joint while it moves, or name another column with --map");
}

/// A linear axis may have its own names for motion and effort.
auto rotary_or_linear(const CsvLog& csv, int axis, const char* rotary, const char* linear) -> std::string {
  const std::string name = axis_column(axis, rotary);
  return !csv.has(name) && csv.has(axis_column(axis, linear)) ? axis_column(axis, linear) : name;
}

/// @param why  the axis is wanted
void expect_angle(const CsvLog& csv, const std::string& q1, const std::string& why) {
  if (!csv.has(q1)) {
    throw BadInput(place(csv.name(), 1) + why + ", and the log has no " + q1 +
                   "; record that axis with it, or name its column with --map \"" + q1 + "=COLUMN\"");
  }
}

/// The other axes and the temperature, which terms of the law may read.
void read_surroundings(const CsvLog& csv, const AxisRequest& request, AxisLog& result) {
  constexpr const char* kTemperature = "temperature_C";
  if (csv.has(kTemperature) && varies(csv.column(kTemperature))) {
    result.temperature_c = csv.column(kTemperature);
  }
  const auto add = [&](int other) {
    const std::string tau = axis_column(other, "tau_Nm");
    result.others.push_back(
        {other, csv.column(axis_column(other, "q1_rad")),
         csv.has(tau) ? csv.column(tau) : Eigen::VectorXd(Eigen::VectorXd::Zero(result.samples()))});
  };
  const auto& asked = request.other_axes;
  for (const int other : asked) {
    expect_angle(csv, axis_column(other, "q1_rad"), "the joint is coupled to axis " + std::to_string(other));
    add(other);
  }
  result.others_asked = asked.size();
  for (const int other : request.moving_axes ? *request.moving_axes : moving_axes(csv, request.axis)) {
    expect_angle(csv, rotary_or_linear(csv, other, "q1_rad", "q1_m"),
                 "axis " + std::to_string(other) + " moves in another of the logs");
    const bool is_asked = std::find(asked.begin(), asked.end(), other) != asked.end();
    if (!is_asked && csv.has(axis_column(other, "q1_rad"))) {
      add(other);
    }
  }
}

/// Every signal beside the axis: a possible cause of what the law misses.
void read_side_signals(const CsvLog& csv, int axis, AxisLog& result) {
  std::vector<std::string> names = {"temperature_C"};
  for (int other = 0; other < kMostAxes; ++other) {
    if (other != axis) {
      for (const char* quantity : kBeside) {
        names.push_back(axis_column(other, quantity));
      }
    }
  }
  for (const auto& name : names) {
    if (csv.has(name)) {
      result.side.push_back({name, csv.column(name)});
    }
  }
}

void read_angle(const CsvLog& csv, const AxisRequest& request, AxisLog& axis) {
  const std::string tau = axis_column(request.axis, "tau_Nm");
  axis.has_torque = request.needs_torque || csv.has(tau);
  axis.tau_nm = axis.has_torque ? csv.column(tau) : Eigen::VectorXd::Zero(axis.samples());
  if (axis.has_torque && !request.needs_torque && axis.tau_nm.maxCoeff() == axis.tau_nm.minCoeff()) {
    axis.has_torque = false;
    axis.tau_nm.setZero();
    axis.warnings.push_back(csv.name() + ": " + tau +
                            " never changes, so this counts as a log without torque; check its "
                            "sensor, or leave the column out");
  }
  const std::string target = request.target.empty() ? axis_column(request.axis, "q2_rad") : request.target;
  if (request.needs_target || csv.has(target)) {
    axis.target = target;
    axis.q2_rad = csv.column(target);
    if (request.needs_target) {
      check_motion(csv, axis, target, axis.q2_rad);
    }
  }
}

/// Joint torque from motor torque.
void read_force(const CsvLog& csv, const AxisRequest& request, AxisLog& axis) {
  const std::string tau = axis_column(request.axis, "tau_Nm");
  axis.target = request.target.empty() ? axis_column(request.axis, "tau_out_Nm") : request.target;
  if (axis.target == tau) {
    throw BadInput("a force law gives the joint's torque from the motor's, and the target " + tau +
                   " is the motor's; name the joint's, for instance --target " +
                   axis_column(request.axis, "tau_out_Nm"));
  }
  axis.tau_nm = csv.column(tau);
  axis.effort = csv.column(axis.target);
  axis.has_torque = true;
  check_motion(csv, axis, tau, axis.tau_nm);
  check_motion(csv, axis, axis.target, axis.effort);
}

void read_effort(const CsvLog& csv, const AxisRequest& request, AxisLog& axis) {
  axis.target = request.target.empty() ? rotary_or_linear(csv, request.axis, "tau_Nm", "tau_N") : request.target;
  axis.effort = csv.column(axis.target);
  axis.linear = axis.target.ends_with("_N") || csv.source_name(axis.target).ends_with("_N");
  check_motion(csv, axis, axis.target, axis.effort);
  axis.tau_nm = Eigen::VectorXd::Zero(axis.samples());
  if (const std::string q2 = axis_column(request.axis, "q2_rad"); csv.has(q2)) {
    axis.q2_rad = csv.column(q2);
  }
}

}  // namespace

auto is_effort_column(const std::string& name) -> bool {
  return name.ends_with("_Nm") || name.ends_with("_N");
}

auto axis_column(int axis, const std::string& quantity) -> std::string {
  return "axis" + std::to_string(axis) + "/" + quantity;
}

auto axis_of_column(const std::string& column) -> int {
  constexpr std::string_view kAxis = "axis";
  int axis = 0;
  if (column.starts_with(kAxis)) {
    std::from_chars(column.data() + kAxis.size(), column.data() + column.size(), axis);
  }
  return axis;
}

auto moving_axes(const CsvLog& log, int axis) -> std::vector<int> {
  std::vector<int> moving;
  for (int other = 0; other < kMostAxes; ++other) {
    const std::string q1 = rotary_or_linear(log, other, "q1_rad", "q1_m");
    if (other == axis || !log.has(q1)) {
      continue;
    }
    const Eigen::VectorXd values = log.column_with_gaps(q1);
    if (values.size() > 0 && values.minCoeff<Eigen::PropagateNumbers>() < values.maxCoeff<Eigen::PropagateNumbers>()) {
      moving.push_back(other);
    }
  }
  return moving;
}

auto common_rows_of(const CsvLog& csv, const AxisRequest& request, std::vector<std::string>& notes) -> CsvLog {
  std::vector<std::string> main;
  for (const char* quantity : {"q1_rad", "q1_m", "tau_Nm", "tau_N"}) {
    main.push_back(axis_column(request.axis, quantity));
  }
  const std::string target =
      request.target.empty() ? axis_column(request.axis, request.force ? "tau_out_Nm" : "q2_rad") : request.target;
  if (std::find(main.begin(), main.end(), target) == main.end()) {
    main.push_back(target);
  }
  std::vector<std::string> others = {"temperature_C"};
  if (target != axis_column(request.axis, "q2_rad")) {
    others.push_back(axis_column(request.axis, "q2_rad"));
  }
  for (int other = 0; other < kMostAxes; ++other) {
    if (other != request.axis) {
      for (const char* quantity : kBeside) {
        others.push_back(axis_column(other, quantity));
      }
    }
  }
  return with_common_rows(csv, main, others, notes);
}

namespace {

/// Effects have the signs of a joint that goes with its motor, and play, tension and mass are held to theirs.
void note_crossed(AxisLog& axis) {
  const Eigen::VectorXd motor = (axis.q1_rad.array() - axis.q1_rad.mean()).matrix();
  const Eigen::VectorXd joint = (axis.q2_rad.array() - axis.q2_rad.mean()).matrix();
  if (motor.dot(joint) < -0.5 * motor.norm() * joint.norm()) {
    axis.warnings.push_back(axis.name + ": " + axis.target +
                            " falls while the motor's angle rises; effects have the signs of a joint that goes with "
                            "its motor, so some can not be found: count the joint the other way (--map \"" +
                            axis.target + "=COLUMN*-1\")");
  }
}

}  // namespace

auto read_axis(const CsvLog& all_rows, const AxisRequest& request) -> AxisLog {
  AxisLog axis;
  axis.name = all_rows.name();
  axis.number = request.axis;
  axis.warnings = all_rows.warnings();
  const CsvLog csv = common_rows_of(all_rows, request, axis.warnings);
  axis.time_s = csv.time();
  check_timing(csv, axis);
  const std::string q1 = rotary_or_linear(csv, request.axis, "q1_rad", request.effort ? "q1_m" : "q1_rad");
  axis.q1_rad = csv.column(q1);
  check_motion(csv, axis, q1, axis.q1_rad);
  if (request.force) {
    read_force(csv, request, axis);
  } else if (request.effort) {
    read_effort(csv, request, axis);
  } else {
    read_angle(csv, request, axis);
  }
  read_surroundings(csv, request, axis);
  read_side_signals(csv, request.axis, axis);
  pass_gate(csv, request, q1, axis);
  if (axis.q2_rad.size() > 0 && request.needs_target && !request.every_row) {
    note_crossed(axis);
  }
  return axis;
}

auto total_samples(const std::vector<AxisLog>& logs) -> Eigen::Index {
  Eigen::Index total = 0;
  for (const auto& log : logs) {
    total += log.samples();
  }
  return total;
}

auto first_rows(AxisLog log, Eigen::Index rows) -> AxisLog {
  for_each_signal(log, [rows](Eigen::VectorXd& signal) { signal.conservativeResize(std::min(rows, signal.size())); });
  return log;
}

auto rows_from(AxisLog log, Eigen::Index first) -> AxisLog {
  for_each_signal(log, [first](Eigen::VectorXd& signal) {
    signal = Eigen::VectorXd(signal.tail(std::max<Eigen::Index>(0, signal.size() - first)));
  });
  return log;
}

auto only_rows(AxisLog log, const std::vector<Eigen::Index>& rows) -> AxisLog {
  for_each_signal(log, [&](Eigen::VectorXd& signal) {
    if (signal.size() > 0) {
      signal = Eigen::VectorXd(signal(rows));
    }
  });
  return log;
}

}  // namespace capstan::tools
