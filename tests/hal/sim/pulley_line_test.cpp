// SPDX-License-Identifier: Apache-2.0
// A tendon over rotating idlers against known limits and independent integration. Nothing here comes from model/.
#include "capstan/hal/sim/pulley_line.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

namespace capstan::sim {
namespace {

constexpr double kPi = 3.14159265358979323846;

/// Speed that rises and falls as a raised cosine of `ramp_s`, so that nothing rings for long.
auto smooth(double t, double ramp_s, double speed) -> double {
  return t >= ramp_s ? speed : 0.5 * speed * (1.0 - std::cos(kPi * t / ramp_s));
}

auto damped() -> PulleyLineParameters {
  PulleyLineParameters p;
  p.load_mass_kg = 0.02;
  p.load_damping_ns_per_m = 20.0;
  return p;
}

auto run(PulleyLine& line, double seconds, const std::function<double(double)>& speed) {
  const double start = line.time_s();
  while (line.time_s() - start < seconds) {
    line.step(speed(line.time_s() - start));
  }
}

/// Output over input tension after a smooth start, over the last third.
auto moving_ratio(const PulleyLineParameters& p, double speed) -> double {
  PulleyLine line(p);
  run(line, 0.1, [&](double t) { return smooth(t, 0.02, speed); });
  double in = 0.0;
  double out = 0.0;
  run(line, 0.05, [&](double /*t*/) {
    in += line.input_tension_n();
    out += line.output_tension_n();
    return speed;
  });
  return out / in;
}

TEST(PulleyLine, LockedPulleyObeysTheCapstanEquationEitherWayAndTwoMultiply) {
  PulleyLineParameters p = damped();
  p.pulleys[0].locked = true;
  const double ratio = std::exp(-0.2 * 0.5 * kPi);
  EXPECT_NEAR(moving_ratio(p, 0.05), ratio, 1e-3 * ratio);
  EXPECT_NEAR(moving_ratio(p, -0.05), 1.0 / ratio, 1e-3 / ratio);
  p.pulleys.push_back(p.pulleys[0]);
  p.spans_m.push_back(0.05);
  EXPECT_NEAR(moving_ratio(p, 0.05), ratio * ratio, 2e-3 * ratio * ratio);
}

TEST(PulleyLine, FreePulleyLosesNothing) {
  PulleyLineParameters p = damped();
  p.pulleys[0].bearing_friction = 0.0;
  EXPECT_NEAR(moving_ratio(p, 0.05), 1.0, 5e-4);
  EXPECT_NEAR(moving_ratio(p, -0.05), 1.0, 5e-4);
}

TEST(PulleyLine, TurningPulleyLosesWhatItsBearingTakesOfTheResultant) {
  const PulleyLineParameters p = damped();
  const PulleyParameters& pulley = p.pulleys[0];
  // (1 - x) r = mu r' |e1 + x e2| as vectors, e1 and e2 along the tendon away from the pulley; bisection.
  double low = 0.0;
  double high = 1.0;
  for (int i = 0; i < 60; ++i) {
    const double x = 0.5 * (low + high);
    const double across = std::hypot(1.0 - x * std::cos(pulley.wrap_rad), x * std::sin(pulley.wrap_rad));
    const bool too_much = (1.0 - x) * pulley.radius_m > pulley.bearing_friction * pulley.bore_radius_m * across;
    (too_much ? low : high) = x;
  }
  EXPECT_NEAR(moving_ratio(p, 0.05), low, 1e-3);
  EXPECT_NEAR(moving_ratio(p, -0.05), 1.0 / low, 1e-3);
}

TEST(PulleyLine, TendonSticksWhereItRunsOnAndSlipsOverAFixedArcWhereItRunsOff) {
  PulleyLineParameters p = damped();
  p.nodes_per_pulley = 16;
  p.mass_kg_per_m = 4e-3;
  PulleyLine line(p);
  // Far enough that what the start left on the pulley has run off: twice the arc.
  run(line, 0.26, [](double t) { return smooth(t, 0.02, 0.1); });
  const std::vector<double> tension = line.tensions_on(0);
  const double loss = std::log(tension.front() / tension.back());
  const double slip_share = loss / (p.pulleys[0].surface_friction * p.pulleys[0].wrap_rad);
  ASSERT_GT(slip_share, 0.2);
  ASSERT_LT(slip_share, 0.5);
  // From the driven side: slips down to the load's tension, then is even to the end.
  const auto points = static_cast<double>(p.nodes_per_pulley);
  const auto slips = static_cast<std::size_t>(std::ceil(slip_share * points)) + 1;
  for (std::size_t i = slips; i + 1 < tension.size(); ++i) {
    EXPECT_NEAR(tension[i], tension.back(), 0.1 * (tension.front() - tension.back())) << i;
  }
  const auto middle = static_cast<std::size_t>(0.5 * slip_share * points);
  EXPECT_NEAR(std::log(tension.front() / tension[middle]),
              p.pulleys[0].surface_friction * p.pulleys[0].wrap_rad * static_cast<double>(middle) / points, 0.2 * loss);
}

TEST(PulleyLine, EnergyBalanceClosesOverStopGoAndReversal) {
  PulleyLineParameters p = damped();
  p.spans_m = {0.15, 0.05, 0.15};
  p.pulleys = {{}, {}};
  p.pulleys[1].locked = true;
  PulleyLine line(p);
  for (const double speed : {0.05, 0.0, 0.05, 0.0, -0.05, 0.0}) {
    run(line, 0.03, [&](double t) { return smooth(t, 0.005, speed); });
  }
  const PulleyLineEnergy e = line.energy();
  EXPECT_GT(e.slip, 1e-3);
  EXPECT_GT(e.bearings, 1e-3);
  EXPECT_NEAR(e.missing(), 0.0, 2e-3 * (e.slip + e.bearings + e.damping));
  EXPECT_GE(e.missing(), -1e-4 * (e.slip + e.bearings + e.damping));
}

TEST(PulleyLine, RigidGripMovesAsTwoMassesIntegratedByRungeKutta) {
  PulleyLineParameters p = damped();
  p.pulleys[0].bearing_friction = 0.0;
  p.pulleys[0].surface_friction = 2.0;
  p.pulleys[0].inertia_kgm2 = 64e-6 * 0.02;  // as much as the load's mass
  p.damping_s = 0.0;
  PulleyLine line(p);
  // Both halves of the tendon are springs without mass between drum, rim and load; nothing slips.
  const double arc = p.pulleys[0].radius_m * p.pulleys[0].wrap_rad;
  const double near = p.axial_stiffness_n / (p.spans_m[0] + 0.5 * arc);
  const double far = p.axial_stiffness_n / (p.spans_m[1] + 0.5 * arc);
  const double carried = 0.5 * p.mass_kg_per_m * (p.spans_m[0] + p.spans_m[1]);
  struct State {
    double rim = 0.0, rim_speed = 0.0, load = 0.0, load_speed = 0.0;
  };
  const auto travel = [](double t) {  // of the drum: integral of smooth()
    const double u = std::min(t, 0.005);
    return 0.5 * 0.05 * (u - 0.005 / kPi * std::sin(kPi * u / 0.005)) + 0.05 * std::max(0.0, t - 0.005);
  };
  const auto rate = [&](double t, const State& s) {
    const double pull_near = near * (travel(t) - s.rim);
    const double pull_far = far * (s.rim - s.load);
    return State{s.rim_speed, (pull_near - pull_far) / (0.02 + carried), s.load_speed,
                 (pull_far - p.load_damping_ns_per_m * s.load_speed) / p.load_mass_kg};
  };
  const auto add = [](const State& a, const State& b, double h) {
    return State{a.rim + h * b.rim, a.rim_speed + h * b.rim_speed, a.load + h * b.load,
                 a.load_speed + h * b.load_speed};
  };
  State s;
  double t = 0.0;
  constexpr double kStep = 5e-6;
  double worst = 0.0;
  double largest = 0.0;
  for (int i = 0; i < 4000; ++i) {
    const State k1 = rate(t, s);
    const State k2 = rate(t + 0.5 * kStep, add(s, k1, 0.5 * kStep));
    const State k3 = rate(t + 0.5 * kStep, add(s, k2, 0.5 * kStep));
    const State k4 = rate(t + kStep, add(s, k3, kStep));
    s = add(add(add(add(s, k1, kStep / 6.0), k2, kStep / 3.0), k3, kStep / 3.0), k4, kStep / 6.0);
    t += kStep;
    while (line.time_s() < t) {
      line.step(smooth(line.time_s(), 0.005, 0.05));
    }
    const double theirs = far * (s.rim - s.load);
    largest = std::max(largest, theirs);
    worst = std::max(worst, std::fabs(line.output_tension_n() - p.preload_n - theirs));
  }
  EXPECT_GT(largest, 1.0);
  EXPECT_LT(worst, 0.03 * largest) << "the tendon's own mass and its waves are all that differs";
  EXPECT_NEAR(line.pulley_angle_rad(0) * p.pulleys[0].radius_m, s.rim, 0.01 * s.rim);
}

TEST(PulleyLine, HeavyPulleySlipsWhenItStartsFastAndALightOneOrASlowStartDoNot) {
  // Work of sliding, J. The load asks for its own share of it, as its damping grows with speed, whatever the idler.
  const auto sliding = [](double inertia, double ramp_s) {
    PulleyLineParameters p = damped();
    p.pulleys[0].bearing_friction = 0.0;
    p.pulleys[0].inertia_kgm2 = inertia;
    PulleyLine line(p);
    run(line, 0.04, [&](double t) { return smooth(t, ramp_s, 0.2); });
    return line.energy().slip;
  };
  // The tendon grips with 10 N times (exp(0.2 pi / 2) - 1) = 3.7 N. 0.2 m/s in 2 ms asks for 157 m/s2 at most.
  const double hundred_grams = 64e-6 * 0.1;
  const double fast = sliding(hundred_grams, 0.002);
  EXPECT_GT(fast, 0.1 * 0.5 * 0.1 * 0.2 * 0.2) << "16 N asked for: of the order of the energy of turning it";
  EXPECT_LT(sliding(hundred_grams, 0.03), 0.1 * fast) << "1 N asked for";
  EXPECT_LT(sliding(1.6e-7, 0.002), 0.1 * fast) << "0.4 N asked for";
}

TEST(PulleyLine, HeldLoadAndStillDrumStayAtRest) {
  PulleyLineParameters p;
  p.load_held = true;
  PulleyLine line(p);
  line.run(0.01, 0.0);
  EXPECT_EQ(line.input_tension_n(), p.preload_n);
  EXPECT_EQ(line.pulley_angle_rad(0), 0.0);
  EXPECT_EQ(line.energy().missing(), 0.0);
}

TEST(PulleyLine, RefusesWhatMakesNoSenseWithTheRange) {
  const auto said = [](auto&& change) -> std::string {
    PulleyLineParameters p;
    change(p);
    try {
      PulleyLine line(p);
    } catch (const std::invalid_argument& e) {
      return e.what();
    }
    return "nothing";
  };
  EXPECT_EQ(said([](auto& p) { p.pulleys[0].wrap_rad = 4.0; }),
            "wrap_rad = 4 is out of range; it must be from 0.01 to 3.14159");
  EXPECT_EQ(said([](auto& p) { p.axial_stiffness_n = std::nan(""); }),
            "axial_stiffness_n = nan is out of range; it must be from 10 to 1e+07");
  EXPECT_EQ(said([](auto& p) { p.spans_m.pop_back(); }),
            "spans_m has 1 lengths; 1 pulleys have 2 spans before, between and behind them");
  EXPECT_NE(said([](auto& p) { p.mass_kg_per_m = 1e-5, p.nodes_per_pulley = 256; }).find("more mass_kg_per_m"),
            std::string::npos);
  EXPECT_NE(said([](auto& p) { p.pulleys.clear(); }).find("it must be from 1 to 32"), std::string::npos);
}

}  // namespace
}  // namespace capstan::sim
