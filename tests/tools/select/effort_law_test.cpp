// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/select/effort_law.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "capstan/tools/joint_file/effort_file.hpp"
#include "capstan/tools/replay/effort_replay.hpp"
#include "capstan/tools/select/effort_catalogue.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/statistics.hpp"

namespace capstan::tools {
namespace {

constexpr double kPeriodS = 0.005;
constexpr Eigen::Index kRows = 6000;

/// Three sines without a common period; what an axis of inertia 0.05, drag 0.3, dry friction 0.5 and offset 0.2 asks
/// for.
/// @param angle_scale, effort_scale  other units
auto rigid_log(double noise, double angle_scale = 1.0, double effort_scale = 1.0) -> AxisLog {
  AxisLog log;
  log.name = "made up";
  log.target = "axis0/tau_Nm";
  log.period_s = kPeriodS;
  for (auto* signal : {&log.time_s, &log.q1_rad, &log.effort, &log.tau_nm}) {
    *signal = Eigen::VectorXd::Zero(kRows);
  }
  std::mt19937 engine(7);
  std::normal_distribution<double> normal;
  for (Eigen::Index i = 0; i < kRows; ++i) {
    const double t = kPeriodS * static_cast<double>(i);
    double q = 0.0;
    double v = 0.0;
    double a = 0.0;
    for (const auto& [size, hz] : {std::pair{0.8, 0.23}, {0.3, 0.61}, {0.1, 1.37}}) {
      const double w = 2.0 * std::numbers::pi * hz;
      q += size * std::sin(w * t);
      v += size * w * std::cos(w * t);
      a -= size * w * w * std::sin(w * t);
    }
    log.time_s[i] = t;
    log.q1_rad[i] = angle_scale * q;
    const double effort = 0.05 * a + 0.3 * v + (v > 0.0 ? 0.5 : -0.5) + 0.2;
    log.effort[i] = effort_scale * (effort + noise * normal(engine));
  }
  return log;
}

/// The law of that axis with noise of 0.02, grown once for all tests of a program: growing takes most of their time.
auto rigid_selection() -> const EffortSelection& {
  static const EffortSelection found = select_effort_law({rigid_log(0.02)});
  return found;
}

/// Adds to the effort what `effect(q, v)` gives.
template <typename Effect>
void add_effect(AxisLog& log, Effect&& effect) {
  for (Eigen::Index i = 1; i + 1 < log.samples(); ++i) {
    log.effort[i] += effect(log.q1_rad[i], (log.q1_rad[i + 1] - log.q1_rad[i - 1]) / (2.0 * kPeriodS));
  }
}

TEST(LocalCubic, ReproducesACubicAndItsDerivativesUpToTheEnds) {
  Eigen::VectorXd signal(41);
  const auto at = [](double x) { return 1.0 - 0.3 * x + 0.02 * x * x + 0.001 * x * x * x; };
  for (Eigen::Index i = 0; i < signal.size(); ++i) {
    signal[i] = at(static_cast<double>(i));
  }
  const LocalCubic cubic(6);
  for (const Eigen::Index i : {0, 3, 20, 40}) {
    const auto x = static_cast<double>(i);
    EXPECT_NEAR(cubic.derivative(signal, 0)[i], at(x), 1e-9);
    EXPECT_NEAR(cubic.derivative(signal, 1)[i], -0.3 + 0.04 * x + 0.003 * x * x, 1e-9);
    EXPECT_NEAR(cubic.derivative(signal, 2)[i], 0.04 + 0.006 * x, 1e-9);
  }
  EXPECT_EQ(cubic.derivative(signal, 1, 7).size(), 6);
  EXPECT_EQ(cubic.derivative(signal, 1, 7)[2], cubic.derivative(signal, 1)[14]);
}

TEST(EffectName, LeavesOutPlaceAndAxisOnly) {
  EXPECT_EQ(effect_name("angle_periodic_3"), "angle_periodic");
  EXPECT_EQ(effect_name("axis_coupling_axis5"), "axis_coupling");
  EXPECT_EQ(effect_name("play_friction"), "play_friction");
  EXPECT_EQ(effect_name("offset"), "offset");
}

TEST(EffortLaw, IsChosenWhereThereIsEnoughToChooseBy) {
  const AxisLog log = rigid_log(0.01);
  const auto cut = [&log](Eigen::Index rows) {
    AxisLog part = log;
    for (auto* signal : {&part.time_s, &part.q1_rad, &part.effort, &part.tau_nm}) {
      signal->conservativeResize(rows);
    }
    return part;
  };
  EXPECT_TRUE(can_select_effort_law({log}));
  EXPECT_TRUE(can_select_effort_law({cut(240)}));
  EXPECT_FALSE(can_select_effort_law({cut(239)}));
  EXPECT_TRUE(can_select_effort_law({cut(120), cut(120)}));
  EXPECT_FALSE(can_select_effort_law({log, cut(19)}));  // a window hardly fits into the second
  AxisLog still = log;
  still.q1_rad.setConstant(0.3);
  EXPECT_FALSE(can_select_effort_law({still}));
  EXPECT_TRUE(can_select_effort_law({still, log}));
  AxisLog idle = log;
  idle.effort.setConstant(0.3);
  EXPECT_FALSE(can_select_effort_law({idle}));
  EXPECT_TRUE(can_select_effort_law({idle, log}));
}

TEST(EffortLaw, OfASlideFromInertiaAloneIsInNewtonsAndTellsWhatCameBeside) {
  AxisLog log = rigid_log(0.02);
  for (auto* signal : {&log.time_s, &log.q1_rad, &log.effort, &log.tau_nm}) {
    signal->conservativeResize(1500);
  }
  log.linear = true;
  const EffortSelection found = select_effort_law({log}, true);
  EXPECT_EQ(found.law.joint.catalogue->target_unit(), "N");
  EXPECT_EQ(found.start.joint.terms, std::vector<std::string>{"inertia"});
  for (const char* effect : {"viscous_friction", "coulomb_friction"}) {
    EXPECT_NE(std::find(found.effects.begin(), found.effects.end(), effect), found.effects.end()) << effect;
  }
  EXPECT_LT(found.after, 0.2 * found.before);
}

TEST(EffortLaw, OfARigidAxisIsPredictedToWithinItsNoise) {
  constexpr double kNoise = 0.02;
  const EffortSelection found = select_effort_law({rigid_log(kNoise)});
  EXPECT_LT(found.after, kNoise);  // of single samples; the law is compared through a cubic of 25
  EXPECT_NEAR(found.law.joint.parameters.coefficients[found.law.joint.catalogue->term("inertia").first_coefficient],
              0.05, 0.005);
}

TEST(EffortLaw, WithoutDryFrictionAndOffsetDoesNotHoldThem) {
  AxisLog log = rigid_log(0.02);
  add_effect(log, [](double /*q*/, double v) { return -0.2 - (v > 0.0 ? 0.5 : -0.5); });
  const EffortSelection found = select_effort_law({log});
  EXPECT_FALSE(found.base.joint.has("coulomb_friction"));
  EXPECT_FALSE(found.base.joint.has("offset"));
}

/// Moves of a second along half a cosine, now one way and now the other, a rest of two seconds after each. Friction of
/// 0.5 while it moves; at rest it stays, or lets go at once.
auto log_with_rests(bool holds) -> AxisLog {
  AxisLog log = rigid_log(0.0);
  std::mt19937 engine(11);
  std::normal_distribution<double> normal;
  double sign = 1.0;
  for (Eigen::Index i = 0; i < kRows; ++i) {
    const double t = kPeriodS * static_cast<double>(i);
    const auto move = static_cast<int>(t / 3.0);
    const double phase = std::min(1.0, t - 3.0 * move);
    const bool moves = phase < 1.0;
    sign = move % 2 == 0 ? 1.0 : -1.0;
    const double way = 0.5 - 0.5 * std::cos(std::numbers::pi * phase);
    const double v = moves ? sign * 0.5 * std::numbers::pi * std::sin(std::numbers::pi * phase) : 0.0;
    const double a = moves ? sign * 0.5 * std::pow(std::numbers::pi, 2) * std::cos(std::numbers::pi * phase) : 0.0;
    log.q1_rad[i] = sign > 0.0 ? way : 1.0 - way;
    log.effort[i] = 0.05 * a + 0.3 * v + (moves || holds ? 0.5 * sign : 0.0) + 0.2 + 0.02 * normal(engine);
  }
  return log;
}

TEST(EffortLaw, LetsDryFrictionGoAtRestUnlessTheLogShowsThatItHolds) {
  const EffortSelection lets_go = select_effort_law({log_with_rests(false)});
  EXPECT_GT(lets_go.law.view.letting_go_s, 0.0);
  const EffortSelection holds = select_effort_law({log_with_rests(true)});
  EXPECT_EQ(holds.law.view.letting_go_s, 0.0);
  EXPECT_LT(holds.after, 0.1);  // beside a friction of 0.5
  EXPECT_LT(lets_go.after, 0.15);
  EXPECT_GT(rigid_selection().law.view.letting_go_s, 0.0);  // it never rests
}

/// Moves of a second and a half without a jerk at either end, large and small, half a second of rest after each:
/// friction of 0.5 from the slowest creep on, none at rest.
auto log_of_gentle_moves() -> AxisLog {
  constexpr double kSizes[] = {1.0, 0.1, 0.4, 0.05};
  AxisLog log = rigid_log(0.0);
  std::mt19937 engine(13);
  std::normal_distribution<double> normal;
  double from = 0.0;
  for (Eigen::Index i = 0; i < kRows; ++i) {
    const double t = kPeriodS * static_cast<double>(i);
    const auto move = static_cast<int>(t / 2.0);
    const double size = (move / 4 % 2 == 0 ? 1.0 : -1.0) * kSizes[move % 4];
    const double s = std::min(1.0, (t - 2.0 * move) / 1.5);
    const double v = size / 1.5 * 30.0 * s * s * (1.0 - s) * (1.0 - s);
    const double a = size / 2.25 * 60.0 * s * (1.0 - s) * (1.0 - 2.0 * s);
    log.q1_rad[i] = from + size * s * s * s * (10.0 - 15.0 * s + 6.0 * s * s);
    log.effort[i] = 0.05 * a + 0.3 * v + 0.5 * std::tanh(v / 0.002) + 0.2 + 0.02 * normal(engine);
    if (static_cast<int>((t + kPeriodS) / 2.0) > move) {
      from = log.q1_rad[i];
    }
  }
  return log;
}

TEST(EffortLaw, SeesRestAsSlowAsTheLogShowsIt) {
  const AxisLog log = log_of_gentle_moves();
  const EffortView usual = usual_view({log});
  const EffortSelection found = select_effort_law({log});
  EXPECT_LT(found.law.view.standstill, 0.5 * usual.standstill);
  EXPECT_GT(found.law.view.letting_go_s, 0.0);
  EXPECT_LT(found.after, 0.08);  // beside a friction of 0.5
  EXPECT_EQ(rigid_selection().law.view.standstill, usual_view({rigid_log(0.02)}).standstill);
}

TEST(EffortLaw, FindsASpringAndSaysHowMuchBetterItPredicts) {
  AxisLog log = rigid_log(0.02);
  add_effect(log, [](double q, double /*v*/) { return 0.9 * (q - 0.1); });
  const EffortSelection found = select_effort_law({log});
  ASSERT_FALSE(found.effects.empty());
  EXPECT_EQ(found.effects.front(), "spring");
  EXPECT_EQ(found.law.status, "provisional");
  EXPECT_LT(found.after, 0.15 * found.before);
}

TEST(EffortLaw, FindsDragThatGrowsLessThanLinearly) {
  AxisLog log = rigid_log(0.02);
  add_effect(log, [](double /*q*/, double v) {
    return (v > 0.0 ? 1.0 : -1.0) * (1.5 * std::pow(std::abs(v), 0.33) - 0.5) - 0.3 * v;
  });
  const EffortSelection found = select_effort_law({log});
  ASSERT_FALSE(found.effects.empty());
  EXPECT_EQ(found.effects.front(), "power_law_friction");
  EXPECT_LT(found.after, 0.06 * found.target_rms);
}

TEST(EffortLaw, HoldsWhatAnotherJointBrings) {
  AxisLog log = rigid_log(0.02);
  SideSignal other{"axis3/q1_rad", Eigen::VectorXd(kRows)};
  for (Eigen::Index i = 0; i < kRows; ++i) {
    const double phase = 2.0 * std::numbers::pi * 0.41 * log.time_s[i];
    other.values[i] = 0.6 * std::sin(phase);
    log.effort[i] += 0.8 * 0.6 * std::sin(phase);
  }
  log.side.push_back(other);
  const EffortSelection found = select_effort_law({log});
  ASSERT_FALSE(found.effects.empty());
  EXPECT_EQ(found.effects.front(), "axis_coupling");
  EXPECT_TRUE(found.law.joint.has("axis_coupling_axis3"));
  EXPECT_LT(found.after, 0.15 * found.before);
}

/// The first joint of an upright arm of two links, its own formulas: masses at the links' ends, 1 and 0.8 kg, lengths
/// 0.3 and 0.25 m, dry friction, both joints on three sines each.
/// @param motion  another one
auto arm_log(int motion) -> AxisLog {
  AxisLog log = rigid_log(0.0);
  std::mt19937 engine(static_cast<unsigned>(31 + motion));
  std::uniform_real_distribution<double> phase(0.0, 2.0 * std::numbers::pi);
  std::normal_distribution<double> normal(0.0, 0.02);
  struct Moves {
    double q = 0.0, v = 0.0, a = 0.0;
  };
  const double phases[] = {phase(engine), phase(engine), phase(engine), phase(engine), phase(engine), phase(engine)};
  SideSignal other{"axis1/q1_rad", Eigen::VectorXd(kRows)};
  for (Eigen::Index i = 0; i < kRows; ++i) {
    Moves one;
    Moves two;
    const double sizes[] = {0.8, 0.35, 0.1, 1.1, 0.4, 0.12};
    const double rates[] = {0.21, 0.57, 1.31, 0.29, 0.71, 1.13};
    for (int k = 0; k < 6; ++k) {
      Moves& moved = k < 3 ? one : two;
      const double w = 2.0 * std::numbers::pi * rates[k];
      const double at = w * log.time_s[i] + phases[k];
      moved.q += sizes[k] * std::sin(at);
      moved.v += sizes[k] * w * std::cos(at);
      moved.a -= sizes[k] * w * w * std::sin(at);
    }
    const double ends = 0.8 * 0.3 * 0.25;
    const double both = 0.8 * 0.25 * 0.25;
    const double inertia = 1.8 * 0.3 * 0.3 + both + 2.0 * ends * std::cos(two.q);
    const double coriolis = -ends * std::sin(two.q) * (2.0 * one.v * two.v + two.v * two.v);
    const double weight = 9.81 * (1.8 * 0.3 * std::cos(one.q) + 0.8 * 0.25 * std::cos(one.q + two.q));
    log.q1_rad[i] = one.q;
    other.values[i] = two.q;
    log.effort[i] = inertia * one.a + (both + ends * std::cos(two.q)) * two.a + coriolis + weight +
                    (one.v > 0.0 ? 0.4 : -0.4) + normal(engine);
  }
  log.side = {other};
  return log;
}

TEST(EffortLaw, OfAnArmPredictsAnotherMotionByPosture) {
  const EffortSelection found = select_effort_law({arm_log(0)});
  ASSERT_TRUE(found.law.joint.has("posture_coupling_axis1"));
  EXPECT_NE(std::find(found.effects.begin(), found.effects.end(), "posture_coupling"), found.effects.end());
  const AxisLog fresh = arm_log(1);
  const Eigen::VectorXd error =
      EffortDesign({fresh}, found.law.view).seen(fresh.effort) - run_effort_law({fresh}, found.law);
  EXPECT_LT(rms(error), 0.02 * rms_about_mean(fresh.effort));
}

TEST(EffortLaw, DependsOnNoUnit) {
  AxisLog plain = rigid_log(0.02);
  add_effect(plain, [](double q, double /*v*/) { return 0.9 * q; });
  AxisLog scaled = plain;
  scaled.q1_rad *= 100.0;
  scaled.effort *= 0.01;
  const EffortSelection one = select_effort_law({plain});
  const EffortSelection other = select_effort_law({scaled});
  // The weight of a link is a matter of turns; a motor before a gear of 100 has none of its own.
  EXPECT_EQ(one.effects.front(), other.effects.front());
  EXPECT_NEAR(one.after / one.target_rms, other.after / other.target_rms, 0.1 * one.after / one.target_rms);
}

/// Torque behind a gear: 0.8 of the motor's less dry friction, the motor's channel `late_rows` late.
auto gear_log(int late_rows) -> AxisLog {
  AxisLog log = rigid_log(0.0);
  log.target = "axis0/tau_out_Nm";
  log.has_torque = true;
  const Eigen::VectorXd torque = log.effort;
  for (Eigen::Index i = 0; i < kRows; ++i) {
    const bool forward = i + 1 < kRows ? log.q1_rad[i + 1] > log.q1_rad[i] : true;
    log.effort[i] = 0.8 * torque[i] - (forward ? 0.1 : -0.1);
    log.tau_nm[i] = torque[std::max<Eigen::Index>(0, i - late_rows)];
  }
  return log;
}

TEST(GearLaw, FindsThatTheTorquesChannelIsLate) {
  EXPECT_EQ(select_effort_law({gear_log(0)}).law.view.skew_s, 0.0);
  const EffortSelection found = select_effort_law({gear_log(3)});
  EXPECT_NEAR(found.law.view.skew_s, -3.0 * kPeriodS, 0.5 * kPeriodS);
  EXPECT_LT(found.after, 0.05 * found.target_rms);
}

TEST(EffortFile, ReadsBackWhatItWrote) {
  AxisLog log = rigid_log(0.02);
  add_effect(log, [](double q, double /*v*/) { return 0.9 * q; });
  const EffortLaw law = select_effort_law({log}).law;
  const EffortLaw back = parse_effort_file(effort_file_text(law), "law.toml");
  EXPECT_EQ(back.joint.terms, law.joint.terms);
  EXPECT_EQ(back.status, law.status);
  ASSERT_TRUE(law.joint.coefficient_ci95[law.joint.catalogue->term("inertia").first_coefficient].has_value());
  EXPECT_EQ(back.joint.coefficient_ci95, law.joint.coefficient_ci95);
  EXPECT_EQ(run_effort_law({log}, back), run_effort_law({log}, law));
}

TEST(EffortFile, TargetIsWhatAColumnWasCalledInAnyLetters) {
  EffortLaw law = rigid_selection().law;
  law.target = "axis0/\u03c4_Nm \"~x41\\";
  EXPECT_EQ(parse_effort_file(effort_file_text(law), "law.toml").target, law.target);
}

TEST(EffortFile, RefusesWhatCanNotBeMeant) {
  const std::string good = effort_file_text(rigid_selection().law);
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    const auto at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
  };
  EXPECT_NO_THROW(parse_effort_file(good, "law.toml"));
  EXPECT_THROW(parse_effort_file(with("capstan.effort/1", "capstan.joint/1"), "law.toml"), BadInput);
  EXPECT_THROW(parse_effort_file(with("[terms.inertia]", "[terms.mass]"), "law.toml"), BadInput);
  EXPECT_THROW(parse_effort_file(with("\"kgm2\"", "\"kg\""), "law.toml"), BadInput);
  EXPECT_THROW(parse_effort_file(with("[terms.inertia]", "[terms.inertia]\nmas = 1"), "law.toml"), BadInput);
  EXPECT_THROW(parse_effort_file(with("[law]", "[rule]"), "law.toml"), BadInput);
  EXPECT_THROW(parse_effort_file(with("family = \"effort\"", "family = \"force\""), "law.toml"), BadInput);
  EXPECT_THROW(parse_effort_file(with("window = { value = 0.12", "window = { value = 120"), "law.toml"), BadInput);
  EXPECT_THROW(parse_effort_file(with("skew = { value = 0", "skew = { value = nan"), "law.toml"), BadInput);
  EXPECT_THROW(parse_effort_file(with("letting_go = { value = 0", "letting_go = { value = -0"), "law.toml"), BadInput);
  EXPECT_EQ(parse_effort_file(with("\nletting_go", "\n# letting_go"), "law.toml").view.letting_go_s,
            0.0);  // older files
  EXPECT_THROW(parse_effort_file(with("[conditioner]", "[conditioner"), "law.toml"), BadInput);
}

TEST(EffortReplay, NamesTheEstimateAsTheContractDoes) {
  EXPECT_EQ(estimate_column("axis0/tau_Nm"), "axis0/tau_est_Nm");
  EXPECT_EQ(estimate_column("axis2/tau_N"), "axis2/tau_est_N");
  EXPECT_EQ(estimate_column("axis1/tau_out_Nm"), "axis1/tau_out_est_Nm");
}

}  // namespace
}  // namespace capstan::tools
