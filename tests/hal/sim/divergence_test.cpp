// SPDX-License-Identifier: Apache-2.0
// Random instruments inside the allowed ranges under random commands: whatever they do, every number stays a number,
// and one that diverges says so and stops.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "capstan/hal/sim/fields.hpp"
#include "capstan/hal/sim/multi_plant.hpp"

namespace capstan::sim {
namespace {

double uniform(Random& random) {
  return static_cast<double>(random.next() >> 11U) * 0x1.0p-53;
}

// Positive ranges by their logarithm, so that small and large are met equally often; now and then an end of the range.
double within(Random& random, double low, double high) {
  const double share = uniform(random);
  const double choice = uniform(random);
  if (choice < 0.05)
    return low;
  if (choice < 0.1)
    return high;
  if (low < 0.0)
    return low + share * (high - low);
  const double floor = low > 0.0 ? low : high * 1.0e-9;
  return std::min(high, floor * std::pow(high / floor, share));
}

// Ordinary values in three fields of four, so that the rest shows what it does.
PlantParameters random_plant(Random& random) {
  PlantParameters p;
  for (const auto& field : plant_fields()) {
    if (uniform(random) < 0.25)
      p.*field.member = within(random, field.low, field.high);
  }
  if (p.stop_low_rad >= p.stop_high_rad) {  // no plant, and refused as such
    p.stop_low_rad = -3.0;
    p.stop_high_rad = 3.0;
  }
  p.element_count = 2 + static_cast<int>(uniform(random) * 24.0);
  p.substeps = 1 + static_cast<int>(uniform(random) * 6.0);
  p.mode = uniform(random) < 0.3 ? SolverMode::kDynamic : SolverMode::kQuasiStatic;
  p.environment.kind = static_cast<EnvironmentKind>(static_cast<int>(uniform(random) * 6.0));
  for (const auto& field : environment_fields()) {
    if (uniform(random) < 0.5)
      p.environment.*field.member = within(random, field.low, field.high);
  }
  for (const auto& field : effect_fields()) {
    if (uniform(random) < 0.1)
      p.effects.*field.member = within(random, field.low, field.high);
  }
  p.effects.pretension_change_n = std::max(p.effects.pretension_change_n, -p.pretension_n);
  return p;
}

bool all_finite(const Truth& t, const Readings& r) {
  for (const double x : {t.q1_rad, t.q2_rad, t.q1_rate_rad_per_s, t.q2_rate_rad_per_s, t.tau_in_nm, t.tau_out_nm,
                         t.motor_torque_nm, t.current_a, t.q2_camera_rad, t.tip_force_n, t.second_rad, r.current_a}) {
    if (!std::isfinite(x))
      return false;
  }
  return true;
}

struct Outcome {
  int finished = 0;
  int diverged = 0;
};

// Every step is either sane or refused with a sentence, and a refusal is final.
template <class Step, class Sane>
void drive(Random& random, Step&& step, Sane&& sane, Outcome& outcome, std::uint64_t number) {
  std::string sentence;
  for (int i = 0; i < 60; ++i) {
    try {
      step(5.0 * random.normal());
      ASSERT_TRUE(sentence.empty()) << number << ": went on after: " << sentence;
    } catch (const std::runtime_error& refusal) {
      ASSERT_TRUE(sentence.empty() || sentence == refusal.what());
      sentence = refusal.what();
      ASSERT_NE(sentence.find("; "), std::string::npos) << sentence;
    }
    ASSERT_TRUE(sane()) << number << " at " << i;
  }
  ++(sentence.empty() ? outcome.finished : outcome.diverged);
}

TEST(Divergence, ARandomPlantIsSaneOrSaysThatItDiverged) {
  Outcome outcome;
  for (std::uint64_t number = 1; number <= 200; ++number) {
    Random random(number);
    Plant plant(random_plant(random), number);
    drive(
        random, [&](double command) { plant.step(command, random.next() % 8 != 0); },
        [&] { return all_finite(plant.truth(), plant.readings()); }, outcome, number);
    if (HasFatalFailure())
      return;
  }
  RecordProperty("diverged", outcome.diverged);
  // Divergence is the exception, or this would prove nothing.
  EXPECT_GT(outcome.finished, 175);
}

TEST(Divergence, ARandomInstrumentOfCoupledAxesIsSaneOrSaysThatItDiverged) {
  Outcome outcome;
  for (std::uint64_t number = 1; number <= 80; ++number) {
    Random random(1000 + number);
    std::vector<InstrumentAxis> axes;
    for (int i = 0; i < 3; ++i)
      axes.push_back({"a", random_plant(random), {within(random, -0.01, 0.01), within(random, -0.01, 0.01), 0.0}});
    for (std::size_t i = 0; i < axes.size(); ++i) {
      axes[i].plant.substeps = axes[0].plant.substeps;
      axes[i].plant.mode = axes[0].plant.mode;
      axes[i].carried_radius_m[i] = 0.0;
    }
    MultiPlant plant(axes, number);
    drive(
        random,
        [&](double command) {
          plant.step(std::vector<MotorCommand>{{command, true}, {-command, true}, {0.3 * command, command > 0.0}});
        },
        [&] {
          return all_finite(plant.truth(0), plant.readings(0)) && all_finite(plant.truth(1), plant.readings(1)) &&
                 all_finite(plant.truth(2), plant.readings(2));
        },
        outcome, number);
    if (HasFatalFailure())
      return;
  }
  RecordProperty("diverged", outcome.diverged);
  EXPECT_GT(outcome.finished, 60);
}

}  // namespace
}  // namespace capstan::sim
