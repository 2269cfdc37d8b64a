// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/tip/poses.hpp"

#include <cmath>

#include <Eigen/Geometry>

#include "capstan/model/wrist_kinematics.hpp"
#include "capstan/tools/log/axis_log.hpp"
#include "capstan/tools/support/errors.hpp"

namespace capstan::tools {
namespace {

using Pose = std::array<Eigen::VectorXd, 4>;  // qw, qx, qy, qz

auto pose_of(const CsvLog& log, const std::string& stem) -> Pose {
  return {log.column(stem + "qw"), log.column(stem + "qx"), log.column(stem + "qy"), log.column(stem + "qz")};
}

auto angles_of_row(const CsvLog& log, const std::string& stem, const Pose& pose, Eigen::Index row) -> WristAngles {
  const Eigen::Quaterniond turned(pose[0][row], pose[1][row], pose[2][row], pose[3][row]);
  if (!(turned.norm() > 0.0)) {
    throw BadInput(place(log.name(), log.line_of(static_cast<std::size_t>(row))) + stem +
                   "qw to qz are all zero, which is no rotation; leave out the rows in which the jaw was not seen");
  }
  const Eigen::Matrix3d m = turned.normalized().toRotationMatrix();
  Rotation r{};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      r[i][j] = m(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
    }
  }
  return angles_of(r);
}

}  // namespace

auto joints_of_poses(const CsvLog& log, const std::array<int, 3>& axes) -> std::map<std::string, Eigen::VectorXd> {
  constexpr std::array kStems = {"tip_right/", "tip_left/"};
  std::map<std::string, Eigen::VectorXd> joints;
  Eigen::VectorXd sine;
  Eigen::VectorXd cosine;
  for (std::size_t jaw = 0; jaw < kStems.size(); ++jaw) {
    const std::string stem = kStems[jaw];
    if (!log.has(stem + "qw")) {
      continue;
    }
    const Pose pose = pose_of(log, stem);
    const Eigen::Index rows = pose[0].size();
    if (sine.size() == 0) {
      sine = cosine = Eigen::VectorXd::Zero(rows);
    }
    Eigen::VectorXd angle(rows);
    for (Eigen::Index row = 0; row < rows; ++row) {
      const WristAngles at = angles_of_row(log, stem, pose, row);
      sine[row] += std::sin(at.pitch);
      cosine[row] += std::cos(at.pitch);
      angle[row] = at.jaw;
    }
    joints[axis_column(axes[jaw + 1], "q2_rad")] = angle;
  }
  if (joints.empty()) {
    return joints;
  }
  joints[axis_column(axes[0], "q2_rad")] = sine.binaryExpr(cosine, [](double y, double x) { return std::atan2(y, x); });
  for (const auto& [name, values] : joints) {
    if (log.has(name)) {
      throw BadInput(place(log.name(), 1) + "the log has " + name +
                     " and the poses of the jaws that it would follow from; leave one of them out");
    }
  }
  return joints;
}

}  // namespace capstan::tools
