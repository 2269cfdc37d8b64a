// SPDX-License-Identifier: Apache-2.0
// A motor without a joint, whose inertia is known; on simulated joints: tests/tools/campaign/commissioning_test.cpp.
#include "capstan/firmware/safety/motor_commissioning.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <string>

namespace capstan {
namespace {

constexpr double kInertiaKgm2 = 2e-5;
constexpr double kTorquePerA = 0.1;
constexpr std::int32_t kCountsPerTurn = 40960;
constexpr double kRadPerCount = 2.0 * std::numbers::pi / kCountsPerTurn;

auto motor_config() -> MotorConfig {
  MotorConfig config;
  config.torque_per_current_nm_per_a = Q24::from_double(kTorquePerA);
  config.encoder_counts_per_turn = kCountsPerTurn;
  return config;
}

/// What a commissioning is fed with, cycle by cycle.
struct Rig {
  explicit Rig(Q24 stiffness = Q24{}) { commissioning.begin(motor_config(), stiffness); }
  void add(std::int64_t counts, double wanted_a, double measured_a) {
    commissioning.add(tick++, Q24::from_double(static_cast<double>(counts) * kRadPerCount), Q24::from_double(wanted_a),
                      Q24::from_double(measured_a));
  }
  /// The dither's two tones on a motor that begins at a rate, which they make 0.7 rad/s more in the mean.
  /// @param lost  every so many cycles one is lost; 0: none
  auto shake(int cycles, int encoder_sign = 1, int lost = 0, double rate_rad_s = 1.0) -> const char* {
    commissioning.begin_dither();
    double angle = 0.0;
    double rate = rate_rad_s;
    for (int i = 0; i < cycles; ++i) {
      const double phase = 2.0 * std::numbers::pi * i / 12.0;
      const double current = 0.05 * (std::sin(phase) + std::sin(2.0 * phase));
      const auto counts = static_cast<std::int64_t>(std::floor(encoder_sign * angle / kRadPerCount));
      if (lost != 0 && i % lost == lost - 1) {
        ++tick;
      } else {
        add(counts, current, current);
      }
      const double acceleration = kTorquePerA / kInertiaKgm2 * current;
      angle += 1e-3 * rate + 0.5e-6 * acceleration;
      rate += 1e-3 * acceleration;
    }
    return commissioning.begin_fast_moves();
  }
  /// It stands, and its sensor shows `off_a` more than was wanted.
  void stand(int cycles, double off_a) {
    for (int i = 0; i < cycles; ++i) {
      add(0, 0.0, off_a);
    }
  }
  [[nodiscard]] auto inertia_kgm2() const -> double {
    return 1e-3 * commissioning.result().values.inertia_gm2.to_double();
  }
  MotorCommissioning commissioning;
  std::uint32_t tick = 0;
};

auto says(const char* problem, const char* part) -> bool {
  return problem != nullptr && std::string(problem).find(part) != std::string::npos;
}

TEST(MotorCommissioning, FindsTheInertiaOfAMotorThatIsShaken) {
  Rig rig;
  ASSERT_EQ(rig.shake(1200), nullptr);
  EXPECT_NEAR(rig.inertia_kgm2(), kInertiaKgm2, 0.02 * kInertiaKgm2);
  EXPECT_LT(rig.commissioning.result().inertia_error, 0.05F);
}

TEST(MotorCommissioning, ALostCycleCostsABlockAndNothingElse) {
  Rig rig;
  ASSERT_EQ(rig.shake(4000, 1, 40), nullptr);
  EXPECT_NEAR(rig.inertia_kgm2(), kInertiaKgm2, 0.02 * kInertiaKgm2);
  Rig all_broken;
  EXPECT_TRUE(says(all_broken.shake(4000, 1, 12), "did not go one way")) << "not one block is whole";
}

TEST(MotorCommissioning, AMotorThatTurnsBackWhileItIsShakenShowsNoInertia) {
  Rig rig;
  EXPECT_TRUE(says(rig.shake(1200, 1, 0, -0.7), "did not go one way"));
}

TEST(MotorCommissioning, AMotorThatRunsBackwardWhileItIsShakenShowsTheSameInertia) {
  Rig rig;
  ASSERT_EQ(rig.shake(1200, 1, 0, -3.0), nullptr);
  EXPECT_NEAR(rig.inertia_kgm2(), kInertiaKgm2, 0.02 * kInertiaKgm2);
}

TEST(MotorCommissioning, AMotorThatStandsWhileItIsShakenShowsNoInertia) {
  Rig rig;
  rig.commissioning.begin_dither();
  rig.stand(1200, 0.0);
  EXPECT_TRUE(says(rig.commissioning.begin_fast_moves(), "did not go one way"));
}

TEST(MotorCommissioning, AnEncoderThatCountsAgainstTheTorqueIsNamed) {
  Rig rig;
  EXPECT_TRUE(says(rig.shake(1200, -1), "counts against the torque"));
}

// A square wave of the lower tone has nothing of the higher one, to the last bit.
TEST(MotorCommissioning, AnEncoderTooCoarseToShowTheHigherToneIsRefused) {
  Rig rig;
  rig.commissioning.begin_dither();
  std::int64_t counts = 0;
  for (int i = 0; i < 1200; ++i) {
    const double phase = 2.0 * std::numbers::pi * i / 12.0;
    rig.add(counts, 0.0, 0.05 * (std::cos(phase) + std::cos(2.0 * phase)));
    counts += i % 12 < 6 ? 5 : 4;
  }
  EXPECT_TRUE(says(rig.commissioning.begin_fast_moves(), "does not show the motor's answer well enough"));
}

TEST(MotorCommissioning, TheNoiseIsTheMeasuredCurrentsWhileTheMotorStands) {
  Rig rig;
  rig.stand(200, 0.02);
  const MotorCommissioning::Result noisy = rig.commissioning.result();
  EXPECT_EQ(noisy.problem, nullptr);
  EXPECT_NEAR(noisy.values.noise_a.to_double(), 0.02, 1e-4);
  Rig silent;
  silent.stand(200, 0.0);
  EXPECT_GT(silent.commissioning.result().values.noise_a, Q24{}) << "none would mean that it is not commissioned";
  Rig moving;
  for (int i = 0; i < 200; ++i) {
    moving.add(i, 0.0, 0.02);
  }
  EXPECT_TRUE(says(moving.commissioning.result().problem, "never stood still"));
}

TEST(MotorCommissioning, TheGainErrorIsTwiceWhatAMovingMotorsCurrentStraysByAndALittle) {
  const auto found = [](double gain, int lag) {
    Rig rig;
    rig.stand(200, 0.002);
    std::array<double, 8> wanted{};
    for (std::size_t i = 0; i < 4000; ++i) {
      wanted[i % 8] = std::sin(2.0 * std::numbers::pi * static_cast<double>(i) / 100.0);
      const double noise = i % 2 == 0 ? 0.002 : -0.002;
      rig.add(static_cast<std::int64_t>(i), wanted[i % 8],
              gain * wanted[(i + 8 - static_cast<std::size_t>(lag)) % 8] + noise);
    }
    return rig.commissioning.result().values.gain_error.to_double();
  };
  constexpr double kLeast = 1.0 / 64.0;
  EXPECT_NEAR(found(1.0, 0), kLeast, 0.004);
  EXPECT_NEAR(found(1.0, 1), kLeast, 0.004) << "it follows within a cycle";
  EXPECT_GT(found(1.1, 0), kLeast + 0.1);
  EXPECT_LT(found(1.1, 0), kLeast + 0.2);
  EXPECT_GT(found(0.9, 0), kLeast + 0.1);
  EXPECT_GT(found(1.0, 3), kLeast + 0.1) << "two cycles later than that";
  EXPECT_EQ(found(3.0, 0), 0.5) << "never all of it";
}

TEST(MotorCommissioning, WithoutTheServosStiffnessNoneIsFound) {
  for (const bool known : {true, false}) {
    Rig rig(known ? Q24::from_double(1.0) : Q24{});
    for (int i = 0; i < 400; ++i) {
      rig.add(i < 200 ? i : 400 - i, i < 200 ? 0.1 : -0.1, 0.0);
    }
    const ObserverConfig values = rig.commissioning.result().values;
    EXPECT_EQ(values.stiffness_nm_per_rad > Q24{}, known);
    EXPECT_EQ(values.excess_nm > Q24{}, known);
  }
}

}  // namespace
}  // namespace capstan
