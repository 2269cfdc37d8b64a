// SPDX-License-Identifier: Apache-2.0
// Experiments from the shell: the motion that was asked for, its log, and every way in which it ends early.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "capstan/firmware/console/shell_experiment.hpp"
#include "capstan/firmware/console/shell_input.hpp"
#include "capstan/tests/firmware/support.hpp"

namespace capstan {
namespace {

using Bench = test::Bench<2>;
using test::has_line;
using test::lines_of;
using test::verdict;

struct Row {
  double time_s, q1, tau, q2, reference, current;
};

auto row_of(const std::string& line) -> Row {
  Row row{};
  EXPECT_EQ(std::sscanf(line.c_str(), "%lf,%lf,%lf,%lf,%lf,%lf", &row.time_s, &row.q1, &row.tau, &row.q2,
                        &row.reference, &row.current),
            6)
      << line;
  return row;
}

struct Log {
  std::string header;
  std::vector<Row> rows;
  std::string verdict;
};

/// Lets time pass until the answer is there, or for so many cycles.
auto answer(Bench& bench, int most = 2'000'000) -> std::string {
  for (int i = 0; i < most && bench.shell.busy(); ++i) {
    bench.application.rt_tick();
    bench.shell.poll();
  }
  return bench.sink.take();
}
void type(Bench& bench, const std::string& line) {
  for (const char c : line + "\n") {
    bench.shell.receive(c);
  }
}

auto experiment(Bench& bench, const std::string& line) -> Log {
  type(bench, line);
  const auto lines = lines_of(answer(bench));
  Log log;
  log.verdict = lines.back();
  if (lines.size() > 1) {
    log.header = lines.front();
    for (std::size_t i = 1; i + 1 < lines.size(); ++i) {
      if (lines[i].find_first_not_of("0123456789.,-") == std::string::npos) {
        log.rows.push_back(row_of(lines[i]));
      }
    }
  }
  return log;
}

TEST(ShellExperiment, ASineLadderRunsItsRungsAndStreamsALogByTheContract) {
  Bench bench;
  bench.say("arm");
  const Log log = experiment(
      bench, "experiment joint1 sine_ladder amplitude=0.2rad frequencies=0.4,0.8Hz cycles=2 repeats=2 every=5");
  EXPECT_EQ(log.verdict, "ok");
  EXPECT_EQ(log.header, "time_s,axis1/q1_rad,axis1/tau_Nm,axis1/q2_est_rad,axis1/q2_ref_rad,axis1/current_A");
  // Three periods of each, envelope included: 7.5 s and 3.75 s, twice.
  ASSERT_NEAR(static_cast<double>(log.rows.size()), 22'500.0 / 5.0, 2.0);
  double largest = 0.0;
  for (std::size_t i = 0; i < log.rows.size(); ++i) {
    if (i > 0) {
      EXPECT_NEAR(log.rows[i].time_s - log.rows[i - 1].time_s, 0.005, 1e-9);
    }
    largest = std::max(largest, std::fabs(log.rows[i].reference));
    EXPECT_NEAR(log.rows[i].q1, log.rows[i].reference, 0.03) << "the rigid joint follows";
  }
  EXPECT_NEAR(largest, 0.2, 0.002);
  for (std::size_t i = 0; i + 2250 < log.rows.size(); ++i) {
    EXPECT_NEAR(log.rows[i].reference, log.rows[i + 2250].reference, 0.008) << "the second repeat is the first again";
  }
  EXPECT_EQ(bench.state(), State::kHolding);
}

TEST(ShellExperiment, ASpeedLadderRunsEachSpeedBothWays) {
  Bench bench;
  bench.say("arm");
  const Log log = experiment(
      bench, "experiment joint0 speed_ladder amplitude=0.4 offset=0.1 speeds=0.2,0.8 cycles=2 repeats=1 every=1");
  EXPECT_EQ(log.verdict, "ok");
  std::array<int, 4> at{};  // samples at -0.8, -0.2, 0.2, 0.8 rad/s
  for (std::size_t i = 1; i < log.rows.size(); ++i) {
    const double speed = (log.rows[i].reference - log.rows[i - 1].reference) * 1e3;
    at[0] += std::fabs(speed + 0.8) < 1e-3;
    at[1] += std::fabs(speed + 0.2) < 1e-3;
    at[2] += std::fabs(speed - 0.2) < 1e-3;
    at[3] += std::fabs(speed - 0.8) < 1e-3;
    EXPECT_LE(std::fabs(log.rows[i].reference - 0.1), 0.4 + 1e-6);
  }
  // Each way 1.6 rad at each speed, less the corners: 2 to 8 s, and 1 to 2 s.
  EXPECT_NEAR(at[1], 8000, 250);
  EXPECT_NEAR(at[2], 8000, 250);
  EXPECT_NEAR(at[0], 1600, 400);
  EXPECT_NEAR(at[3], 1600, 400);
}

TEST(ShellExperiment, ReversalsClimbFromTheLowerEndLevelByLevel) {
  Bench bench;
  bench.say("arm");
  const Log log = experiment(bench, "experiment joint0 reversals amplitude=0.4 speeds=1 levels=4 repeats=1 every=1");
  EXPECT_EQ(log.verdict, "ok");
  std::vector<double> turns;
  double direction = -1.0;
  for (std::size_t i = 1; i < log.rows.size(); ++i) {
    const double step = log.rows[i].reference - log.rows[i - 1].reference;
    if (step * direction < 0.0) {
      turns.push_back(log.rows[i - 1].reference);
      direction = -direction;
    }
  }
  const std::vector<double> wanted = {-0.4, -0.2, -0.4, 0.0, -0.4, 0.2, -0.4};
  ASSERT_GE(turns.size(), wanted.size());
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    EXPECT_NEAR(turns[i], wanted[i], 1e-5) << i;
  }
  EXPECT_NEAR(log.rows.back().reference, 0.0, 1e-5);
}

TEST(ShellExperiment, EveryRecipeRunsWithNothingButItsName) {
  for (const char* recipe : {"sine_ladder", "multisine", "decaying_sine", "triangle", "speed_ladder", "reversals"}) {
    Bench bench;
    bench.say("arm");
    const Log log = experiment(bench, std::string("experiment joint0 ") + recipe);
    EXPECT_EQ(log.verdict, "ok") << recipe;
    EXPECT_GT(log.rows.size(), 1000U) << recipe;
    bench.ticks(100);
    EXPECT_EQ(bench.state(), State::kHolding) << recipe;
  }
}

TEST(ShellExperiment, TheStateIsExperimentWhileItRunsAndTheOtherJointHolds) {
  Bench bench;
  bench.say("arm");
  type(bench, "experiment joint1 triangle");
  bench.ticks(2000);
  EXPECT_EQ(bench.state(), State::kExperiment);
  EXPECT_NEAR(bench.io.motors[0].angle_rad, 0.0, 1e-3);
  EXPECT_TRUE(bench.shell.busy());
}

TEST(ShellExperiment, WithoutTorqueInMotionOrWithWrongOptionsNothingMoves) {
  Bench bench;
  const auto refused = [&bench](const std::string& line, const std::string& name) {
    const std::string text = bench.say(line);
    EXPECT_EQ(verdict(text).rfind("error " + name + ": ", 0), 0U) << line << ": " << text;
    EXPECT_EQ(lines_of(text).size(), 1U) << "no header for a log that does not come: " << text;
  };
  refused("experiment joint0 triangle", "not_holding");
  bench.say("arm");
  bench.say("move joint1 1");
  refused("experiment joint0 triangle", "not_holding");
  bench.ticks(2000);
  refused("experiment joint2 triangle", "unknown_joint");
  refused("experiment triangle", "unknown_joint");
  refused("experiment joint0", "unknown_recipe");
  refused("experiment joint0 sine", "unknown_recipe");
  for (const char* option : {"amplitude",
                             "amplitude=",
                             "amplitude=x",
                             "amplitude=0.1Nm",
                             "amplitude=1e9",
                             "frequencies=1",
                             "speeds=",
                             "speeds=,",
                             "speeds=1,2,3,4,5,6,7,8,9",
                             "speeds=1Hz",
                             "cycles=0",
                             "cycles=1.5",
                             "cycles=1001",
                             "every=0",
                             "levels=4",
                             "duration=20",
                             "decay=1",
                             "colour=red",
                             "=",
                             "amplitude=0.1=0.2"}) {
    refused(std::string("experiment joint0 triangle ") + option, "option");
  }
  refused("experiment joint0 triangle amplitude=2.5", "range");
  refused("experiment joint0 triangle speeds=3", "range");
  refused("experiment joint0 sine_ladder frequencies=5", "range");
  refused("experiment joint0 decaying_sine decay=-1", "range");
  refused("experiment joint0 triangle amplitude=0.2 cycles=1 amplitude=0.3", "option");
  refused("experiment joint0 triangle amplitude=0.2 amplitude=0.2", "option");
  EXPECT_EQ(bench.state(), State::kHolding);
  EXPECT_NEAR(bench.io.motors[0].angle_rad, 0.0, 1e-3);
}

// What the machine refuses though the shell did not.
TEST(ShellExperiment, ARefusalOfTheMachineIsTheAnswerAndTheRecorderIsFreeAgain) {
  Bench bench;
  bench.say("arm");
  const ExperimentSetup wrong{
      .recipe = Recipe::kTriangle, .amplitude = Q24::from_int(3), .rungs = {Q24::from_double(0.4)}, .rung_count = 1};
  RecorderSetup recorded;
  choose_signals(recorded, 0, std::array<std::string_view, 1>{"q1"});
  ASSERT_TRUE(bench.application.recorder().start(&bench.shell, recorded));
  EXPECT_FALSE(hand_over(bench.shell, wrong));
  bench.application.rt_tick();
  bench.shell.poll();
  EXPECT_EQ(bench.sink.take(),
            "error range: nothing moved, because the motion leaves limits.joint_min to limits.joint_max; lower the "
            "amplitude or move the offset\r\n");
  EXPECT_EQ(bench.application.telemetry().state, State::kHolding);
  EXPECT_EQ(experiment(bench, "experiment joint0 triangle").verdict, "ok");
}

TEST(ShellExperiment, AnyFaultEndsItTakesTheTorqueAndIsNamed) {
  for (int fault = 0; fault < 4; ++fault) {
    Bench bench;
    bench.say("arm");
    type(bench, "experiment joint0 triangle");
    for (int i = 0; i < 2000; ++i) {
      bench.ticks(1);
      bench.shell.poll();
    }
    ASSERT_EQ(bench.state(), State::kExperiment);
    bench.io.estop = fault == 0;
    bench.io.encoder = fault == 1 ? Quality::kMissing : Quality::kOk;
    bench.io.blocked = fault == 2;
    bench.io.write_status = fault == 3 ? Status::kFailed : Status::kOk;
    const std::string text = answer(bench, 5000);
    EXPECT_FALSE(bench.shell.busy()) << fault;
    EXPECT_EQ(verdict(text).rfind("error aborted: ", 0), 0U) << text.substr(text.size() - 300);
    EXPECT_TRUE(has_line(text, std::string("ended by ") + info(bench.application.telemetry().first_fault).name));
    EXPECT_FALSE(bench.io.has_torque()) << fault;
    EXPECT_EQ(bench.state(), State::kFaulted) << fault;
  }
}

TEST(ShellExperiment, CancelHoldsTheJointADisarmTakesTorqueAndALostLinkDoesToo) {
  const auto running = [](Bench& bench) {
    bench.say("arm");
    type(bench, "experiment joint0 triangle");
    for (int i = 0; i < 2000; ++i) {
      bench.ticks(1);
      bench.shell.poll();
    }
  };
  {
    Bench bench;
    running(bench);
    bench.shell.receive(0x03);
    EXPECT_EQ(verdict(answer(bench, 1000)).rfind("error aborted: ", 0), 0U);
    bench.ticks(500);
    EXPECT_EQ(bench.state(), State::kHolding);
    EXPECT_EQ(verdict(bench.say("move joint0 0.1")), "ok");
  }
  {
    Bench bench;
    running(bench);
    ShellInput input(bench.shell);
    for (const char c : std::string("disarm\n")) {
      input.take(c);
    }
    bench.ticks(3);
    EXPECT_FALSE(bench.io.has_torque());
    for (int i = 0; i < 100; ++i) {
      bench.ticks(1);
      input.poll();
    }
    EXPECT_EQ(verdict(bench.sink.take()), "ok") << "of the disarm";
  }
  {
    Bench bench;
    running(bench);
    bench.application.link_lost();
    bench.ticks(2);
    EXPECT_FALSE(bench.io.has_torque());
    EXPECT_EQ(verdict(answer(bench, 1000)).rfind("error aborted: ", 0), 0U);
  }
}

TEST(ShellExperiment, AfterOneAnotherOneRuns) {
  Bench bench;
  bench.say("arm");
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(experiment(bench, "experiment joint0 triangle cycles=1 repeats=1").verdict, "ok");
  }
}

TEST(ShellPalpate, PressesWithTorqueTrianglesAndNamesTheSite) {
  Bench bench;
  bench.io.blocked = true;
  bench.say("arm");
  const std::string line = "palpate joint0 site=7 amplitude=100mNm rates=0.2 cycles=2 every=1";
  type(bench, line);
  auto lines = lines_of(answer(bench));
  EXPECT_EQ(lines.back(), "ok");
  EXPECT_EQ(lines.front().rfind("# no stiffness will be reported: ", 0), 0U);  // there is no force law
  lines.erase(lines.begin());
  EXPECT_EQ(lines.front(), "time_s,site,axis0/q1_rad,axis0/tau_Nm,axis0/q2_est_rad,axis0/q2_ref_rad,axis0/current_A");
  double largest = 0.0;
  double smallest = 0.0;
  double fastest = 0.0;
  double last = 0.0;
  int peaks = 0;
  for (std::size_t i = 1; i + 1 < lines.size(); ++i) {
    double time = 0.0, q1 = 0.0, tau = 0.0;
    int site = 0;
    ASSERT_EQ(std::sscanf(lines[i].c_str(), "%lf,%d,%lf,%lf", &time, &site, &q1, &tau), 4) << lines[i];
    EXPECT_EQ(site, 7);
    peaks += (tau > 0.0999) && (last <= 0.0999);
    fastest = i > 1 ? std::max(fastest, std::fabs(tau - last) * 1e3) : 0.0;
    last = tau;
    largest = std::max(largest, tau);
    smallest = std::min(smallest, tau);
  }
  EXPECT_NEAR(largest, 0.1, 1e-4);
  EXPECT_NEAR(smallest, -0.1, 1e-4);
  EXPECT_NEAR(fastest, 0.2, 0.01);
  EXPECT_EQ(peaks, 2);
  // 0 to 0.1, twice down and up by 0.2, and back: 8 * 0.1 / 0.2 s.
  EXPECT_NEAR(static_cast<double>(lines.size()), 4000.0, 10.0);
  EXPECT_EQ(bench.state(), State::kHolding);
}

TEST(ShellPalpate, PressesBetweenAPreloadAndAPeakWhereAnOffsetIsGiven) {
  Bench bench;
  bench.io.blocked = true;
  bench.say("arm");
  type(bench, "palpate joint0 offset=40mNm amplitude=0.06Nm rates=0.2 cycles=2 every=1");
  const auto lines = lines_of(answer(bench));
  EXPECT_EQ(lines.back(), "ok");
  double largest = -1.0;
  double smallest = 1.0;
  double last = 0.0;
  for (const std::string& line : lines) {
    double time = 0.0, q1 = 0.0, tau = 0.0;
    if (std::sscanf(line.c_str(), "%lf,%lf,%lf", &time, &q1, &tau) == 3) {
      largest = std::max(largest, tau);
      smallest = std::min(smallest, tau);
      last = tau;
    }
  }
  EXPECT_NEAR(largest, 0.1, 1e-4);
  EXPECT_NEAR(smallest, -0.02, 1e-4);
  EXPECT_NEAR(last, 0.04, 1e-3) << "it ends where it goes to and fro about";
  type(bench, "palpate joint0 offset=-100Nm amplitude=0.06Nm");
  EXPECT_EQ(verdict(answer(bench)).rfind("error range: nothing moved, because the torque needs more", 0), 0U);
  type(bench, "palpate joint0 offset=0.1rad");
  EXPECT_EQ(verdict(answer(bench)).rfind("error option: ", 0), 0U) << "of a torque";
}

TEST(ShellPalpate, AFreeJointThatRunsAwayIsHeldAndTheAnswerSaysSo) {
  Bench bench;
  bench.io.drag_nms = 1e-4;
  bench.say("arm");
  type(bench, "palpate joint0 amplitude=0.1 rates=1");
  const std::string text = answer(bench, 20'000);
  EXPECT_EQ(verdict(text).rfind("error aborted: ", 0), 0U) << verdict(text);
  bench.ticks(1000);
  EXPECT_EQ(bench.state(), State::kHolding);
  EXPECT_LT(std::fabs(bench.io.motors[0].angle_rad), 2.0);
  EXPECT_LT(std::fabs(bench.io.motors[0].speed_rad_s), 0.05);
}

TEST(ShellExperiment, TheExampleOfARefusalIsItselfTaken) {
  for (const char* recipe : {"sine_ladder", "multisine", "speed_ladder", "torque_triangle"}) {
    Bench bench;
    bench.say("maintenance open");
    bench.say("arm");
    const std::string order = std::string("experiment joint0 ") + recipe;
    const std::string refusal = bench.say(order + " cycles=-1");
    const std::size_t begin = refusal.find("write '") + 7;
    const std::string example = refusal.substr(begin, refusal.find('\'', begin) - begin);
    ASSERT_EQ(example.rfind("amplitude=", 0), 0U) << refusal;
    const std::string answer = bench.say(order + " " + example);
    EXPECT_EQ(answer.find("error option"), std::string::npos) << order << " " << example << ": " << answer;
    EXPECT_EQ(answer.find("error range"), std::string::npos) << order << " " << example << ": " << answer;
  }
}

}  // namespace
}  // namespace capstan
