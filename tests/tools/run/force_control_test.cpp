// SPDX-License-Identifier: Apache-2.0
// Force control in closed loop with the simulated instrument: a force law from a log, put into the firmware, and the
// torque that the plant's tip feels beside the one that was wanted.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "capstan/tests/tools/run/force_rig.hpp"
#include "capstan/tests/tools/run/recipe_log.hpp"
#include "capstan/tools/apply/force_lines.hpp"
#include "capstan/tools/identify/force_section.hpp"

namespace capstan::tools {
namespace {

using test::Lines;
using Rig = test::ForceRig;
constexpr double kPeakNm = 0.05;

auto section_lines(const std::string& section) -> Lines {
  return force_lines(with_force_section("", section), "joint.toml", 0);
}
auto pull_push_law() -> const Lines& {
  static const Lines lines = section_lines(force_section(fit_pull_push({test::record("recipe_pull_push.toml")})));
  return lines;
}
auto blend_law() -> const Lines& {
  static const Lines lines = section_lines(force_section(fit_blend({test::record("recipe_pull_push.toml")})));
  return lines;
}
auto preisach_law() -> const Lines& {
  static const Lines lines = section_lines(force_section(fit_preisach({test::record("recipe_preisach.toml")})));
  return lines;
}

/// Rises, falls, small loops inside large ones, rests: N m at the joint.
auto wanted_at(double t) -> double {
  const double swing = std::sin(2.0 * std::numbers::pi * 0.1 * t);
  const double loops = std::sin(2.0 * std::numbers::pi * 0.37 * t);
  return kPeakNm * std::clamp(0.8 * swing + 0.35 * loops, -1.0, 1.0);
}

/// Root mean square of what the tip feels minus what was wanted, over the peak, after the first swing.
template <typename Ask>
auto error_share(Rig& rig, Ask&& ask) -> double {
  constexpr int kCycles = 60'000;
  constexpr int kFirst = 10'000;
  double squares = 0.0;
  for (int i = 0; i < kCycles; ++i) {
    const double wanted = wanted_at(0.001 * i);
    Application<SimIo>::Streamed streamed{};
    streamed[0] = ask(wanted);
    rig.application.rt_tick(streamed);
    const double error = rig.plant.truth().tau_out_nm - wanted;
    squares += i < kFirst ? 0.0 : error * error;
    EXPECT_TRUE(energised(rig.application.telemetry().state)) << i;
    if (!energised(rig.application.telemetry().state)) {
      break;
    }
  }
  return std::sqrt(squares / (kCycles - kFirst)) / kPeakNm;
}

auto by_law(double wanted_nm) -> Request {
  return {.kind = Request::Kind::kFollowForce,
          .joint_torque_nm = Q24::from_double(wanted_nm),
          .torque_rate_nm_s = Q24::from_int(10)};
}
/// What one does who knows the pulleys only.
auto by_ratio(double wanted_nm) -> Request {
  const sim::PlantParameters plant;
  return {.kind = Request::Kind::kTorque,
          .torque_nm = Q24::from_double(wanted_nm * plant.input_radius_m / plant.output_radius_m)};
}

struct Case {
  const char* name;
  sim::Environment environment;
};
const std::array<Case, 3> kCases = {{
    {"locked tip", {.kind = sim::EnvironmentKind::kLocked}},
    {"stiff tissue, 0.5 N m/rad", {.kind = sim::EnvironmentKind::kSpring, .stiffness = 0.5}},
    {"soft tissue, 0.1 N m/rad", {.kind = sim::EnvironmentKind::kKelvinVoigt, .stiffness = 0.1, .damping = 0.002}},
}};

TEST(ForceControl, FollowsWhatIsWantedManyTimesBetterThanTheMotorsTorqueAlone) {
  for (const Case& c : kCases) {
    Rig plain(c.environment, {});
    const double without = error_share(plain, by_ratio);
    Rig pull_push(c.environment, pull_push_law());
    const double tendons = error_share(pull_push, by_law);
    Rig blended(c.environment, blend_law());
    const double blend = error_share(blended, by_law);
    Rig preisach(c.environment, preisach_law());
    const double grid = error_share(preisach, by_law);
    std::printf("%-26s no law %5.1f %%, pull-push %5.1f %%, blend %5.1f %%, Preisach %5.1f %% of %.2f N m\n", c.name,
                100.0 * without, 100.0 * tendons, 100.0 * blend, 100.0 * grid, kPeakNm);
    EXPECT_GT(without, 0.4);
    EXPECT_LT(tendons, 0.25 * without);
    EXPECT_LT(blend, 0.25 * without);
    EXPECT_LT(grid, 0.25 * without);
  }
}

}  // namespace
}  // namespace capstan::tools
