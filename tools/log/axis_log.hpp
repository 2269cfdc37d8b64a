// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <optional>
#include <string>
#include <vector>

#include "capstan/tools/log/csv_log.hpp"

namespace capstan::tools {

/// Another signal of the same log that may act on this axis.
struct SideSignal {
  std::string name;
  Eigen::VectorXd values;
};

/// The axis that may pull at this one.
struct OtherAxis {
  int number = 0;
  Eigen::VectorXd q1_rad;
  Eigen::VectorXd tau_nm;  ///< zero if not logged
};

/// One axis of one log, evenly sampled for all that follows.
struct AxisLog {
  std::string name;         ///< file
  std::string target = {};  ///< column that q2 was read from; empty if there is none
  double period_s = 0.0;    ///< median
  Eigen::VectorXd time_s, q1_rad;
  Eigen::VectorXd tau_nm;  ///< motor torque as an input of the law; zero if not logged, or if it is the target
  Eigen::VectorXd q2_rad;  ///< empty if not logged
  Eigen::VectorXd effort;  ///< torque or force that a law is to explain; empty where the target is the joint angle
  bool linear = false;     ///< metres and newtons instead of radians and newton metres
  bool has_torque = false;
  std::vector<OtherAxis> others = {};  ///< those asked for, then those that move: the first fill the slots
  Eigen::VectorXd temperature_c;       ///< empty if not logged or constant
  std::vector<SideSignal> side;        ///< motion of other axes and temperature, where logged, moving or not
  std::vector<std::string> warnings;
  std::size_t others_asked = 0;  ///< the first of `others`
  int number = 0;                ///< of the axis in its log

  [[nodiscard]] auto samples() const -> Eigen::Index { return time_s.size(); }
  /// The motion is what an effort is explained by; else motor torque is an input too.
  [[nodiscard]] auto motion_alone() const -> bool { return effort.size() > 0 && !has_torque; }
  /// The target: effort or joint angle.
  [[nodiscard]] auto measured() const -> const Eigen::VectorXd& { return effort.size() > 0 ? effort : q2_rad; }
  [[nodiscard]] auto rate_hz() const -> double { return 1.0 / period_s; }
};

/// Calls visit(signal) for every signal of a log; those that were not logged are empty.
template <typename Visit>
void for_each_signal(AxisLog& log, Visit&& visit) {
  for (Eigen::VectorXd* signal :
       {&log.time_s, &log.q1_rad, &log.tau_nm, &log.q2_rad, &log.effort, &log.temperature_c}) {
    visit(*signal);
  }
  for (auto& other : log.others) {
    visit(other.q1_rad);
    visit(other.tau_nm);
  }
  for (auto& side : log.side) {
    visit(side.values);
  }
}

/// Rows of all logs.
auto total_samples(const std::vector<AxisLog>& logs) -> Eigen::Index;
/// The rows of a log up to some row, or from one on.
auto first_rows(AxisLog log, Eigen::Index rows) -> AxisLog;
auto rows_from(AxisLog log, Eigen::Index first) -> AxisLog;
/// These rows of a log, as they come. Its period stays.
auto only_rows(AxisLog log, const std::vector<Eigen::Index>& rows) -> AxisLog;

/// Axes of a log that are looked for: axis0 to axis15.
inline constexpr int kMostAxes = 16;

struct AxisRequest {
  int axis = 0;
  std::string target = {};  ///< column with the measured joint angle; empty: axis<N>/q2_rad
  bool needs_target = true;
  bool needs_torque = false;
  bool effort = false;     ///< the target is an effort (empty: axis<N>/tau_Nm, or tau_N of a linear axis), no input
  bool force = false;      ///< the target is the joint's torque (empty: axis<N>/tau_out_Nm), the motor's an input
  bool every_row = false;  ///< wild values are named, and stay: who replays a log has to see it
  std::vector<int> other_axes = {};  ///< axes that may pull at this one, by slots; those that move come behind them
  /// Axes that move in any of the logs that are taken together, so that a slot means one axis in all; nothing: those
  /// that move in this one.
  std::optional<std::vector<int>> moving_axes = {};
};

/// Axes beside this one whose motor moves in the log, in their order.
auto moving_axes(const CsvLog& log, int axis) -> std::vector<int>;

/// The log with the rows that the axis's channels have in common, where they have different rates; else as it is.
auto common_rows_of(const CsvLog& log, const AxisRequest& request, std::vector<std::string>& notes) -> CsvLog;

/// Picks an axis out of a log. Throws BadInput with file, line and cure if a column is missing or bad, or nothing
/// moves.
auto read_axis(const CsvLog& log, const AxisRequest& request) -> AxisLog;

/// Whether a column's name says that it is a torque or a force.
auto is_effort_column(const std::string& name) -> bool;

/// Column name by the contract: "axis0/q1_rad".
auto axis_column(int axis, const std::string& quantity) -> std::string;
/// Its axis; 0 of a column that names none.
auto axis_of_column(const std::string& column) -> int;

}  // namespace capstan::tools
