// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/tip/tip.hpp"

#include <algorithm>
#include <numeric>

#include "capstan/tools/log/axis_log.hpp"
#include "capstan/tools/support/statistics.hpp"
#include "capstan/tools/tip/poses.hpp"

namespace capstan::tools {
namespace {

using Tip = std::array<Eigen::VectorXd, 3>;

auto tip_of(const CsvLog& log, const WristInLog& wrist, std::size_t jaw, const std::string& quantity) -> Tip {
  const Eigen::VectorXd pitch_rad = log.column(axis_column(wrist.axes[0], quantity));
  const Eigen::VectorXd jaw_rad = log.column(axis_column(wrist.axes[jaw], quantity));
  Tip tip;
  tip.fill(Eigen::VectorXd(pitch_rad.size()));
  for (Eigen::Index row = 0; row < pitch_rad.size(); ++row) {
    const Vector3 at = jaw_tip(wrist.links, pitch_rad[row], jaw_rad[row]);
    for (std::size_t i = 0; i < at.size(); ++i) {
      tip[i][row] = at[i];
    }
  }
  return tip;
}

void add(const std::string& stem, const Tip& tip, TipTrack& track) {
  constexpr std::array kAxes = {"x_m", "y_m", "z_m"};
  for (std::size_t i = 0; i < tip.size(); ++i) {
    track.names.push_back(stem + kAxes[i]);
    track.columns.push_back(tip[i]);
  }
}

auto has_all(const CsvLog& log, const WristInLog& wrist, const std::string& quantity) -> bool {
  return std::all_of(wrist.axes.begin(), wrist.axes.end(),
                     [&](int axis) { return log.has(axis_column(axis, quantity)); });
}

/// The log with more columns.
auto with_columns(const CsvLog& log, const std::map<std::string, Eigen::VectorXd>& columns) -> CsvLog {
  std::vector<std::size_t> rows(log.rows());
  std::iota(rows.begin(), rows.end(), std::size_t{0});
  return log.with_rows(rows, columns);
}

}  // namespace

auto tips_of(const CsvLog& file, const WristInLog& wrist) -> TipTrack {
  const auto seen_joints = joints_of_poses(file, wrist.axes);
  const CsvLog log = with_columns(file, seen_joints);
  constexpr std::array kStems = {"tip_right/", "tip_left/"};
  const bool measured = has_all(log, wrist, "q2_rad");
  const bool estimated = has_all(log, wrist, "q2_est_rad") || !measured;
  TipTrack track;
  for (const auto& [name, values] : seen_joints) {
    track.names.push_back(name);
    track.columns.push_back(values);
  }
  for (std::size_t jaw = 0; jaw < kStems.size(); ++jaw) {
    const Tip tip = tip_of(log, wrist, jaw + 1, estimated ? "q2_est_rad" : "q2_rad");
    add(kStems[jaw], tip, track);
    if (measured && estimated) {
      const Tip seen = tip_of(log, wrist, jaw + 1, "q2_rad");
      add(std::string(kStems[jaw]) + "measured_", seen, track);
      const Eigen::VectorXd apart = ((tip[0] - seen[0]).array().square() + (tip[1] - seen[1]).array().square() +
                                     (tip[2] - seen[2]).array().square())
                                        .sqrt();
      track.errors[jaw] = TipError{rms(apart), apart.maxCoeff()};
    }
  }
  return track;
}

}  // namespace capstan::tools
