// SPDX-License-Identifier: Apache-2.0
// Frequency responses from the shell: what is logged, what is refused, and every way in which one ends early.
#include <gtest/gtest.h>

#include <cmath>

#include "capstan/firmware/console/shell_input.hpp"
#include "capstan/tests/firmware/support.hpp"

namespace capstan {
namespace {

using Bench = test::Bench<2>;
using test::has_line;
using test::lines_of;
using test::verdict;

void type(Bench& bench, const std::string& line) {
  for (const char c : line + "\n") {
    bench.shell.receive(c);
  }
}
auto answer(Bench& bench, int most = 700'000) -> std::string {
  for (int i = 0; i < most && bench.shell.busy(); ++i) {
    bench.application.rt_tick();
    bench.shell.poll();
  }
  return bench.sink.take();
}

struct Row {
  double time_s, q1, torque, q2, reference, current, excitation;
};
struct Log {
  std::string header, verdict;
  std::vector<Row> rows;
};
auto respond(Bench& bench, const std::string& line) -> Log {
  type(bench, line);
  const auto lines = lines_of(answer(bench));
  Log log{.header = lines.front(), .verdict = lines.back(), .rows = {}};
  for (const std::string& text : lines) {
    Row row{};
    if (std::sscanf(text.c_str(), "%lf,%lf,%lf,%lf,%lf,%lf,%lf", &row.time_s, &row.q1, &row.torque, &row.q2,
                    &row.reference, &row.current, &row.excitation) == 7) {
      log.rows.push_back(row);
    }
  }
  return log;
}

TEST(ShellResponse, AMultisineOnTheTorqueIsLoggedInEveryCycleBesideWhatItShakes) {
  Bench bench;
  bench.say("arm");
  const Log log = respond(bench, "experiment joint1 multisine on=torque amplitude=5mNm from=1Hz to=100Hz duration=8");
  EXPECT_EQ(log.verdict, "ok");
  EXPECT_EQ(log.header,
            "time_s,axis1/q1_rad,axis1/tau_cmd_Nm,axis1/q2_est_rad,axis1/q2_ref_rad,axis1/current_A,axis1/tau_exc_Nm");
  ASSERT_EQ(log.rows.size(), 4U * 2048U + 1U) << "the cycle before and whole periods, not a row lost";
  double largest = 0.0;
  for (std::size_t i = 1; i < log.rows.size(); ++i) {
    ASSERT_NEAR(log.rows[i].time_s - log.rows[i - 1].time_s, 0.001, 1e-9);
    largest = std::max(largest, std::fabs(log.rows[i].excitation));
  }
  EXPECT_NEAR(largest, 0.005, 5e-5);
  // The bench's own motor, driven by what the log says was told, goes where the log says it went: a count is 0.15 mrad.
  const auto furthest_off = [&log](std::size_t late) {
    double speed = 0.0;
    double angle = 0.0;
    double off = 0.0;
    for (std::size_t i = 1; i + 1 < log.rows.size(); ++i) {
      speed = (speed + log.rows[i - late].torque * 1e-3 / 2e-5) / (1.0 + 2e-3 * 1e-3 / 2e-5);
      angle += speed * 1e-3;
      off = std::max(off, std::fabs(log.rows[i + 1].q1 - angle));
    }
    return off;
  };
  EXPECT_LT(furthest_off(0), 2e-4);
  EXPECT_GT(furthest_off(1), 4e-4) << "or the test could not tell a cycle";
  bench.ticks(100);
  EXPECT_EQ(bench.state(), State::kHolding);
}

TEST(ShellResponse, ATravellingJointGoesToAndFroWhileItIsShaken) {
  Bench bench;
  bench.say("arm");
  const Log log =
      respond(bench, "experiment joint0 multisine on=torque amplitude=5mNm travel=0.3 speed=0.2 duration=12");
  EXPECT_EQ(log.verdict, "ok");
  int forward = 0;
  int backward = 0;
  for (std::size_t i = 1; i < log.rows.size(); ++i) {
    const double speed = (log.rows[i].reference - log.rows[i - 1].reference) * 1e3;
    forward += std::fabs(speed - 0.2) < 1e-3;
    backward += std::fabs(speed + 0.2) < 1e-3;
    EXPECT_LE(std::fabs(log.rows[i].reference), 0.3 + 1e-6);
  }
  EXPECT_GT(forward, 2500) << "a leg of 3 s less its ends";
  EXPECT_GT(backward, 2500);
}

TEST(ShellResponse, AChirpAndAShakenReferenceRunWithUsualValues) {
  for (const char* line :
       {"chirp", "chirp on=torque", "chirp on=reference", "multisine on=torque", "multisine on=reference"}) {
    Bench bench;
    bench.say("arm");
    const Log log = respond(bench, std::string("experiment joint0 ") + line);
    EXPECT_EQ(log.verdict, "ok") << line;
    EXPECT_GE(log.rows.size(), 20'000U) << line;
    const bool reference = std::string(line).find("reference") != std::string::npos;
    double shaken = 0.0;
    double wanted = 0.0;
    for (const Row& row : log.rows) {
      shaken = std::max(shaken, std::fabs(row.excitation));
      wanted = std::max(wanted, std::fabs(row.reference));
    }
    EXPECT_NEAR(shaken, reference ? 0.0 : 0.0075, 1e-4) << line;
    EXPECT_NEAR(wanted, reference ? 0.01 : 0.0, 1e-3) << line;
  }
}

TEST(ShellResponse, WhatCanNotBeMeasuredIsRefusedAndNothingMoves) {
  Bench bench;
  const auto refused = [&bench](const std::string& line, const std::string& name) {
    const std::string text = bench.say("experiment joint0 " + line);
    EXPECT_EQ(verdict(text).rfind("error " + name + ": ", 0), 0U) << line << ": " << text;
    EXPECT_EQ(lines_of(text).size(), 1U) << "no header for a log that does not come: " << text;
  };
  refused("chirp", "not_holding");
  bench.say("arm");
  for (const char* option : {"on=", "on=current", "amplitude=0.1rad", "frequencies=1", "from=1rad", "duration=0",
                             "duration=1.5", "every=0", "travel=1Nm", "="}) {
    refused(std::string("chirp on=torque ") + option, "option");
  }
  refused("multisine on=both", "option");
  refused("chirp on=torque amplitude=5mNm amplitude=6mNm", "option");
  refused("chirp amplitude=5mNm on=reference", "option");
  refused("chirp on=torque every=3", "range");
  refused("multisine on=torque every=2 duration=60", "range");
  refused("multisine on=torque every=11 duration=60", "range");
  refused("multisine on=torque travel=0.2 every=3 duration=60", "range");
  refused("multisine on=torque travel=3", "range");
  refused("chirp on=torque amplitude=1Nm", "range");
  refused("chirp on=reference to=50Hz", "range");
  EXPECT_EQ(bench.state(), State::kHolding);
  EXPECT_NEAR(bench.io.motors[0].angle_rad, 0.0, 1e-3);
}

TEST(ShellResponse, AJointThatLeavesItsCorridorEndsItAndIsHeld) {
  Bench bench;
  bench.say("arm");
  type(bench, "experiment joint0 multisine on=torque amplitude=20mNm from=1Hz to=10Hz corridor=0.005 duration=60");
  const std::string text = answer(bench);
  EXPECT_EQ(verdict(text).rfind("error aborted: ", 0), 0U);
  double furthest = 0.0;
  for (int i = 0; i < 2000; ++i) {
    bench.ticks(1);
    furthest = std::max(furthest, std::fabs(bench.io.motors[0].angle_rad));
  }
  EXPECT_LT(furthest, 0.05);
  EXPECT_EQ(bench.state(), State::kHolding);
  EXPECT_EQ(bench.application.axis_telemetry(0).excitation_nm.to_double(), 0.0);
}

TEST(ShellResponse, CancelEndsTheShakingAndAFaultTakesTheTorque) {
  {
    Bench bench;
    bench.say("arm");
    type(bench, "experiment joint0 multisine on=torque");
    bench.ticks(1000);
    bench.shell.poll();
    bench.shell.receive(0x03);
    EXPECT_EQ(verdict(answer(bench, 1000)).rfind("error aborted: ", 0), 0U);
    bench.ticks(100);
    EXPECT_EQ(bench.state(), State::kHolding);
    EXPECT_EQ(bench.application.axis_telemetry(0).excitation_nm.to_double(), 0.0);
  }
  Bench bench;
  bench.say("arm");
  type(bench, "experiment joint0 multisine on=torque");
  for (int i = 0; i < 2000; ++i) {
    bench.ticks(1);
    bench.shell.poll();
  }
  bench.io.estop = true;
  const std::string text = answer(bench, 1000);
  EXPECT_EQ(verdict(text).rfind("error aborted: ", 0), 0U);
  EXPECT_TRUE(has_line(text, "ended by emergency_stop"));
  EXPECT_FALSE(bench.io.has_torque());
}

TEST(ShellResponse, ALogThatLostARowIsAnErrorThatSaysWhatToChange) {
  Bench bench;
  bench.say("arm");
  type(bench, "experiment joint0 multisine on=torque duration=5");
  for (int i = 0; i < 3000; ++i) {
    bench.ticks(1);
    if (i < 1000 || i > 1100) {
      bench.shell.poll();
    }
  }
  const std::string text = answer(bench);
  EXPECT_EQ(verdict(text).rfind("error dropped: ", 0), 0U) << text.substr(text.size() - 300);
  EXPECT_NE(text.find("every"), std::string::npos);
}

}  // namespace
}  // namespace capstan
