// SPDX-License-Identifier: Apache-2.0
// The rig that the thesis's experiments are repeated on: its motions and its records.
#include "capstan/tools/thesis/rig.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "capstan/tools/thesis/laws.hpp"

namespace capstan::tools {
namespace {

TEST(ThesisSignals, MultisineHasTheRootMeanSquareThatIsAskedForAndItsTones) {
  const sim::Motion motion = multisine(5.0, {0.1, 0.2}, 20.0);
  // Projection on each tone over whole periods, from 10 s on, where the start has faded out: equal shares of the power.
  double power = 0.0;
  for (const double f : {0.1, 0.2, 0.3}) {
    double c = 0.0;
    double s = 0.0;
    for (int i = 0; i < 10000; ++i) {
      const double t = 10.0 + 0.001 * i;
      c += 2e-4 * motion.reference_rad(t) * std::cos(2.0 * M_PI * f * t);
      s += 2e-4 * motion.reference_rad(t) * std::sin(2.0 * M_PI * f * t);
    }
    const double amplitude = std::hypot(c, s) * 180.0 / M_PI;
    EXPECT_NEAR(amplitude, f < 0.25 ? 5.0 : 0.0, 0.1) << f;
    power += 0.5 * amplitude * amplitude;
  }
  EXPECT_NEAR(std::sqrt(power), 5.0, 0.1);
}

TEST(ThesisRig, RecordsWhatSensorsShowWhileTheServoFollowsAndTheOtherMotorsHold) {
  const auto wrist = sim::parse_instrument(sim::built_in_instrument("da_vinci_wrist"), "wrist").axes;
  const Experiment run = run_experiment(wrist, 1, sine(10.0, 0.5, 4.0), stiff_gains(), 1);
  EXPECT_EQ(run.log.samples(), 450);
  EXPECT_NEAR(run.log.time_s[449], 4.49, 1e-12);
  // 20 A/rad at 0.1 N m/A against 0.09 N m of friction: at most 0.045 rad, 2.6 deg.
  EXPECT_LT(rms_deg(run.log.q1_rad - run.wanted_rad), 2.6);
  // Sliding tendons alone take I eta r1 / 1 = 0.082 N m; motor and joint add a little.
  EXPECT_NEAR(run.log.tau_nm.maxCoeff(), 0.09, 0.03);
  EXPECT_GT(rms_deg(run.log.q2_rad), 4.0);
}

}  // namespace
}  // namespace capstan::tools
