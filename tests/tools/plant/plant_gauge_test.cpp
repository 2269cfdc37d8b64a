// SPDX-License-Identifier: Apache-2.0
// Pretension in newtons, from a plant that shares no formula with the law that tells it. More joints:
// tools/plant_benchmark --gauge.
#include "capstan/tests/tools/plant/plant_gauge.hpp"

#include <gtest/gtest.h>

#include "capstan/tests/tools/plant/plant_health.hpp"
#include "capstan/tests/tools/plant/plant_joint.hpp"
#include "capstan/tools/diagnose/diagnosis.hpp"
#include "capstan/tools/identify/identify.hpp"
#include "capstan/tools/identify/tendon_fit.hpp"

namespace capstan::tools::plant {
namespace {

class PretensionGauge : public testing::TestWithParam<double> {};

TEST_P(PretensionGauge, TellsNewtonsFrictionNumberAndWhatBecameOfThem) {
  constexpr std::uint64_t kSeed = 9020;
  sim::PlantParameters plant = drawn_plant(kSeed);
  plant.pretension_n = GetParam();
  const GaugeAnswer answer = gauge(plant, kSeed, 0.7);
  EXPECT_LT(std::abs(answer.force_n.error()), 0.1);
  EXPECT_LT(std::abs(answer.by_stiffness_n.error()), 0.1);
  EXPECT_LT(std::abs(answer.eta.error()), 0.05);
  EXPECT_LT(answer.force_n.told.half, 0.1 * GetParam());
  ASSERT_TRUE(answer.now_n);
  EXPECT_LT(std::abs(answer.now_n->error()), 0.1);
  EXPECT_TRUE(answer.change_n->held());
  EXPECT_LT(answer.change_n->told.value + answer.change_n->told.half, 0.0) << "it fell for certain";
}
INSTANTIATE_TEST_SUITE_P(Newtons, PretensionGauge, testing::Values(3.0, 10.0, 30.0),
                         [](const auto& one) { return std::to_string(static_cast<int>(one.param)); });

TEST(PretensionGauge, SaysWhichNumberIsLacking) {
  constexpr std::uint64_t kSeed = 9021;
  const sim::PlantParameters plant = drawn_pretension(kSeed);
  const std::vector<AxisLog> both = free_and_held(plant, kSeed);
  const auto identified = [](const std::vector<AxisLog>& logs) {
    return identify(logs, form_of_model(kTendonModel, logs)).joint;
  };
  const JointFile from_free = identified({both.front()});
  const JointFile from_both = identified(both);
  const auto said = [&](const JointFile& of, const TendonDrawing& drawing) {
    JointFile joint = of;
    put_into_newtons(drawing, joint);
    EXPECT_TRUE(joint.fit->pretension);
    EXPECT_EQ(joint.fit->pretension->force_n() > 0.0,
              &of == &from_both && (drawing.radius_m || drawing.stiffness_n_per_m));
    return pretension_sentence(joint.fit->pretension.value_or(PretensionNumbers{}));
  };
  const auto has = [](const std::string& text, const char* word) { return text.find(word) != std::string::npos; };
  const std::string neither = said(from_free, {});
  EXPECT_TRUE(has(neither, "log with the tip held") && has(neither, "--radius")) << neither;
  const std::string no_held = said(from_free, {.radius_m = plant.input_radius_m});
  EXPECT_TRUE(has(no_held, "log with the tip held") && !has(no_held, "--radius")) << no_held;
  const std::string stiff = said(from_free, {.stiffness_n_per_m = plant.stiffness_top_n_per_m});
  EXPECT_TRUE(has(stiff, "log with the tip held") && has(stiff, "--radius")) << stiff;
  const std::string no_radius = said(from_both, {});
  EXPECT_TRUE(has(no_radius, "--radius METRES") && has(no_radius, "--stiffness") && !has(no_radius, "tip held"))
      << no_radius;
  EXPECT_TRUE(has(said(from_both, {.radius_m = plant.input_radius_m}), " N, both tendons"));
}

// A stretch of motion is short: where the tendons' friction is a small part of all, the board's interval is wider than
// that of a log.
TEST(PretensionGauge, IsASignalOfTheBoard) {
  constexpr std::uint64_t kSeed = 9022;
  for (const double pretension_n : {4.0, 25.0}) {
    sim::PlantParameters plant = drawn_plant(kSeed);
    plant.pretension_n = pretension_n;
    const std::vector<AxisLog> both = free_and_held(plant, kSeed);
    JointFile joint = identify(both, form_of_model(kTendonModel, both)).joint;
    put_into_newtons({.radius_m = plant.input_radius_m}, joint);
    const WatchedJoint board(plant, kSeed, joint);
    for (const char* fault : {"", "loose"}) {
      const HealthAnswer answer = board.watch(fault, false, 20.0, 5);
      const double truth = answer.true_tension * plant.pretension_n;
      std::printf("%.2f N: the board says %.2f +-%.2f N\n", truth, answer.pretension_n, answer.pretension_95_n);
      EXPECT_NEAR(answer.pretension_n, truth, answer.pretension_95_n) << fault;
      EXPECT_LT(answer.pretension_95_n, (pretension_n > 20.0 ? 0.1 : 0.25) * truth) << fault;
    }
  }
}

// The torque that a motor's magnets lose is in no tendon: the width stays, and nothing is said of the pretension.
TEST(PretensionGauge, SaysNothingWhereTorqueAloneChanged) {
  constexpr std::uint64_t kSeed = 9020;
  const sim::PlantParameters plant = drawn_pretension(kSeed);
  const std::vector<AxisLog> both = free_and_held(plant, kSeed);
  const JointFile joint = identify(both, form_of_model(kTendonModel, both)).joint;
  const auto drift_of = [&](const sim::PlantParameters& now) {
    DiagnoseOptions options;
    options.base_law = joint;
    return diagnose({log_of(now, PlantMotion::kIdentify, kSeed + 5)}, options).pretension;
  };
  const auto same = drift_of(plant);
  ASSERT_TRUE(same);
  EXPECT_NEAR(same->times.value, 1.0, 0.03);
  sim::PlantParameters rubbing = plant;
  rubbing.motor_coulomb_nm *= 4.0;
  EXPECT_FALSE(drift_of(rubbing));
}

}  // namespace
}  // namespace capstan::tools::plant
