// SPDX-License-Identifier: Apache-2.0
#include "tools/log/axis_log.hpp"

#include <algorithm>
#include <cmath>

#include "tools/support/errors.hpp"
#include "tools/support/statistics.hpp"
#include "tools/support/text.hpp"

namespace capstan::tools {
namespace {

/// Timing that the maths below can take as even: within a tenth of a period, 99 times of 100.
constexpr double kSmallJitter = 0.1;
/// A step this many periods long is a gap.
constexpr double kGap = 1.5;

void check_timing(const CsvLog& csv, AxisLog& axis) {
  const Eigen::Index n = axis.samples();
  if (n < 3) {
    throw BadInput(place(csv.name(), 2) + "the log has only " + std::to_string(n) +
                   " rows; record at least a few seconds");
  }
  const Eigen::VectorXd steps = axis.time_s.tail(n - 1) - axis.time_s.head(n - 1);
  axis.period_s = median(steps);
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
  if (values.maxCoeff() - values.minCoeff() > 0.0) {
    return;
  }
  throw BadInput(place(csv.name(), 2) + name + " stands at " + rounded(values[0]) + " from here to line " +
                 std::to_string(csv.line_of(static_cast<std::size_t>(axis.samples()) - 1)) +
                 "; record the joint while it moves, or name another column with --map");
}

/// A joint sensor slower than the log holds each value for several samples; that is a delay, and worth knowing.
void check_held(const CsvLog& csv, AxisLog& axis) {
  std::vector<double> runs;
  double run = 1.0;
  for (Eigen::Index i = 1; i < axis.samples(); ++i) {
    if (axis.q2_rad[i] != axis.q2_rad[i - 1]) {
      runs.push_back(run);
      run = 0.0;
    }
    run += 1.0;
  }
  if (runs.size() < 20) {
    return;
  }
  const Eigen::VectorXd lengths =
      Eigen::Map<const Eigen::VectorXd>(runs.data(), static_cast<Eigen::Index>(runs.size()));
  const double usual = median(lengths);
  const auto regular = ((lengths.array() - usual).abs() <= 1.0).count();
  if (usual >= 2.0 && regular * 10 > lengths.size() * 9) {
    axis.warnings.push_back(
        csv.name() + ": " + axis.target + " has a new value only every " + rounded(usual) +
        " samples, so it is late by half of that on average; log the sensor's own rate to see smaller delays");
  }
}

auto varies(const Eigen::VectorXd& values) -> bool {
  return values.maxCoeff() > values.minCoeff();
}

/// The other axis and the temperature, which terms of the law may read.
void read_surroundings(const CsvLog& csv, const AxisRequest& request, AxisLog& result) {
  constexpr const char* kTemperature = "temperature_C";
  if (csv.has(kTemperature) && varies(csv.column(kTemperature))) {
    result.temperature_c = csv.column(kTemperature);
  }
  for (int other = 0; other < kMostAxes && !result.other; ++other) {
    const std::string q1 = axis_column(other, "q1_rad");
    const bool wanted = request.other_axis ? other == *request.other_axis : csv.has(q1) && varies(csv.column(q1));
    if (other != request.axis && wanted) {
      const std::string tau = axis_column(other, "tau_Nm");
      result.other =
          OtherAxis{other, csv.column(q1),
                    csv.has(tau) ? csv.column(tau) : Eigen::VectorXd(Eigen::VectorXd::Zero(result.samples()))};
    }
  }
}

/// Every signal beside the axis: a possible cause of what the law misses.
void read_side_signals(const CsvLog& csv, int axis, AxisLog& result) {
  std::vector<std::string> names = {"temperature_C"};
  for (int other = 0; other < kMostAxes; ++other) {
    if (other != axis) {
      names.push_back(axis_column(other, "q1_rad"));
      names.push_back(axis_column(other, "tau_Nm"));
    }
  }
  for (const auto& name : names) {
    if (!csv.has(name)) {
      continue;
    }
    SideSignal signal{name, csv.column(name)};
    if (varies(signal.values)) {
      result.side.push_back(std::move(signal));
    }
  }
}

/// A linear axis may have its own names for motion and effort.
auto rotary_or_linear(const CsvLog& csv, int axis, const char* rotary, const char* linear) -> std::string {
  const std::string name = axis_column(axis, rotary);
  return !csv.has(name) && csv.has(axis_column(axis, linear)) ? axis_column(axis, linear) : name;
}

void read_angle(const CsvLog& csv, const AxisRequest& request, AxisLog& axis) {
  const std::string tau = axis_column(request.axis, "tau_Nm");
  axis.has_torque = request.needs_torque || csv.has(tau);
  axis.tau_nm = axis.has_torque ? csv.column(tau) : Eigen::VectorXd::Zero(axis.samples());
  const std::string target = request.target.empty() ? axis_column(request.axis, "q2_rad") : request.target;
  if (request.needs_target || csv.has(target)) {
    axis.target = target;
    axis.q2_rad = csv.column(target);
    if (request.needs_target) {
      check_motion(csv, axis, target, axis.q2_rad);
      check_held(csv, axis);
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

auto read_axis(const CsvLog& csv, const AxisRequest& request) -> AxisLog {
  AxisLog axis;
  axis.name = csv.name();
  axis.warnings = csv.warnings();
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
  return axis;
}

}  // namespace capstan::tools
