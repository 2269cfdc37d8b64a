// SPDX-License-Identifier: Apache-2.0
#include "capstan/model/wrist_kinematics.hpp"

#include <gtest/gtest.h>

#include <random>

namespace capstan {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr JawLinks<double> kWrist = {0.009, 0.01, 0.002};

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

/// Where the turns of pitch and jaw take what lay along the shaft (the link), across it in its plane (the jaws' axis),
/// and the jaw: pitch about z1 = (0, 0, 1), the jaw about the axis that pitch has turned.
struct Chain {
  Chain(double pitch, double jaw)
      : link(turned({1.0, 0.0, 0.0}, {0.0, 0.0, 1.0}, pitch)),
        jaw_axis(turned({0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}, pitch)),
        finger(turned(link, jaw_axis, jaw)),
        across(turned(turned({0.0, 0.0, -1.0}, {0.0, 0.0, 1.0}, pitch), jaw_axis, jaw)) {}
  /// The jaw's frame as a camera measures it: its axes are the columns.
  [[nodiscard]] auto rotation() const -> Rotation {
    Rotation r{};
    for (std::size_t i = 0; i < 3; ++i) {
      r[i] = {finger[i], across[i], jaw_axis[i]};
    }
    return r;
  }
  Vector3 link, jaw_axis, finger, across;
};

TEST(JawTip, IsTheChainOfItsTwoTurns) {
  for (double pitch = -1.2; pitch < 1.3; pitch += 0.3) {
    for (double jaw = -1.2; jaw < 1.3; jaw += 0.3) {
      const Chain chain(pitch, jaw);
      const Vector3 tip_m = jaw_tip(kWrist, pitch, jaw);
      for (std::size_t i = 0; i < 3; ++i) {
        const double expected_m = kWrist.pitch_to_jaw_m * chain.link[i] + kWrist.offset_m * chain.jaw_axis[i] +
                                  kWrist.jaw_m * chain.finger[i];
        EXPECT_NEAR(tip_m[i], expected_m, 1e-12);
      }
    }
  }
}

TEST(JawTip, IsWithinThreeTenthsOfAMicrometreInFixedPoint) {
  constexpr JawLinks<Q24> kFixed = {Q24::from_double(0.009), Q24::from_double(0.01), Q24::from_double(0.002)};
  std::mt19937 engine(72);
  std::uniform_real_distribution<double> angle(-20.0, 20.0);
  for (int i = 0; i < 20'000; ++i) {
    const Q24 pitch = Q24::from_double(angle(engine));
    const Q24 jaw = Q24::from_double(angle(engine));
    const auto fixed_m = jaw_tip(kFixed, pitch, jaw);
    const Vector3 tip_m = jaw_tip(kWrist, pitch.to_double(), jaw.to_double());
    for (std::size_t k = 0; k < 3; ++k) {
      ASSERT_NEAR(fixed_m[k].to_double(), tip_m[k], 3e-7) << pitch.to_double() << ", " << jaw.to_double();
    }
  }
}

TEST(AnglesOf, GivesTheAnglesOfAnExactRotationBack) {
  for (double pitch = -3.1; pitch < 3.1; pitch += 0.31) {
    for (double jaw = -3.1; jaw < 3.1; jaw += 0.31) {
      const WristAngles angles = angles_of(Chain(pitch, jaw).rotation());
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
    Rotation r = Chain(pitch, jaw).rotation();
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

}  // namespace
}  // namespace capstan
