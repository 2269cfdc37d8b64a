// SPDX-License-Identifier: Apache-2.0
// The law of n axes, (6.8), as the firmware runs it: a row of B and A to each joint's law.
#include <gtest/gtest.h>

#include <random>

#include "capstan/model/coupled_axes.hpp"
#include "capstan/tests/firmware/loop/cycle_rig.hpp"

namespace capstan {
namespace {

constexpr std::size_t kAxes = 4;
using Vector = std::array<double, kAxes>;
using Matrices = CouplingMatrices<double, kAxes>;

auto any_matrices(std::mt19937& engine) -> Matrices {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  Matrices m;
  for (std::size_t i = 0; i < kAxes; ++i) {
    for (std::size_t j = 0; j < kAxes; ++j) {
      m.rigid[i][j] = (i == j ? 1.4 : 0.0) + 0.3 * unit(engine);
      m.elongation_top[i][j] = (i == j ? -1.5 : 0.0) + 0.5 * unit(engine);
      m.elongation_bottom[i][j] = (i == j ? -1.5 : 0.0) + 0.5 * unit(engine);
    }
    m.offset[i] = 0.1 * unit(engine);
  }
  return m;
}

/// Theta = B Q + A S tau with S written out, 2n x n.
auto by_switching_matrix(const Matrices& m, const Vector& q, const Vector& tau, const std::array<bool, kAxes>& forward)
    -> Vector {
  std::array<Vector, 2 * kAxes> s{};
  for (std::size_t j = 0; j < kAxes; ++j) {
    s[2 * j][j] = forward[j] ? 1.0 : 0.0;
    s[2 * j + 1][j] = forward[j] ? 0.0 : 1.0;
  }
  Vector theta = m.offset;
  for (std::size_t i = 0; i < kAxes; ++i) {
    for (std::size_t j = 0; j < kAxes; ++j) {
      theta[i] += m.rigid[i][j] * q[j];
      for (std::size_t k = 0; k < kAxes; ++k) {
        theta[i] += (m.elongation_top[i][k] * s[2 * k][j] + m.elongation_bottom[i][k] * s[2 * k + 1][j]) * tau[j];
      }
    }
  }
  return theta;
}

void set(AxisConfig& config, std::string_view name, double value) {
  const ParameterInfo* parameter = find_parameter(name);
  ASSERT_NE(parameter, nullptr) << name;
  set_raw_value(config, *parameter, Q24::from_double(value).raw());
}

/// Row i of the matrices as parameters of joint i.
void take_row(const Matrices& m, std::size_t i, AxisConfig& config) {
  constexpr std::array kTerms = {"axis_coupling", "axis_coupling_2", "axis_coupling_3"};
  set(config, "motor_angle.beta", m.rigid[i][i]);
  set(config, "joint_offset.offset", m.offset[i]);
  set(config, "tendon_elongation.top", m.elongation_top[i][i]);
  set(config, "tendon_elongation.bottom", m.elongation_bottom[i][i]);
  for (std::size_t slot = 0; slot < kTerms.size(); ++slot) {
    const std::size_t j = (i + 1 + slot) % kAxes;
    config.coupled_to[slot] = static_cast<std::int32_t>(j);
    const std::string term = kTerms[slot];
    set(config, term + ".angle", m.rigid[i][j]);
    set(config, term + ".top", m.elongation_top[i][j]);
    set(config, term + ".bottom", m.elongation_bottom[i][j]);
  }
}

TEST(CoupledAxes, FourJointsThatAllPullAtEachOtherAreEquation68) {
  std::mt19937 engine(61);
  std::uniform_real_distribution<double> current(-0.5, 0.5);
  for (int round = 0; round < 20; ++round) {
    const Matrices m = any_matrices(engine);
    Config<kAxes> config;
    std::array<bool, kAxes> forward{};
    for (std::size_t i = 0; i < kAxes; ++i) {
      take_row(m, i, config[i]);
      forward[i] = (round >> i) % 2 == 0;
    }
    test::CycleRig<kAxes> rig(config);
    std::array<double, kAxes> current_a{};
    rig.disturb = [&current_a](Sensed<kAxes>& sensed) {
      for (std::size_t i = 0; i < kAxes; ++i) {
        sensed.axis[i].current_a = Q24::from_double(current_a[i]);
      }
    };
    for (int step = 0; step < 40; ++step) {
      for (std::size_t i = 0; i < kAxes; ++i) {
        rig.io.motors[i].angle_rad += (forward[i] ? 0.01 : -0.01) * static_cast<double>(i + 1);
        current_a[i] = current(engine);
      }
      rig.tick();
    }
    Vector q{};
    Vector tau{};
    for (std::size_t i = 0; i < kAxes; ++i) {
      q[i] = rig.joint(i).q1_rad.to_double();
      tau[i] = rig.joint(i).tau_nm.to_double();
      ASSERT_TRUE(rig.joint(i).estimate_valid);
    }
    const Vector theta = by_switching_matrix(m, q, tau, forward);
    for (std::size_t i = 0; i < kAxes; ++i) {
      EXPECT_NEAR(rig.joint(i).q2_rad.to_double(), theta[i], 2e-6) << "round " << round << ", joint " << i;
    }
  }
}

// Each joint turns its own row round with the others where they are. What is rigid may go both ways; what stretches
// goes one way, as along a wrist: both ways it is a loop through the motors' own torques, and swings.
TEST(CoupledAxes, FeedforwardBringsJointsThatPullAtEachOtherWhereTheyAreWanted) {
  std::mt19937 engine(62);
  Matrices m = any_matrices(engine);
  for (std::size_t i = 0; i < kAxes; ++i) {
    for (std::size_t j = i + 1; j < kAxes; ++j) {
      m.elongation_top[i][j] = m.elongation_bottom[i][j] = 0.0;
    }
  }
  Config<kAxes> config;
  for (std::size_t i = 0; i < kAxes; ++i) {
    take_row(m, i, config[i]);
  }
  test::CycleRig<kAxes> rig(config);
  rig.arm();
  constexpr Vector kWanted = {0.3, -0.2, 0.25, -0.1};
  Command<kAxes> command;
  for (std::size_t i = 0; i < kAxes; ++i) {
    command.axis[i] = {.kind = Request::Kind::kMove,
                       .position_rad = Q24::from_double(kWanted[i]),
                       .speed_rad_s = Q24::from_double(0.5)};
  }
  rig.tick(command);
  rig.ticks(4000);
  ASSERT_EQ(rig.now(), State::kHolding);
  for (std::size_t i = 0; i < kAxes; ++i) {
    EXPECT_NEAR(rig.joint(i).q2_rad.to_double(), kWanted[i], 3e-3) << i;
  }
}

TEST(CoupledAxes, ALawThatCountsOnAJointThatIsNotThereGivesNoTorque) {
  Config<2> config{};
  set(config[0], "axis_coupling.angle", 0.5);
  config[0].coupled_to[0] = 1;
  config[1].motor.fitted = 0;
  test::CycleRig<2> rig(config);
  rig.arm();
  EXPECT_EQ(rig.now(), State::kDisarmed);
  EXPECT_TRUE(rig.has(Fault::kModelInvalid));
  EXPECT_NE(rig.joint(0).faults & bit(Fault::kModelInvalid), 0U) << "it is this joint's law";
  EXPECT_EQ(rig.joint(1).faults, 0U);
  EXPECT_FALSE(rig.joint(0).estimate_valid);

  config[0].coupled_to[0] = -1;
  test::CycleRig<2> alone(config);
  alone.arm();
  EXPECT_EQ(alone.now(), State::kHolding);
}

}  // namespace
}  // namespace capstan
