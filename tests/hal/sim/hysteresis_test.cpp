// SPDX-License-Identifier: Apache-2.0
// How a loop depends on what was before it: congruency of minor loops, the slip front after a reversal, the kink where
// a tendon goes slack, and up to which pretension more of it helps.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "capstan/hal/sim/plant.hpp"
#include "capstan/tests/hal/sim/support.hpp"

namespace capstan::sim {
namespace {

using test::Bench;
using test::quiet;

// The closed minor loop of the motor torque between 0.1 - depth and 0.1 + depth, after the saturations given.
std::vector<double> minor_loop(const PlantParameters& p, double first, double second, double depth) {
  Bench bench(p);
  bench.go(first);
  bench.go(second);
  for (const double end : {0.1 - depth, 0.1 + depth, 0.1 - depth})
    bench.go(end);
  std::vector<double> loop;
  for (const double end : {0.1 + depth, 0.1 - depth}) {
    for (const Truth& t : bench.go(end))
      loop.push_back(t.tau_in_nm);
  }
  return loop;
}

// How much two minor loops between the same ends, one reached from below and one from above, differ in shape, as a
// share of their height. A shift as a whole does not count.
double incongruency(const PlantParameters& p, double depth) {
  const std::vector<double> a = minor_loop(p, 0.5, -0.5, depth);
  const std::vector<double> b = minor_loop(p, -0.5, 0.5, depth);
  double shift = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i)
    shift += (a[i] - b[i]) / static_cast<double>(a.size());
  double worst = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i)
    worst = std::max(worst, std::fabs(a[i] - b[i] - shift));
  const auto [low, high] = std::minmax_element(a.begin(), a.end());
  return worst / (*high - *low);
}

TEST(Hysteresis, MinorLoopsThatSlideThroughoutAreCongruent) {
  PlantParameters p = quiet();
  EXPECT_LT(incongruency(p, 0.1), 1.0e-3);
  p.environment.kind = EnvironmentKind::kLocked;
  EXPECT_LT(incongruency(p, 0.1), 1.0e-3);
}

TEST(Hysteresis, SmallerMinorLoopsAreCongruentToATenthOnly) {
  // Capstan friction is proportional to the tension, and the past leaves another tension behind: a Preisach model,
  // which has congruency by construction, can not be exact here.
  PlantParameters p = quiet();
  p.environment.kind = EnvironmentKind::kLocked;
  EXPECT_LT(incongruency(p, 0.02), 0.1);
  EXPECT_GT(incongruency(p, 0.02), 0.02);
}

TEST(Hysteresis, AfterAReversalTheSlipFrontAdvancesAndTheStiffnessFalls) {
  PlantParameters p = quiet();
  p.environment.kind = EnvironmentKind::kLocked;
  p.element_count = 64;
  Bench bench(p);
  bench.go(0.3);
  bench.go(-0.05);
  const std::vector<Truth> rise = bench.go(0.05);
  std::vector<double> slopes;
  for (std::size_t i = 5; i + 10 < rise.size(); i += 10)
    slopes.push_back((rise[i + 10].tau_in_nm - rise[i].tau_in_nm) / (rise[i + 10].q1_rad - rise[i].q1_rad));
  for (std::size_t i = 1; i < slopes.size(); ++i)
    EXPECT_LT(slopes[i], slopes[i - 1] * 1.02) << i;
  // (3.7): K eta / (1 - e^{-eta phi}) with little slip yet is several times what it is with all.
  EXPECT_GT(slopes.front(), 3.0 * slopes.back());
}

TEST(Hysteresis, TheOutputWaitsAfterAReversalUntilTheSlipFrontArrives) {
  // Presliding: the joint stands still while the motor has already turned and its torque has changed. Both have the
  // size that the tendons' friction and elasticity give, and nothing else is in the plant.
  Bench bench(quiet());
  bench.go(0.5);
  const Truth turn = bench.plant().truth();
  double turned = 0.0;
  while (bench.plant().truth().q2_rad > turn.q2_rad - 1.0e-3) {
    turned += 2.0e-4;
    bench.go(0.5 - turned);
    ASSERT_LT(turned, 0.4);
  }
  EXPECT_GT(turned, 0.02);
  EXPECT_GT(turn.tau_in_nm - bench.plant().truth().tau_in_nm, 0.5 * turn.tau_in_nm);
}

TEST(Hysteresis, TheForceCurveHasAKinkWhereATendonGoesSlack) {
  PlantParameters p = quiet();
  p.environment.kind = EnvironmentKind::kLocked;
  p.element_count = 48;
  Bench bench(p);
  bench.go(0.4);
  bench.go(-0.4);
  std::vector<Truth> rise;
  std::size_t slack = 0;
  for (double at = -0.4; at < 0.4; at += 2.0e-4) {
    rise.push_back(bench.go(at).back());
    if (slack == 0 && bench.plant().drivetrain().bottom().elongation() <= 0.0)
      slack = rise.size() - 1;
  }
  ASSERT_GT(slack, 100U);
  const auto slope = [&](std::size_t i) {
    return (rise[i + 4].tau_in_nm - rise[i].tau_in_nm) / (rise[i + 4].q1_rad - rise[i].q1_rad);
  };
  // Straight on both sides within a mrad of the kink, and bent by the pushed tendon's share of the stiffness.
  EXPECT_NEAR(slope(slack - 6), slope(slack - 40), 0.01 * slope(slack - 40));
  EXPECT_NEAR(slope(slack + 2), slope(slack + 40), 0.01 * slope(slack + 40));
  const double eta = p.eta_top;
  const double pulled = p.stiffness_top_n_per_m * eta / (1.0 - std::exp(-eta));
  const double pushed = p.stiffness_bottom_n_per_m * p.eta_bottom / (std::exp(p.eta_bottom) - 1.0);
  EXPECT_NEAR(slope(slack - 6) / slope(slack + 2), 1.0 + pushed / pulled, 0.02);
}

