// SPDX-License-Identifier: Apache-2.0
// Responses and gains of the firmware on the simulated forceps: what is promised is measured again with the new gains.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <sstream>

#include "capstan/hal/sim/instrument.hpp"
#include "capstan/tests/tools/run/board_rig.hpp"
#include "capstan/tools/response/tuning.hpp"
#include "capstan/tools/support/errors.hpp"

namespace capstan::tools {
namespace {

using Lines = std::vector<std::string>;

/// What a joint answers, with these lines typed before it is armed.
auto respond(const sim::Scenario& scenario, const Lines& lines, const std::string& options) -> Response {
  test::BoardRig rig(scenario);
  rig.say("maintenance open");
  rig.say(lines);
  rig.say("arm");
  const std::string text = rig.say("experiment joint0 multisine on=torque from=1Hz to=200Hz " + options);
  EXPECT_NE(text.find("\r\nok"), std::string::npos)
      << text.substr(text.size() - std::min<std::size_t>(300, text.size()));
  std::istringstream all(text);
  std::string log;
  for (std::string line; std::getline(all, line);) {
    const bool row = line.find(',') != std::string::npos && line.front() != '#';
    log += row ? line + "\n" : "";
  }
  return estimate_response(read_response(CsvLog::parse(log, "run.csv"), 0));
}

// Its tendons carry as much inertia as its motor has, and at 45 Hz, between two lines, it stands still while they
// swing.
TEST(ResponseOnPlant, MarginsOfAJointThatSwingsOnItsTendonsAreKeptTogetherWithItsResonance) {
  sim::Scenario scenario;
  scenario.plant = sim::parse_instrument(sim::built_in_instrument("robot_finger"), "finger").axes[0].plant;
  const Lines calm = {"set joint0.motor.torque_per_current 0.3 Nm/A", "set joint0.motor_angle.beta 0.77778",
                      "set joint0.control.stiffness 1 Nm/rad", "set joint0.control.damping 0.01 Nms/rad"};
  LoopGains present;
  present.damping = 0.01;
  present.continuous_nm = 0.45;
  const std::string experiment = "travel=0.75 speed=0.46875 duration=110 amplitude=6mNm";
  scenario.seed = 31;
  const Tuning tuning = tune(respond(scenario, calm, experiment), present, {});
  const double wanted = std::sqrt(4e4 * 9e-3 * 9e-3 / 4e-5) / (2.0 * std::numbers::pi);
  EXPECT_NEAR(tuning.motor.joint_hz, wanted, 0.05 * wanted) << "both tendons over the joint's inertia";
  EXPECT_NEAR(tuning.motor.inertia_kgm2, 4e-5, 0.12 * 4e-5) << "of the motor alone";
  scenario.seed = 32;
  Lines tuned = calm;
  for (const std::string& line : tuning_lines(tuning.gains, 0)) {
    tuned.push_back(line);
  }
  const Margins after = margins_of(measured_loop(respond(scenario, tuned, experiment)), false);
  const Margins& promised = tuning.whole_nominal;
  std::printf(
      "finger: %.1f Hz; phase margin %.1f deg promised, %.1f measured; gain %.1f, %.1f dB; modulus %.3f, %.3f\n",
      after.crossover_hz, promised.phase_deg, after.phase_deg, promised.gain_db, after.gain_db, promised.modulus,
      after.modulus);
  EXPECT_NEAR(after.phase_deg, promised.phase_deg, 5.0);
  EXPECT_NEAR(after.gain_db, promised.gain_db, 1.0);
  EXPECT_GE(after.phase_deg, 43.0);
}

const std::string kTravelling = "travel=1.8 speed=1 duration=120 ";

TEST(ResponseOnPlant, MarginsPromisedAreMeasuredWithTheNewGainsWithinFiveDegreesAndOneDecibel) {
  struct Case {
    const char* what;
    double inertia, bandwidth_hz;
    std::optional<double> asked_hz;
  };
  for (const Case& one : {Case{"forceps", 2e-5, 300.0, {}}, Case{"forceps, 30 Hz asked", 2e-5, 300.0, 30.0},
                          Case{"inertia 3e-5", 3e-5, 300.0, {}}, Case{"amplifier of 150 Hz", 2e-5, 150.0, {}}}) {
    sim::Scenario scenario;
    scenario.seed = 31;
    scenario.plant.motor_inertia_kgm2 = one.inertia;
    scenario.plant.current_bandwidth_hz = one.bandwidth_hz;
    const Lines gentle = {"set joint0.control.stiffness 0.5", "set joint0.control.damping 0.005"};
    LoopGains present;
    present.stiffness = 0.5;
    present.damping = 0.005;
    const Response before = respond(scenario, gentle, kTravelling + "amplitude=8mNm");
    require_usable(before);
    Wanted wanted;
    wanted.bandwidth_hz = one.asked_hz;
    const Tuning tuning = tune(before, present, wanted);
    scenario.seed = 32;
    const Margins after = margins_of(
        measured_loop(respond(scenario, tuning_lines(tuning.gains, 0), kTravelling + "amplitude=8mNm")), false);
    const Margins& promised = tuning.whole_nominal;
    std::printf(
        "%s: inertia %.3g g m2; %.1f Hz; phase margin %.1f deg promised, %.1f measured; gain margin %.1f, %.1f dB; "
        "modulus %.3f, %.3f\n",
        one.what, 1e3 * tuning.motor.inertia_kgm2, after.crossover_hz, promised.phase_deg, after.phase_deg,
        promised.gain_db, after.gain_db, promised.modulus, after.modulus);
    EXPECT_NEAR(after.phase_deg, promised.phase_deg, 5.0) << one.what;
    EXPECT_NEAR(after.gain_db, promised.gain_db, 1.0) << one.what;
    EXPECT_GE(after.phase_deg, 43.0) << one.what;
    EXPECT_NEAR(tuning.motor.inertia_kgm2, one.inertia, 0.12 * one.inertia) << "the tendons' own comes to it";
  }
}

TEST(ResponseOnPlant, AJointThatFrictionHoldsIsRefusedAndToldToTravel) {
  sim::Scenario scenario;
  scenario.seed = 43;
  for (const char* amplitude : {"amplitude=4mNm", "amplitude=7mNm", "amplitude=15mNm"}) {
    const Response stuck = respond(scenario, {}, std::string("duration=40 ") + amplitude);
    try {
      require_usable(stuck);
      ADD_FAILURE() << amplitude << " gives " << stuck.distortion.odd;
    } catch (const Refusal& refusal) {
      EXPECT_NE(std::string(refusal.what()).find("travel"), std::string::npos) << refusal.what();
    }
  }
}

}  // namespace
}  // namespace capstan::tools
