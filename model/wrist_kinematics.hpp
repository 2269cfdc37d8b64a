// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

namespace capstan {

using Vector3 = std::array<double, 3>;
/// Row by row.
using Rotation = std::array<Vector3, 3>;

/// The da Vinci wrist's geometry and ends of travel (thesis 6.3.1). Host only.
struct WristGeometry {
  double pitch_to_jaw_m;   ///< l1, between the axes of pitch and jaws
  double jaw_m;            ///< l2, jaw axis to tip
  double offset_m;         ///< d, of the tip along the jaw axis
  double pitch_limit_rad;  ///< either way
  double jaw_limit_rad;    ///< either way, of each jaw
};

struct JawPose {
  Rotation rotation;
  Vector3 position_m;
};

/// (6.11), (6.12).
inline auto jaw_pose(const WristGeometry& g, double pitch, double jaw) -> JawPose {
  const double cp = std::cos(pitch);
  const double sp = std::sin(pitch);
  const double cj = std::cos(jaw);
  const double sj = std::sin(jaw);
  return {{{{cp * cj, -cp * sj, -sp}, {sp * cj, -sp * sj, cp}, {-sj, -cj, 0.0}}},
          {g.pitch_to_jaw_m * cp - g.offset_m * sp + g.jaw_m * cp * cj,
           g.pitch_to_jaw_m * sp + g.offset_m * cp + g.jaw_m * sp * cj, -g.jaw_m * sj}};
}

struct WristAngles {
  double pitch;
  double jaw;
};

/// The angles behind a measured rotation: those whose (6.11) is nearest to it, all its entries counted, so that noise
/// of the single entries averages. Exact for an exact rotation. Each angle in closed form with the other held; the sum
/// that they maximise rises every time, and two or three rounds settle it.
inline auto angles_of(const Rotation& r) -> WristAngles {
  constexpr int kRounds = 20;
  double jaw = std::atan2(-r[2][0], -r[2][1]);
  double pitch = std::atan2(-r[0][2], r[1][2]);
  for (int i = 0; i < kRounds; ++i) {
    const double cj = std::cos(jaw);
    const double sj = std::sin(jaw);
    pitch = std::atan2(cj * r[1][0] - sj * r[1][1] - r[0][2], cj * r[0][0] - sj * r[0][1] + r[1][2]);
    const double cp = std::cos(pitch);
    const double sp = std::sin(pitch);
    jaw = std::atan2(-cp * r[0][1] - sp * r[1][1] - r[2][0], cp * r[0][0] + sp * r[1][0] - r[2][1]);
  }
  return {pitch, jaw};
}

/// Pitch and both jaws.
struct WristJoints {
  double pitch, right, left;
};

struct WristAim {
  WristJoints joints;
  double off_rad;  ///< between the wanted direction and the one reached; above 0 where a limit is in the way
  bool at_limit;
  bool singular;  ///< along the pitch axis: every pitch does, so the present one was kept
};

/// Points the middle of the jaws along a direction with an opening between them. Two pairs of angles point the same
/// way, (p, j) and (p + pi, pi - j): the one nearest to the present joints among those within the limits; where neither
/// is, the limits' nearest direction. @param direction  of any length above 0   @param opening_rad  right minus left
inline auto aim_wrist(const WristGeometry& g, const Vector3& direction, double opening_rad, const WristJoints& present)
    -> WristAim {
  constexpr double kPi = 3.14159265358979323846;
  constexpr double kSingular = 1e-6;
  const double length = std::hypot(direction[0], direction[1], direction[2]);
  const double flat = std::hypot(direction[0], direction[1]);
  const double jaw_limit = std::max(0.0, g.jaw_limit_rad - 0.5 * std::fabs(opening_rad));
  WristAim best{{}, 10.0, false, flat < kSingular * length};
  double best_travel = 0.0;
  const double heading = best.singular ? present.pitch : std::atan2(direction[1], direction[0]);
  const double limit = g.pitch_limit_rad;
  for (const double straight : {heading, std::remainder(heading + kPi, 2.0 * kPi), limit, -limit}) {
    const double pitch = std::clamp(straight, -limit, limit);
    // With the pitch given, the jaw that comes nearest.
    const double along = direction[0] * std::cos(pitch) + direction[1] * std::sin(pitch);
    const double wanted = std::atan2(-direction[2], along);
    const double jaw = std::clamp(wanted, -jaw_limit, jaw_limit);
    const double cj = std::cos(jaw);
    const double apart =
        std::hypot(direction[0] / length - std::cos(pitch) * cj, direction[1] / length - std::sin(pitch) * cj,
                   direction[2] / length + std::sin(jaw));
    const double off = 2.0 * std::asin(std::min(1.0, 0.5 * apart));
    const double middle = 0.5 * (present.right + present.left);
    const double travel = std::hypot(pitch - present.pitch, jaw - middle);
    if (off < best.off_rad - 1e-9 || (off < best.off_rad + 1e-9 && travel < best_travel)) {
      best.joints = {pitch, jaw + 0.5 * opening_rad, jaw - 0.5 * opening_rad};
      best.off_rad = off;
      best.at_limit = off > 1e-6;
      best_travel = travel;
    }
  }
  return best;
}

/// RAVEN II's first three axes: shoulder and elbow turn about axes that meet in the remote centre, the insertion goes
/// through it. Angles between the axes by the arm's design, 75 and 52 degrees (B. Hannaford et al., 2013).
struct RavenGeometry {
  double shoulder_to_elbow_rad = 1.3089969389957472;
  double elbow_to_tool_rad = 0.9075712110370514;
  double shoulder_limit_low_rad = 0.0, shoulder_limit_high_rad = 1.5707963267948966;
  double elbow_limit_low_rad = 0.7853981633974483, elbow_limit_high_rad = 2.356194490192345;
  double insertion_low_m = 0.0, insertion_high_m = 0.3;
};

struct RavenJoints {
  double shoulder, elbow, insertion_m;
};

/// Tool tip from the remote centre, the shoulder's axis along z: R_z(shoulder) R_x(a) R_z(elbow) R_x(b) z insertion.
inline auto raven_tip(const RavenGeometry& g, const RavenJoints& q) -> Vector3 {
  const double ca = std::cos(g.shoulder_to_elbow_rad);
  const double sa = std::sin(g.shoulder_to_elbow_rad);
  const double cb = std::cos(g.elbow_to_tool_rad);
  const double sb = std::sin(g.elbow_to_tool_rad);
  const Vector3 tool = {sb * std::sin(q.elbow), -sb * std::cos(q.elbow) * ca - cb * sa,
                        -sb * std::cos(q.elbow) * sa + cb * ca};
  const double c = std::cos(q.shoulder) * q.insertion_m;
  const double s = std::sin(q.shoulder) * q.insertion_m;
  return {c * tool[0] - s * tool[1], s * tool[0] + c * tool[1], q.insertion_m * tool[2]};
}

struct RavenSolution {
  RavenJoints joints;
  bool reachable;  ///< within the arm's cone and its limits; otherwise the joints are the nearest the limits allow
};

/// The joints that bring the tip to a point. The elbow bends either way for the same point: the way within the limits,
/// and of two the nearer to the present.
inline auto raven_joints(const RavenGeometry& g, const Vector3& tip, const RavenJoints& present) -> RavenSolution {
  constexpr double kPi = 3.14159265358979323846;
  const double insertion = std::hypot(tip[0], tip[1], tip[2]);
  const double height = insertion > 0.0 ? tip[2] / insertion : 1.0;
  const double cosine = (std::cos(g.shoulder_to_elbow_rad) * std::cos(g.elbow_to_tool_rad) - height) /
                        (std::sin(g.shoulder_to_elbow_rad) * std::sin(g.elbow_to_tool_rad));
  const bool in_cone = insertion > 0.0 && std::fabs(cosine) <= 1.0 + 1e-12;
  const double bend = std::acos(std::clamp(cosine, -1.0, 1.0));
  RavenSolution best{present, false};
  double best_miss = 1e300;
  double best_travel = 1e300;
  for (const double elbow : {bend, -bend}) {
    const Vector3 at_zero = raven_tip(g, {0.0, elbow, 1.0});
    const bool upright = std::hypot(tip[0], tip[1]) <= 1e-12 * insertion;
    const double raw = upright ? present.shoulder : std::atan2(tip[1], tip[0]) - std::atan2(at_zero[1], at_zero[0]);
    // Of all whole turns the one nearest to the middle of the shoulder's travel.
    const double middle = 0.5 * (g.shoulder_limit_low_rad + g.shoulder_limit_high_rad);
    const double shoulder = middle + std::remainder(raw - middle, 2.0 * kPi);
    const RavenJoints kept = {std::clamp(shoulder, g.shoulder_limit_low_rad, g.shoulder_limit_high_rad),
                              std::clamp(elbow, g.elbow_limit_low_rad, g.elbow_limit_high_rad),
                              std::clamp(insertion, g.insertion_low_m, g.insertion_high_m)};
    const Vector3 there = raven_tip(g, kept);
    const double miss = std::hypot(there[0] - tip[0], there[1] - tip[1], there[2] - tip[2]);
    const double travel = std::hypot(kept.shoulder - present.shoulder, kept.elbow - present.elbow);
    const double tie = 1e-9 * (insertion + g.insertion_high_m);
    if (miss < best_miss - tie || (miss < best_miss + tie && travel < best_travel)) {
      const bool free = kept.shoulder == shoulder && kept.elbow == elbow && kept.insertion_m == insertion;
      best = {kept, in_cone && free};
      best_miss = miss;
      best_travel = travel;
    }
  }
  return best;
}

}  // namespace capstan
