// SPDX-License-Identifier: Apache-2.0
// Whether palpation's 95 % intervals hold over many tissues, and what a map finds.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <optional>

#include "capstan/tests/tools/run/tissues.hpp"
#include "capstan/tools/thesis/detection.hpp"

namespace capstan::tools {
namespace {

using test::calibrated;
using test::felt_by_board;
using test::servo_log;
using test::tissue;
using test::torque_log;

using Coverage = CoverageCount;

void print(const Coverage& c, const char* who) {
  std::printf("  %s: %d of %d answered, %d inside (%.1f %%), mean error %+.2f %%, mean half interval %.2f %%\n", who,
              c.answered, c.asked, c.inside, c.percent(), 100.0 * c.mean_error(), 100.0 * c.mean_half());
}

/// Tissues that are pressed, how, and from which seed on they are drawn.
struct Survey {
  const char* name;
  int tissues;
  double frequency_hz;
  std::uint64_t first_seed;
  bool damped = true;
  bool torque = false;  ///< triangles of torque against a spring that holds both ways, as a board does by itself
};

/// The spring that stands for a tissue where no tip comes out again: its resistance is that of the tissue at a tenth of
/// a radian.
auto spring(const sim::Environment& tissue) -> sim::Environment {
  return {.kind = sim::EnvironmentKind::kKelvinVoigt,
          .stiffness = tissue.deep_stiffness,
          .damping = 0.1 * tissue.deep_stiffness * tissue.damping};
}

struct Both {
  Coverage host, board;
};

auto survey(const Survey& s) -> Both {
  Both both;
  TensionStateParameters<double> parameters;
  for (int i = 0; i < s.tissues; ++i) {
    const std::uint64_t seed = s.first_seed + static_cast<std::uint64_t>(i);
    if (i % 100 == 0) {
      parameters = calibrated(seed);
    }
    sim::PlantParameters p;
    p.environment = tissue(seed);
    p.environment.damping *= s.damped ? 1.0 : 0.0;
    const double truth = p.environment.deep_stiffness;
    p.environment = s.torque ? spring(p.environment) : p.environment;
    const double seconds = 2.0 / s.frequency_hz;
    const AxisLog log = s.torque ? torque_log(p, seconds, 0.05 + truth, s.frequency_hz, seed)
                                 : servo_log(p, seconds, 0.2, 0.15, s.frequency_hz, seed);
    both.host.count(truth, palpate(log, parameters, {{0.0, seconds}})[0].combined);
    both.board.count(truth, felt_by_board(log, parameters));
  }
  std::printf("%s, %.2f Hz, seeds %llu on\n", s.name, s.frequency_hz, static_cast<unsigned long long>(s.first_seed));
  print(both.host, "host");
  print(both.board, "board");
  return both;
}

/// CAPSTAN_TISSUES of them; docs/thesis.md and docs/firmware.md tell of 1,000, and of ten maps.
auto tissues_asked() -> int {
  const char* text = std::getenv("CAPSTAN_TISSUES");
  return text == nullptr ? 250 : std::max(200, std::atoi(text));
}
auto maps_asked() -> int {
  return std::getenv("CAPSTAN_TISSUES") == nullptr ? 4 : 10;
}

void expect_true_intervals(const Coverage& c) {
  EXPECT_GE(c.answered, c.asked - c.asked / 100);
  EXPECT_GE(c.percent(), 93.0);
  EXPECT_LE(c.percent(), 97.0);
  EXPECT_LT(std::abs(c.mean_error()), 0.005) << "a stroke in alone is off by the damping, 3 % here";
  EXPECT_LT(c.mean_half(), 0.03) << "wide enough to hold anything is no answer";
}

// Seeds that took no part in any choice.
TEST(PalpationCoverage, IntervalsHoldTheStiffnessOf93To97OfAHundredTissuesDampedOrNot) {
  const Both damped = survey({"damped", tissues_asked(), 0.2, 750000});
  const Both still = survey({"undamped", tissues_asked() - 100, 0.2, 800000, false});
  expect_true_intervals(damped.host);
  expect_true_intervals(damped.board);
  // Without resistance nothing is left of the error that the strokes do not cancel, but the intervals stay as wide.
  EXPECT_GE(still.host.percent(), 93.0);
  EXPECT_GE(still.board.percent(), 93.0);
  Coverage all = damped.board;
  all.asked += still.board.asked;
  all.answered += still.board.answered;
  all.inside += still.board.inside;
  all.error += still.board.error;
  all.half += still.board.half;
  print(all, "board, damped and not");
  expect_true_intervals(all);
}

TEST(PalpationCoverage, StrokesTooQuickToShowTheReleaseGetWiderIntervalsInsteadOfWrongOnes) {
  const Both quick = survey({"damped", 300, 0.4, 850000});
  for (const Coverage& c : {quick.host, quick.board}) {
    EXPECT_GE(c.percent(), 93.0);
    EXPECT_GT(c.mean_half(), 0.02);
  }
}

TEST(PalpationCoverage, TrianglesOfTorqueAsTheBoardPressesThem) {
  if (std::getenv("CAPSTAN_TISSUES") == nullptr) {
    GTEST_SKIP() << "40 s of plant for each; CAPSTAN_TISSUES asks for it";
  }
  const Both pressed = survey({"torque", tissues_asked(), 0.05, 830000, true, true});
  EXPECT_GE(pressed.board.answered, pressed.board.asked * 98 / 100);
  EXPECT_GE(pressed.board.percent(), 93.0);
}

const std::vector<double> kFactors = {1.05, 1.1, kStiffFactor, 1.5};
constexpr std::size_t kOfCommand = 2;

TEST(PalpationDetection, HitsOverFalseAlarmsByDepthAndStiffness) {
  const auto parameters = calibrated(900000);
  constexpr std::array<double, 3> kStiffness = {0.02, 0.04, 0.08};
  constexpr std::array<double, 3> kDepth = {0.04, 0.12, 0.18};
  std::uint64_t seed = 910000;
  std::array<std::array<Detection, 3>, 3> found;
  const int maps = maps_asked();
  std::printf("inclusion N m/rad, depth rad: hits of %d, false alarms of %d at factors 1.05, 1.1, 1.2, 1.5\n", maps,
              6 * maps);
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::size_t d = 0; d < 3; ++d) {
      const Detection f = found[k][d] = detect({kStiffness[k], kDepth[d]}, maps, seed, kFactors, parameters);
      seed += 10000;
      std::printf("  %.2f, %.2f:", kStiffness[k], kDepth[d]);
      for (std::size_t i = 0; i < kFactors.size(); ++i) {
        std::printf("  %d/%d", f.hits[i], f.alarms[i]);
      }
      std::printf("\n");
      EXPECT_EQ(f.alarms[kOfCommand], 0) << "the factor that the command uses";
      EXPECT_GE(f.hits[0], f.hits[3]) << "a lower factor never finds less";
    }
  }
  EXPECT_GE(found[2][0].hits[3], maps - 1) << "stiff and shallow";
  for (const std::size_t depth : {0U, 1U}) {
    EXPECT_GE(found[0][depth].hits[kOfCommand], maps - 1) << "a third more than the rest, where the tip reaches";
  }
  EXPECT_LE(found[0][0].hits[3], 1) << "a third more than the rest is below the factor of 1.5";
  EXPECT_LE(found[2][2].hits[3], 1) << "the tip does not press so deep";
}

TEST(PalpationDetection, CurveOfHitsOverFalseAlarmsRisesFromNothingToEverySite) {
  const Detection found{10, 60, {0.8, 1.1, 1.5}, {10, 9, 4}, {57, 6, 0}};
  const Series curve = detection_series(found, "", "");
  ASSERT_EQ(curve.x.size(), 5);
  const std::array<double, 5> alarms = {0.0, 0.0, 0.1, 0.95, 1.0};
  const std::array<double, 5> hits = {0.0, 0.4, 0.9, 1.0, 1.0};
  for (Eigen::Index i = 0; i < 5; ++i) {
    EXPECT_NEAR(curve.x[i], alarms[static_cast<std::size_t>(i)], 1e-12);
    EXPECT_NEAR(curve.y[i], hits[static_cast<std::size_t>(i)], 1e-12);
  }
}

}  // namespace
}  // namespace capstan::tools
