// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/campaign/commissioned.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "capstan/boards/common/file_banks.hpp"
#include "capstan/firmware/console/shell.hpp"
#include "capstan/firmware/loop/application.hpp"
#include "capstan/hal/sim/sim_io.hpp"
#include "capstan/tools/campaign/rig.hpp"

namespace capstan::tools {
namespace {

TEST(Commissioning, FindsTheInertiaThatThePlantHasToAFifth) {
  for (const Joint joint : kJoints) {
    const JointSetup& setup = setup_of(joint);
    const double share = setup.config.observer.inertia_gm2.to_double() / (1000.0 * setup.plant.motor_inertia_kgm2);
    EXPECT_GT(share, 0.8) << name(joint);
    EXPECT_LT(share, 1.2) << name(joint);
  }
}

TEST(Commissioning, FindsTheCurrentsNoiseWithItsOffsetToAFifth) {
  for (const Joint joint : kJoints) {
    const JointSetup& setup = setup_of(joint);
    const double truth = std::hypot(setup.plant.current_noise_a, setup.plant.current_offset_a);
    EXPECT_NEAR(setup.config.observer.noise_a.to_double() / truth, 1.0, 0.2) << name(joint);
  }
}

// A simulated amplifier does what was wanted within a cycle.
TEST(Commissioning, AllowsASimulatedAmplifierLittleMoreThanTheLeast) {
  for (const Joint joint : kJoints) {
    const double gain_error = setup_of(joint).config.observer.gain_error.to_double();
    EXPECT_GE(gain_error, 1.0 / 64.0 - 1e-6) << name(joint);
    EXPECT_LT(gain_error, 1.0 / 40.0) << name(joint);
  }
}

// While the motor turns round its tendons stretch without the joint, by r1^2 E A / L of each at most; friction along
// them holds the far parts back, so the first counts feel more.
TEST(Commissioning, FindsAStiffnessOfTheTendonsSize) {
  for (const Joint joint : {Joint::kForceps, Joint::kContact, Joint::kFinger}) {
    const JointSetup& setup = setup_of(joint);
    const sim::PlantParameters& plant = setup.plant;
    const double of_tendons =
        (plant.stiffness_top_n_per_m + plant.stiffness_bottom_n_per_m) * plant.input_radius_m * plant.input_radius_m;
    EXPECT_GT(setup.config.observer.stiffness_nm_per_rad.to_double(), 0.5 * of_tendons) << name(joint);
    EXPECT_LT(setup.config.observer.stiffness_nm_per_rad.to_double(), 4.0 * of_tendons) << name(joint);
    EXPECT_GT(setup.config.observer.excess_nm.to_double(), setup.plant.motor_coulomb_nm) << name(joint);
  }
}

TEST(Commissioning, FindsAnotherInertiaAndNoiseOfTheSameJoint) {
  sim::PlantParameters plant;
  plant.motor_inertia_kgm2 *= 2.0;
  plant.current_noise_a *= 3.0;
  const ObserverConfig found = commissioned(plant, {}, 5);
  EXPECT_NEAR(found.inertia_gm2.to_double(), 0.04, 0.008);
  EXPECT_NEAR(found.noise_a.to_double(), std::hypot(0.009, 0.002), 0.002);
}

// Drawn forceps 689 of tools/plant_benchmark: half of the usual inertia and a quarter of the usual friction. Where the
// rate of the torque took its servo's damping away it swung until the encoder was faster than a motor can be.
TEST(Commissioning, AForcepsOfLittleInertiaAndFrictionIsNotSetSwinging) {
  sim::PlantParameters plant;
  plant.eta_top = 0.262863;
  plant.eta_bottom = 0.34877;
  plant.stiffness_top_n_per_m = 28830.5;
  plant.stiffness_bottom_n_per_m = 26728.1;
  plant.pretension_n = 17.8936;
  plant.input_radius_m = 0.00210318;
  plant.output_radius_m = 0.00253728;
  plant.motor_inertia_kgm2 = 1.04976e-05;
  plant.motor_coulomb_nm = 0.00316599;
  plant.joint_coulomb_nm = 0.00211137;
  const ObserverConfig found = commissioned(plant, {}, 690);
  EXPECT_NEAR(found.inertia_gm2.to_double(), 0.0105, 0.0035);
}

// By ten counts and more, which the elbow's coarse encoder does not show.
TEST(Commissioning, FindsHowFarALookMovesAMotorAtRest) {
  for (const Joint joint : {Joint::kForceps, Joint::kStiff, Joint::kContact, Joint::kFinger}) {
    EXPECT_GT(setup_of(joint).config.observer.answer_rad_per_a, Q24{}) << name(joint);
  }
  EXPECT_EQ(setup_of(Joint::kElbow).config.observer.answer_rad_per_a, Q24{});
}

struct Words final : TextSink {
  std::string text;

 private:
  void do_write(std::string_view more) override { text.append(more); }
};
struct SilentBoard final : Board {
  [[nodiscard]] auto name() const -> const char* override { return "test"; }
  void print_timing(Print& /*out*/) const override {}
  void reboot() override {}
};

TEST(Commissioning, AFaultWhileTheObserverLooksEndsItAndNothingIsChanged) {
  sim::Plant plant({}, 5);
  SimIo io(plant);
  FileBanks banks = FileBanks::temporary();
  Application<SimIo> application(io, banks);
  AxisConfig config = setup_of(Joint::kForceps).config;
  config.limits.supply_min_v = Q24{};
  config.observer.answer_rad_per_a = Q24{};
  static_cast<void>(application.configure({&config, 1}, Rights::kMaintenance));
  Words words;
  SilentBoard board;
  Shell shell(application, words, board, false);
  const auto ticks = [&](int count) {
    for (int i = 0; i < count; ++i) {
      application.rt_tick();
      shell.poll();
    }
  };
  for (const std::string line : {"maintenance open\n", "arm\n", "commission joint0 looks\n"}) {
    for (const char c : line) {
      shell.receive(c);
    }
    ticks(300);
  }
  for (int i = 0; i < 1000 && application.telemetry().state != State::kHolding; ++i) {
    ticks(1);
  }
  ASSERT_TRUE(shell.busy()) << words.text;
  application.set_board_faults(bit(Fault::kBoardClock));
  ticks(20);
  EXPECT_FALSE(shell.busy());
  EXPECT_NE(words.text.find("error aborted: the torque was lost"), std::string::npos) << words.text;
  EXPECT_EQ(application.config()[0].observer.answer_rad_per_a, Q24{});
}

TEST(Commissioning, AnEncoderThatCountsAgainstTheTorqueIsNotCommissioned) {
  AxisConfig config;
  config.motor.encoder_sign = -1;
  EXPECT_THROW(static_cast<void>(commissioned({}, config, 5)), std::runtime_error);
}

}  // namespace
}  // namespace capstan::tools