// Half the width of the loop between the angles of a joint with a constant load F = torque / r2, sliding throughout, by
// integration of (2.4) over both tendons, eta and stiffness the same:
//   taut:   I = (Ttr (e^eta - 1) + Tbr (1 - e^-eta)) / eta with Ttr = Tbr + F,
//   slack:  Tbr = 0, Ttr = F, and the slack tendon takes what the other is stretched beyond the common start.
// Delta_t - Delta_t(start) turns the joint back by the same over r2.
double closed_half_width_rad(double pretension_n, double load_nm, double eta, double stiffness, double radius_m) {
  const double load_n = load_nm / radius_m;
  const double enough = load_n * (std::exp(eta) - 1.0) / eta;  // the pulled tendon alone holds this much
  double top = enough;                                         // integral of Tt
  if (pretension_n > enough) {
    const double bottom = (pretension_n * eta - load_n * (std::exp(eta) - 1.0)) / (std::exp(eta) - std::exp(-eta));
    top = pretension_n - bottom * (1.0 - std::exp(-eta)) / eta;
  }
  return (top - 0.5 * pretension_n) / (stiffness * radius_m);
}

struct Loop {
  double half_width_rad;
  bool slack;
};

Loop loop_at(PlantParameters p, double pretension_n) {
  p.pretension_n = pretension_n;
  Bench bench(p);
  bench.go(0.5);
  Loop loop{0.0, false};
  double high = -1.0;
  double low = 1.0;
  for (double at = 0.5; at > -1.5; at -= 4.0e-3) {
    const Truth t = bench.go(at > -0.5 ? at : -1.0 - at).back();
    const double lag = t.q1_rad * p.input_radius_m / p.output_radius_m - t.q2_rad;
    high = std::max(high, lag);
    low = std::min(low, lag);
    const Drivetrain& d = bench.plant().drivetrain();
    loop.slack = loop.slack || d.top().elongation() <= 0.0 || d.bottom().elongation() <= 0.0;
  }
  loop.half_width_rad = 0.5 * (high - low);
  return loop;
}

TEST(Hysteresis, TheLoopNarrowsWithPretensionBySlackAndWidensByFrictionAsTheClosedFormHasIt) {
  // The thesis' narrowing (figure 7.6, (7.5)) is at a given motor torque; but that torque holds the tendons' friction
  // I eta r1 too, which grows with pretension. At a given load the loop narrows by 1 / (2 K r2) per newton while a
  // tendon goes slack, and from I = F (e^eta - 1) / eta on, always taut, it widens by tanh(eta / 2) / (2 K r2).
  PlantParameters p = quiet();
  p.joint_viscous_nms_per_rad = 0.0;
  p.element_count = 32;
  p.eta_top = p.eta_bottom = 1.14;
  p.stiffness_top_n_per_m = p.stiffness_bottom_n_per_m = 5.07e4;
  for (const double load_nm : {0.01, 0.03}) {
    p.joint_coulomb_nm = load_nm;
    const double turning_n = load_nm / p.output_radius_m * (std::exp(p.eta_top) - 1.0) / p.eta_top;
    const auto slope_between = [&](double from, double to) {
      double width[2];
      for (int i = 0; i < 2; ++i) {
        const double pretension = (i == 0 ? from : to) * turning_n;
        const double expected =
            closed_half_width_rad(pretension, load_nm, p.eta_top, p.stiffness_top_n_per_m, p.output_radius_m);
        const Loop loop = loop_at(p, pretension);
        EXPECT_NEAR(loop.half_width_rad, expected, 0.01 * expected) << from << to;
        EXPECT_EQ(loop.slack, to < 1.0) << from << to;
        width[i] = loop.half_width_rad;
      }
      return (width[1] - width[0]) / ((to - from) * turning_n);
    };
    const double narrowing = -0.5 / (p.stiffness_top_n_per_m * p.output_radius_m);
    EXPECT_NEAR(slope_between(0.2, 0.8), narrowing, 0.02 * -narrowing) << load_nm;
    EXPECT_NEAR(slope_between(1.3, 3.0), -std::tanh(0.5 * p.eta_top) * narrowing, 0.02 * -narrowing) << load_nm;
  }
}

TEST(Hysteresis, MorePretensionNarrowsTheLoopExactlyAsLongAsATendonGoesSlack) {
  // Not monotone for ever, as is sometimes said: once no tendon empties any more, all further pretension is friction.
  for (const double load_nm : {0.002, 0.01, 0.03}) {
    PlantParameters p = quiet();
    p.joint_coulomb_nm = load_nm;
    Loop before{0.0, false};
    int narrower = 0;
    int wider = 0;
    for (const double pretension : {0.5, 1.0, 4.0, 7.0, 14.0, 20.0, 40.0, 60.0}) {
      const Loop now = loop_at(p, pretension);
      if (pretension > 0.5 && now.slack) {
        EXPECT_LT(now.half_width_rad, before.half_width_rad) << load_nm << " " << pretension;
        ++narrower;
      } else if (pretension > 0.5 && !before.slack) {
        EXPECT_GT(now.half_width_rad, before.half_width_rad) << load_nm << " " << pretension;
        ++wider;
      }
      before = now;
    }
    EXPECT_GT(narrower, 0) << load_nm;
    EXPECT_GT(wider, 0) << load_nm;
  }
}

}  // namespace
}  // namespace capstan::sim
