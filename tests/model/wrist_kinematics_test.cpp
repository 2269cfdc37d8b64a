// SPDX-License-Identifier: Apache-2.0
#include "capstan/model/wrist_kinematics.hpp"

#include <gtest/gtest.h>

#include <random>

namespace capstan {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr WristGeometry kWrist = {0.009, 0.01, 0.002, 1.3, 1.4};

/// Turns a vector about an axis (Rodrigues), for chains of links put together turn by turn.
auto turned(const Vector3& v, const Vector3& k, double angle) -> Vector3 {
  const double dot = v[0] * k[0] + v[1] * k[1] + v[2] * k[2];
  const Vector3 cross = {k[1] * v[2] - k[2] * v[1], k[2] * v[0] - k[0] * v[2], k[0] * v[1] - k[1] * v[0]};
  Vector3 result{};
  for (std::size_t i = 0; i < 3; ++i) {
    result[i] = v[i] * std::cos(angle) + cross[i] * std::sin(angle) + k[i] * dot * (1.0 - std::cos(angle));
  }
  return result;
}

// Pitch about z1 = (0, 0, 1); the jaw's axis, (-sin p, cos p, 0) after it, is that of z2, and the tip lies l2 from it.
TEST(JawPose, IsTheChainOfItsTwoTurns) {
  for (double pitch = -1.2; pitch < 1.3; pitch += 0.3) {
    for (double jaw = -1.2; jaw < 1.3; jaw += 0.3) {
      const Vector3 z = {0.0, 0.0, 1.0};
      const Vector3 jaw_axis = turned({0.0, 1.0, 0.0}, z, pitch);
      const Vector3 link = turned({1.0, 0.0, 0.0}, z, pitch);
      const Vector3 finger = turned(link, jaw_axis, jaw);
      const JawPose pose = jaw_pose(kWrist, pitch, jaw);
      for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_NEAR(pose.rotation[i][0], finger[i], 1e-12);
        EXPECT_NEAR(pose.rotation[i][2], jaw_axis[i], 1e-12);
        EXPECT_NEAR(pose.position_m[i],
                    kWrist.pitch_to_jaw_m * link[i] + kWrist.offset_m * jaw_axis[i] + kWrist.jaw_m * finger[i], 1e-12);
      }
    }
  }
}

TEST(AnglesOf, GivesTheAnglesOfAnExactRotationBack) {
  for (double pitch = -3.1; pitch < 3.1; pitch += 0.31) {
    for (double jaw = -3.1; jaw < 3.1; jaw += 0.31) {
      const WristAngles angles = angles_of(jaw_pose(kWrist, pitch, jaw).rotation);
      EXPECT_NEAR(std::remainder(angles.pitch - pitch, 2.0 * kPi), 0.0, 1e-9) << pitch << ", " << jaw;
      EXPECT_NEAR(std::remainder(angles.jaw - jaw, 2.0 * kPi), 0.0, 1e-9) << pitch << ", " << jaw;
    }
  }
}

TEST(AnglesOf, AveragesNoiseThatTwoEntriesAloneWouldPassOn) {
  std::mt19937 engine(71);
  std::normal_distribution<double> noise(0.0, 0.02);
  double all = 0.0;
  double two = 0.0;
  for (int i = 0; i < 3000; ++i) {
    const double pitch = 0.6;
    const double jaw = -0.4;
    Rotation r = jaw_pose(kWrist, pitch, jaw).rotation;
    for (auto& row : r) {
      for (double& entry : row) {
        entry += noise(engine);
      }
    }
    const WristAngles angles = angles_of(r);
    all += std::pow(angles.pitch - pitch, 2.0) + std::pow(angles.jaw - jaw, 2.0);
    two += std::pow(std::atan2(-r[0][2], r[1][2]) - pitch, 2.0) + std::pow(std::atan2(-r[2][0], -r[2][1]) - jaw, 2.0);
  }
  EXPECT_LT(all, 0.65 * two);
}

auto direction_of(const WristJoints& joints) -> Vector3 {
  const auto r = jaw_pose(kWrist, joints.pitch, 0.5 * (joints.right + joints.left)).rotation;
  return {r[0][0], r[1][0], r[2][0]};
}
auto angle_between(const Vector3& a, const Vector3& b) -> double {
  const double dot = (a[0] * b[0] + a[1] * b[1] + a[2] * b[2]) / std::hypot(a[0], a[1], a[2]);
  return std::acos(std::clamp(dot, -1.0, 1.0));
}

