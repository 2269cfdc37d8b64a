// SPDX-License-Identifier: Apache-2.0
// Force laws identified from the simulated instrument, and from relays: what comes out is what went in.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "capstan/tests/model/relays.hpp"
#include "capstan/tests/model/support.hpp"
#include "capstan/tests/tools/run/by_hand.hpp"
#include "capstan/tests/tools/run/recipe_log.hpp"
#include "capstan/tools/identify/force_section.hpp"
#include "capstan/tools/jobs/identify_job.hpp"
#include "capstan/tools/joint_file/joint_file.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/random.hpp"

namespace capstan::tools {
namespace {

using test::record;
using test::triangle;
using test::turn_by_hand;

auto find(const ForceFit& fit, const std::string& name) -> ForceParameter {
  for (const auto& parameter : fit.parameters) {
    if (parameter.name == name) {
      return parameter;
    }
  }
  ADD_FAILURE() << "no parameter " << name;
  return {};
}
void expect_covers(const ForceFit& fit, const std::string& name, double truth) {
  const auto parameter = find(fit, name);
  EXPECT_LT(std::abs(parameter.value - truth), parameter.half_interval) << name << " is " << parameter.value;
  EXPECT_LT(parameter.half_interval, 0.02 * truth) << name;
}

TEST(PullPushFit, RecipesGiveThePlantsNumbersBack) {
  const sim::PlantParameters plant;
  for (const char* recipe : {"recipe_pull_push.toml", "recipe_torque_triangle.toml"}) {
    SCOPED_TRACE(recipe);
    const PullPushFit fit = fit_pull_push({record(recipe)});
    EXPECT_TRUE(fit.undetermined.empty());
    EXPECT_NEAR(fit.law.eta_top, plant.eta_top, 0.005 * plant.eta_top);
    EXPECT_NEAR(fit.law.eta_bottom, plant.eta_bottom, 0.005 * plant.eta_bottom);
    const double r1 = plant.input_radius_m;
    expect_covers(fit, "eta_top", plant.eta_top);
    expect_covers(fit, "eta_bottom", plant.eta_bottom);
    expect_covers(fit, "pretension", plant.pretension_n * r1);
    expect_covers(fit, "ratio", plant.output_radius_m / r1);
    EXPECT_NEAR(find(fit, "stiffness_top").value, plant.stiffness_top_n_per_m * r1 * r1, 0.005 * 0.3425);
    EXPECT_NEAR(find(fit, "stiffness_bottom").value, plant.stiffness_bottom_n_per_m * r1 * r1, 0.005 * 0.3436);
    EXPECT_NEAR(fit.friction_nm, plant.motor_coulomb_nm, 2e-4);
    EXPECT_LT(fit.rmse_nm, 0.08 * fit.full_scale_nm);
  }
}

TEST(PullPushFit, OtherInstrumentComesBackToo) {
  sim::PlantParameters plant;
  plant.environment.kind = sim::EnvironmentKind::kLocked;
  plant.eta_top = 0.6;
  plant.eta_bottom = 0.9;
  plant.pretension_n = 15.0;
  plant.output_radius_m = 4.0e-3;
  const PullPushFit fit = fit_pull_push({turn_by_hand(plant, 60.0, triangle(0.2, 0.05))});
  EXPECT_TRUE(fit.undetermined.empty());
  EXPECT_NEAR(fit.law.eta_top, 0.6, 0.02 * 0.6);
  EXPECT_NEAR(fit.law.eta_bottom, 0.9, 0.02 * 0.9);
  EXPECT_NEAR(fit.law.ratio, 4.0 / 2.6, 0.02 * 4.0 / 2.6);
  EXPECT_NEAR(fit.law.pretension_nm, 15.0 * 2.6e-3, 0.02 * 15.0 * 2.6e-3);
}

TEST(PullPushFit, TriangleTooSmallForSlackTendonsLeavesFrictionUndetermined) {
  sim::PlantParameters plant;
  plant.environment.kind = sim::EnvironmentKind::kLocked;
  const PullPushFit fit = fit_pull_push({turn_by_hand(plant, 60.0, triangle(0.09, 0.05))});
  const auto names = fit.undetermined;
  EXPECT_NE(std::find(names.begin(), names.end(), "pretension"), names.end());
  EXPECT_NE(std::find(names.begin(), names.end(), "stiffness_top"), names.end());
  EXPECT_NE(std::find(names.begin(), names.end(), "stiffness_bottom"), names.end());
  EXPECT_FALSE(fit.cure.empty());
}

TEST(PullPushFit, LogThatPullsOneWayIsRefused) {
  sim::PlantParameters plant;
  plant.environment.kind = sim::EnvironmentKind::kLocked;
  EXPECT_THROW(static_cast<void>(fit_pull_push({turn_by_hand(plant, 5.0, [](double t) { return 0.04 * t; })})),
               Refusal);
}

TEST(PreisachFit, RecipeGivesALawThatFollowsAnotherMotionOfTheSameJoint) {
  const PreisachFit fit = fit_preisach({record("recipe_preisach.toml")});
  EXPECT_TRUE(fit.undetermined.empty());
  EXPECT_TRUE(check(fit.table, 1e-9).ok());
  EXPECT_LT(fit.rmse_nm, 0.02 * fit.full_scale_nm);

  sim::PlantParameters plant;
  plant.environment = {.kind = sim::EnvironmentKind::kSpring, .stiffness = 0.5};
  const capstan::test::RandomMultisine motion(8, 1.0, 0.03, 0.3);
  const AxisLog other =
      turn_by_hand(plant, 60.0, [&](double t) { return 0.3 * std::tanh(2.0 * motion(t) + std::sin(0.4 * t)); });
  Preisach<double, kMostPreisachLevels> law(fit.table, StartState::kDemagnetised, 1e-9);
  double squares = 0.0;
  for (Eigen::Index i = 0; i < other.samples(); ++i) {
    // The recipe's torque has the motor's friction in it, 0.003 N m, and this one has not: it is added by direction.
    const double rate = i > 0 ? other.q1_rad[i] - other.q1_rad[i - 1] : 0.0;
    const double force =
        law.update(other.tau_nm[i] + (rate > 0.0 ? plant.motor_coulomb_nm : -plant.motor_coulomb_nm)).force;
    squares += std::pow(force - other.effort[i], 2.0);
  }
  const double share = std::sqrt(squares / static_cast<double>(other.samples())) / fit.full_scale_nm;
  std::printf("Preisach law on a motion it has not seen: %.2f %% of full scale\n", 100.0 * share);
  EXPECT_LT(share, 0.05);  // loops are congruent to 10 % only: capstan friction goes with the tension
}

constexpr double kRelayNoise = 2e-4;  // of the joint torque, N m

/// A joint made of 40 x 40 relays, its input in N m.
auto relay_log(double amplitude, double seconds, std::uint32_t seed) -> AxisLog {
  capstan::test::Relays relays(40);
  const capstan::test::RandomMultisine motion(seed, 2.0, 0.05, 0.5);
  const auto samples = static_cast<Eigen::Index>(seconds * 100.0);
  AxisLog log;
  log.name = "relays";
  for (auto* values : {&log.time_s, &log.q1_rad, &log.tau_nm, &log.effort}) {
    values->resize(samples);
  }
  Random random(seed);
  for (Eigen::Index i = 0; i < samples; ++i) {
    const double t = 0.01 * static_cast<double>(i);
    const double start = t < 4.0 ? -std::cos(std::numbers::pi * t / 2.0) : 0.0;  // one swing to both ends
    const double u = std::clamp(t < 4.0 ? 5.0 * start : amplitude * motion(t) * 3.0, -5.0, 5.0);
    log.time_s[i] = t;
    log.q1_rad[i] = 0.1 * u;
    log.tau_nm[i] = 0.01 * u;
    log.effort[i] = 0.01 * relays.update(u) + kRelayNoise * random.normal();
  }
  return log;
}

TEST(PreisachFit, ArbitraryMotionGivesTheTableOfTheRelaysItVisits) {
  const PreisachFit fit = fit_preisach({relay_log(5.0, 600.0, 9)});
  const auto truth = capstan::test::Relays(40).table<41>(41);
  Preisach<double, 41> exact(truth, StartState::kNegativeSaturation, 1e-9);
  double worst = 0.0;
  int determined = 0;
  for (std::size_t a = 0; a < kPreisachLevels; ++a) {
    for (std::size_t b = 0; b <= a; ++b) {
      exact.update(-5.0);
      exact.update(100.0 * fit.table.inputs[a]);
      const double force = 0.01 * exact.update(100.0 * fit.table.inputs[b]).force;
      const std::size_t i = ReversalTable<double, kPreisachLevels>::index(a, b);
      if (std::isfinite(fit.half_intervals[i])) {
        ++determined;
        worst = std::max(worst, std::abs(fit.table.force(a, b) - force));
      }
    }
  }
  std::printf("table from arbitrary motion: %d of 66 values, worst %.2f %% of full scale\n", determined,
              100.0 * worst / fit.full_scale_nm);
  EXPECT_GT(determined, 55);
  EXPECT_LT(worst, 0.03 * fit.full_scale_nm);  // a grid of 11 over relays of 40 errs by 1 %
}

/// Root mean square on a motion that took no part, share of full scale, without the noise of that log.
auto error_on(const PreisachFit& fit, const AxisLog& other) -> double {
  Preisach<double, kMostPreisachLevels> law(fit.table, StartState::kNegativeSaturation, 1e-9);
  double squares = 0.0;
  long known = 0;
  for (Eigen::Index i = 0; i < other.samples(); ++i) {
    const auto estimate = law.update(other.tau_nm[i]);
    squares += estimate.known ? std::pow(estimate.force - other.effort[i], 2.0) : 0.0;
    known += estimate.known ? 1 : 0;
  }
  const double without_noise = squares / static_cast<double>(known) - kRelayNoise * kRelayNoise;
  return std::sqrt(std::max(0.0, without_noise)) / fit.full_scale_nm;
}

/// All that bends lies in a fifth of the range.
auto squeezed_log(double amplitude, double seconds, std::uint32_t seed) -> AxisLog {
  AxisLog log = relay_log(amplitude, seconds, seed);
  log.tau_nm = log.tau_nm.unaryExpr([](double tau) { return tau + 0.2 * std::pow(tau / 0.05, 5.0); });
  return log;
}

TEST(PreisachFit, MoreLevelsErrLess) {
  const AxisLog learned = squeezed_log(5.0, 600.0, 31);
  const AxisLog other = squeezed_log(4.0, 200.0, 32);
  const double coarse = error_on(fit_preisach({learned}, {9, false}), other);
  const PreisachFit fit = fit_preisach({learned}, {21, false});
  EXPECT_EQ(fit.table.levels, 21U);
  EXPECT_EQ(fit.half_intervals.size(), 231U);
  EXPECT_LT(error_on(fit, other), 0.6 * coarse);
}

TEST(PreisachFit, LevelsGoWhereTheJointBends) {
  const AxisLog learned = squeezed_log(5.0, 600.0, 33);
  const AxisLog other = squeezed_log(4.0, 200.0, 34);
  const PreisachFit even = fit_preisach({learned}, {9, false});
  const PreisachFit chosen = fit_preisach({learned}, {9, true});
  ASSERT_EQ(chosen.table.levels, 9U);
  EXPECT_EQ(chosen.table.inputs[0], even.table.inputs[0]);
  EXPECT_EQ(chosen.table.inputs[8], even.table.inputs[8]);
  EXPECT_TRUE(check(chosen.table, 1e-9).ok());
  std::printf("9 levels, another motion: even %.2f %%, chosen %.2f %% of full scale\n", 100.0 * error_on(even, other),
              100.0 * error_on(chosen, other));
  EXPECT_LT(error_on(chosen, other), 0.6 * error_on(even, other));
}

TEST(PreisachFit, MotionThatNeverNestsLoopsLeavesTheInsideUndetermined) {
  AxisLog log = relay_log(0.0, 20.0, 10);
  const PreisachFit fit = fit_preisach({log});
  EXPECT_GT(fit.undetermined.size(), 30U);
  EXPECT_NE(fit.undetermined.front().find("f("), std::string::npos);
  EXPECT_FALSE(fit.cure.empty());
}

TEST(ForceSection, ReplacesItselfAndLeavesTheRestOfAJointFileAlone) {
  const std::string before = joint_file_text([] {
    JointFile joint;
    joint.terms = {"motor_angle"};
    return joint;
  }());
  PullPushFit pull_push;
  pull_push.parameters = {{"eta_top", "1", 1.1414, 0.01}};
  PreisachFit preisach;
  preisach.table = capstan::test::Relays(20).table<kMostPreisachLevels>(kPreisachLevels);
  preisach.half_intervals.assign(preisach.table.forces.size(), 0.001);
  const std::string once = with_force_section(before, force_section(preisach));
  const std::string twice = with_force_section(once, force_section(pull_push));
  EXPECT_EQ(twice.substr(0, before.size()), before);
  EXPECT_NE(twice.find("model = \"pull_push\""), std::string::npos);
  EXPECT_EQ(twice.find("preisach"), std::string::npos);
  EXPECT_EQ(twice, with_force_section(twice, force_section(pull_push)));
  for (const auto& text : {once, twice}) {
    EXPECT_EQ(joint_file_text(parse_joint_file(text, "joint.toml")), before);
  }
  EXPECT_THROW(static_cast<void>(parse_joint_file(with_force_section("", force_section(pull_push)), "f.toml")),
               BadInput)
      << "a force law alone is no motion law";
}

TEST(ForceLog, RefusesWhatCanNotBeFittedWithACure) {
  const auto sentence = [](const std::string& text) -> std::string {
    try {
      static_cast<void>(read_force_log(CsvLog::parse(text, "x.csv"), 0));
    } catch (const BadInput& error) {
      return error.what();
    }
    return "";
  };
  const std::string header = "time_s,axis0/q1_rad,axis0/tau_Nm,axis0/tau_out_Nm\n";
  std::string still = header;
  for (int i = 0; i < 300; ++i) {
    still += "0." + std::to_string(1000 + i) + ",0." + std::to_string(1000 + i) + ",0." + std::to_string(1000 + i) +
             ",0.5\n";
  }
  EXPECT_NE(sentence("time_s,axis0/q1_rad,axis0/tau_Nm\n0,0,0\n1,1,1\n").find("axis0/tau_out_Nm"), std::string::npos);
  EXPECT_NE(sentence(header + "0,0,0,0\n1,1,1,1\n").find("too few"), std::string::npos);
  EXPECT_NE(sentence(still).find("does not change"), std::string::npos);
}

auto identified_from(const AxisLog& log, const std::string& model, std::string* said) -> ForceFit {
  const JobLogs logs = {.files = {CsvLog::parse(test::csv_of(log), "log.csv")}, .coupled_to = {}};
  return identify_force(logs, model, [said](const std::string& warning) { *said += warning + "\n"; }).fit;
}

TEST(ForceLog, AChannelThatCanNotBeWhatItClaimsIsNamedAndWildValuesMoveNoLaw) {
  sim::PlantParameters plant;
  plant.environment.kind = sim::EnvironmentKind::kLocked;
  const AxisLog clean = turn_by_hand(plant, 40.0, triangle(0.25, 0.05));
  std::string said;
  const ForceFit law = identified_from(clean, "pull_push", &said);
  EXPECT_EQ(said, "");
  AxisLog wild = clean;
  test::make_wild(wild.effort);
  AxisLog held = clean;
  test::hold(held.tau_nm);
  for (const std::string model : {"pull_push", "blend", "preisach"}) {
    said.clear();
    const ForceFit found = identified_from(wild, model, &said);
    EXPECT_NE(said.find("axis0/tau_out_Nm stands out from both neighbours"), std::string::npos) << model << said;
    if (model == "pull_push") {
      EXPECT_NEAR(find(found, "eta_top").value, find(law, "eta_top").value, 0.01);
      EXPECT_LT(found.rmse_nm, 1.1 * law.rmse_nm);
    }
    said.clear();
    static_cast<void>(identified_from(held, model, &said));
    EXPECT_NE(said.find("axis0/tau_Nm has a new value only every 10"), std::string::npos) << model << said;
  }
}

}  // namespace
}  // namespace capstan::tools
