// SPDX-License-Identifier: Apache-2.0
// The blend (2.27): what a log of the simulated instrument makes of it, on torques that it has not seen, and on a
// board.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "capstan/tests/tools/run/board_rig.hpp"
#include "capstan/tests/tools/run/by_hand.hpp"
#include "capstan/tests/tools/run/recipe_log.hpp"
#include "capstan/tools/apply/force_lines.hpp"
#include "capstan/tools/identify/force_section.hpp"
#include "capstan/tools/replay/force_replay.hpp"
#include "capstan/tools/support/errors.hpp"

namespace capstan::tools {
namespace {

auto locked() -> sim::PlantParameters {
  sim::PlantParameters plant;
  plant.environment.kind = sim::EnvironmentKind::kLocked;
  return plant;
}

auto file_of(const PullPushFit& fit) -> std::string {
  return with_force_section("", force_section(fit));
}

/// What the law of a file leaves of another log, as a board runs it, N m.
auto left_of(const AxisLog& log, const PullPushFit& fit) -> double {
  const auto replayed = replay_force(log.tau_nm, read_board_force_law(file_of(fit), "joint.toml"), Arithmetic::kFixed);
  return std::sqrt((replayed.torque_nm - log.effort).squaredNorm() / static_cast<double>(log.samples()));
}

TEST(BlendFit, LeavesLessOfTorquesThatItHasNotSeenThanThePullPushLaw) {
  const AxisLog triangle = test::turn_by_hand(locked(), 60.0, test::triangle(0.25, 0.05));
  const PullPushFit alone = fit_pull_push({triangle});
  const PullPushFit blend = fit_blend({triangle});
  ASSERT_TRUE(blend.undetermined.empty());
  EXPECT_EQ(blend.law.eta_top, alone.law.eta_top);
  EXPECT_GT(blend.law.pull_weight, 0.0);
  for (const auto& tones : {std::pair{0.05, 0.025}, std::pair{0.02, 0.014}, std::pair{0.1, 0.03}}) {  // of figure 2.10
    const auto turn = 2.0 * std::numbers::pi;
    const AxisLog other = test::turn_by_hand(locked(), 80.0, [&](double t) {
      return 0.125 * (std::sin(turn * tones.first * t) + std::sin(turn * tones.second * t));
    });
    const double by_blend = left_of(other, blend);
    const double by_law = left_of(other, alone);
    std::printf("%.3g and %.3g Hz: blend %.3f, pull-push law %.3f mN m of %.1f\n", tones.first, tones.second,
                1e3 * by_blend, 1e3 * by_law, 1e3 * other.effort.cwiseAbs().maxCoeff());
    EXPECT_LT(by_blend, by_law);
  }
}

TEST(BlendFit, ComesBackFromItsFileAndIsPutOnABoardThatSaysWhatItIs) {
  const PullPushFit blend = fit_blend({test::record("recipe_pull_push.toml")});
  const PullPushFit read = read_pull_push(file_of(blend), "joint.toml");
  EXPECT_EQ(read.kind, ForceLawKind::kBlend);
  EXPECT_EQ(read.law.pull_weight, blend.law.pull_weight);
  EXPECT_EQ(read.law.pull_push_weight, blend.law.pull_push_weight);

  test::BoardRig rig(sim::Scenario{});
  rig.say("begin");
  rig.say(force_lines(file_of(blend), "joint.toml", 0));
  EXPECT_NE(rig.say("commit").find("ok"), std::string::npos);
  EXPECT_NE(rig.say("model joint0").find("blend (2.27)"), std::string::npos);
}

TEST(BlendFit, FileWithoutAWeightIsRefusedWithItsName) {
  std::string file = file_of(fit_blend({test::record("recipe_pull_push.toml")}));
  const std::size_t at = file.find("pull_push_weight");
  file.erase(at, file.find('\n', at) - at);
  try {
    static_cast<void>(read_pull_push(file, "joint.toml"));
    FAIL() << "taken";
  } catch (const BadInput& error) {
    EXPECT_NE(std::string(error.what()).find("pull_push_weight"), std::string::npos);
  }
}

}  // namespace
}  // namespace capstan::tools