// Any direction, against all joints tried on a grid.
TEST(AimWrist, ReachesWhatTheLimitsAllowAndOtherwiseTheNearest) {
  std::mt19937 engine(72);
  std::normal_distribution<double> normal;
  int reached = 0;
  int limited = 0;
  for (int round = 0; round < 300; ++round) {
    const Vector3 wanted = {normal(engine), normal(engine), normal(engine)};
    const double opening = 0.4;
    const WristAim aim = aim_wrist(kWrist, wanted, opening, {0.1, 0.2, 0.0});
    EXPECT_LE(std::fabs(aim.joints.pitch), kWrist.pitch_limit_rad);
    EXPECT_LE(std::fabs(aim.joints.right), kWrist.jaw_limit_rad + 1e-12);
    EXPECT_LE(std::fabs(aim.joints.left), kWrist.jaw_limit_rad + 1e-12);
    EXPECT_NEAR(aim.joints.right - aim.joints.left, opening, 1e-12);
    const double off = angle_between(wanted, direction_of(aim.joints));
    EXPECT_NEAR(off, aim.off_rad, 1e-6);
    double least = 10.0;
    for (double pitch = -1.3; pitch <= 1.3001; pitch += 0.02) {
      for (double jaw = -1.2; jaw <= 1.2001; jaw += 0.02) {
        least = std::fmin(least, angle_between(wanted, direction_of({pitch, jaw, jaw})));
      }
    }
    EXPECT_LT(off, least + 1e-6) << round;
    (aim.at_limit ? limited : reached) += 1;
    EXPECT_EQ(aim.at_limit, off > 1e-6);
    EXPECT_TRUE(aim.at_limit || least < 0.02) << "the grid has a direction within 0.02 of any that can be reached";
  }
  EXPECT_GT(reached, 50);
  EXPECT_GT(limited, 50);
}

TEST(AimWrist, TakesTheNearerOfTwoWaysAndKeepsThePitchWhereItDoesNotMatter) {
  const WristGeometry wide = {0.009, 0.01, 0.002, kPi, kPi};
  const Vector3 wanted = {1.0, 0.2, 0.3};
  const WristAim near = aim_wrist(wide, wanted, 0.0, {0.0, 0.0, 0.0});
  const WristAim far = aim_wrist(wide, wanted, 0.0, {-2.9, -2.8, -2.8});
  EXPECT_NEAR(std::fabs(far.joints.pitch - near.joints.pitch), kPi, 1e-9);
  EXPECT_LT(far.off_rad, 1e-7);
  const WristAim along_axis = aim_wrist(kWrist, {0.0, 0.0, -1.0}, 0.0, {0.7, 0.0, 0.0});
  EXPECT_TRUE(along_axis.singular);
  EXPECT_EQ(along_axis.joints.pitch, 0.7);
}

// The arm turn by turn: insertion along z, tilted about x by b, turned by the elbow, tilted by a, turned by the
// shoulder.
TEST(RavenTip, IsTheChainOfItsTurns) {
  const RavenGeometry g;
  for (double shoulder = -1.0; shoulder < 2.0; shoulder += 0.5) {
    for (double elbow = -1.0; elbow < 3.0; elbow += 0.5) {
      Vector3 v = {0.0, 0.0, 0.2};
      v = turned(v, {1.0, 0.0, 0.0}, g.elbow_to_tool_rad);
      v = turned(v, {0.0, 0.0, 1.0}, elbow);
      v = turned(v, {1.0, 0.0, 0.0}, g.shoulder_to_elbow_rad);
      v = turned(v, {0.0, 0.0, 1.0}, shoulder);
      const Vector3 tip = raven_tip(g, {shoulder, elbow, 0.2});
      for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_NEAR(tip[i], v[i], 1e-14);
      }
    }
  }
}

TEST(RavenJoints, BringTheTipBackAndSayWhereTheyCanNot) {
  const RavenGeometry g;
  std::mt19937 engine(73);
  const auto between = [&engine](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine);
  };
  for (int i = 0; i < 2000; ++i) {
    const RavenJoints q = {between(g.shoulder_limit_low_rad, g.shoulder_limit_high_rad),
                           between(g.elbow_limit_low_rad, g.elbow_limit_high_rad), between(0.05, g.insertion_high_m)};
    const auto solution = raven_joints(g, raven_tip(g, q), {0.5, 1.5, 0.1});
    ASSERT_TRUE(solution.reachable);
    ASSERT_NEAR(solution.joints.shoulder, q.shoulder, 1e-7);
    ASSERT_NEAR(solution.joints.elbow, q.elbow, 1e-7);
    ASSERT_NEAR(solution.joints.insertion_m, q.insertion_m, 1e-12);
  }
  EXPECT_FALSE(raven_joints(g, {0.0, 0.0, 0.2}, {}).reachable) << "75 - 52 degrees from the axis is the nearest";
  EXPECT_FALSE(raven_joints(g, {0.0, 0.0, 0.0}, {}).reachable);
  const auto beyond = raven_joints(g, raven_tip(g, {0.4, 1.2, 0.5}), {});
  EXPECT_FALSE(beyond.reachable);
  EXPECT_NEAR(beyond.joints.shoulder, 0.4, 1e-9);
  EXPECT_EQ(beyond.joints.insertion_m, g.insertion_high_m);
}

}  // namespace
}  // namespace capstan
