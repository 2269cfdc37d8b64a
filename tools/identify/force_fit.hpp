// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "capstan/model/force_law.hpp"
#include "capstan/tools/identify/least_squares.hpp"
#include "capstan/tools/log/axis_log.hpp"

namespace capstan::tools {

inline constexpr Eigen::Index kFewestForceSamples = 200;

/// What a force law is identified from: motor side of one axis, and as effort the joint's torque from a tip force
/// sensor; tip locked or against something stiff. Throws BadInput with file, line and cure as read_axis does, and for
/// too few samples.
auto read_force_log(const CsvLog& log, int axis) -> AxisLog;

/// Rows that become one by their mean, so that no more than `most_rows` are left: 40 ms at most, for beyond, the mean
/// cuts off what a quick motion reaches.
auto averaging_stretch(Eigen::Index rows, Eigen::Index most_rows, double period_s) -> Eigen::Index;
/// A log of the means of so many rows each.
auto averaged_over(AxisLog log, Eigen::Index stretch) -> AxisLog;

/// One number of a force law with its 95 % interval.
struct ForceParameter {
  std::string name, unit;
  double value = 0.0;
  double half_interval = 0.0;
};

/// How far the joint's torque may be from a force law's where its logs have been: `force.error_*` of a board.
struct ForceErrorNumbers {
  static constexpr std::size_t kCount = 4;
  static constexpr std::array<const char*, kCount> kNames = {"error_steady", "error_turning", "error_turn",
                                                             "error_torque"};
  /// In their order, all N m: what 95 of 100 samples kept within; the same of those nearer to a reversal of the motor's
  /// torque than the third; the largest motor torque of the logs.
  std::array<double, kCount> values{};
};

/// A fitted force law with what there is to say about the fit.
struct ForceFit {
  std::vector<ForceParameter> parameters;
  std::vector<std::string> undetermined;  ///< names; what these logs can not determine
  std::vector<std::string> notes;
  std::string cure;      ///< what to record, where something is undetermined
  double rmse_nm = 0.0;  ///< of the law run over every sample as the firmware would run it
  double full_scale_nm = 0.0;
  std::optional<ForceErrorNumbers> error_bar = {};  ///< of the law run as a board runs it
  long samples = 0;
};

struct PullPushFit : ForceFit {
  ForceLawKind kind = ForceLawKind::kPullPush;  ///< or kBlend, whose weights stand behind the other parameters
  PullPushParameters<double> law{};
  double friction_nm = 0.0;  ///< the motor's own, which is in the logged torque: subtract it in the direction of motion
  double offset_nm = 0.0;    ///< of the logged torque
};

/// Friction numbers, pretension and ratio from slow triangles of torque in which each tendon goes slack, tip locked:
/// (2.22), (2.26) and I, as least squares over the branches on which both tendons move or one is slack. Only ratios of
/// torques count, so the radii need not be known; stiffness is r1^2 Kn, pretension I r1.
auto fit_pull_push(const std::vector<AxisLog>& logs) -> PullPushFit;
/// The law's parameters as a board takes them.
auto force_law_of(const PullPushFit& fit) -> ForceLawParameters<double>;
/// The joint's torque by that law as a board runs it, from the first row on.
auto joint_torque_by(const PullPushFit& fit, const Eigen::VectorXd& tau_nm) -> Eigen::VectorXd;
/// The same numbers, then the weights of (2.27) by least squares over every row on which both laws are known. A note
/// says what blend and pull-push law leave of rows that the weights were not fitted to.
auto fit_blend(const std::vector<AxisLog>& logs) -> PullPushFit;

inline constexpr std::size_t kPreisachLevels = 11;  ///< the thesis's grid
inline constexpr std::size_t kFewestPreisachLevels = 5;
inline constexpr std::size_t kMostPreisachLevels = 41;
using PreisachTable = ReversalTable<double, kMostPreisachLevels>;

/// Levels of the torque, increasing.
using Levels = std::vector<double>;
auto even_levels(double low, double high, std::size_t count) -> Levels;

/// What grid a log is fitted on.
struct PreisachGrid {
  std::size_t levels = kPreisachLevels;  ///< kFewestPreisachLevels to kMostPreisachLevels
  /// Levels stand where the law needs them: of kMostPreisachLevels even ones, those go that are missed least on rows
  /// that the table was not fitted to. Where these rows say that even ones are as good, even ones are taken.
  bool adaptive = false;
};

/// How far a force law was from the joint's torque in logs, 95 of 100 times, and what other loops add (kOtherLoops):
/// near a reversal of the motor's torque and beyond, as a board tells it. Nothing where too few samples are left.
auto force_error_bar(const std::vector<AxisLog>& logs, const ForceLawParameters<double>& law,
                     const PreisachTable& table) -> std::optional<ForceErrorNumbers>;

struct PreisachFit : ForceFit {
  PreisachTable table{};
  std::vector<double> half_intervals;  ///< of the table's values, in its order; infinite where undetermined
};

/// Lowest and highest torque of a reversal table and what the joint has there, with the half widths of their intervals.
auto ends_of(const PreisachTable& table, double low_half, double high_half) -> std::vector<ForceParameter>;

/// What joints answer from the lower end on whose relays fill one cell of the grid each: ones, then a column per cell,
/// row by row of the grid below its diagonal. A reversal table is a sum of these.
auto relay_columns(const Levels& levels, const Eigen::VectorXd& tau_nm) -> Eigen::MatrixXd;

/// The reversal table behind logs of any motion: a sum of relays with weights that are not negative, so the table is
/// complete and monotone whatever the noise. A first-order-reversal log determines all of it, another what it visits.
auto fit_preisach(const std::vector<AxisLog>& logs, const PreisachGrid& grid = {}) -> PreisachFit;

}  // namespace capstan::tools
