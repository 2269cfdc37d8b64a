// SPDX-License-Identifier: Apache-2.0
// `capstan commission` on drawn joints, healthy and wired wrongly.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <map>

#include "capstan/tests/tools/run/drawn_joint.hpp"
#include "capstan/tests/tools/run/number_from.hpp"
#include "capstan/tools/commission/commission.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

constexpr double kCorridor = 1.0;
constexpr double kFiveDegrees = 5.0 / 57.29577951308232;

struct Outcome {
  bool done = false;
  std::string sentence;
  Progress progress;
  double motor_rad = 0.0, joint_rad = 0.0;  ///< furthest
  double seconds = 0.0;
  std::string steps_s;  ///< of that, each step's
  bool torque_off = false;
  double stiffness = 0.0;
};

auto run(const sim::Scenario& scenario, const std::vector<std::string>& wrong, Progress progress = {},
         const std::string& stop_before = "") -> Outcome {
  SimShell line(scenario);
  for (const auto& lines : {data_sheet(scenario.plant), wrong}) {
    for (const std::string& one : lines) {
      line.ask(one);
    }
  }
  for (int i = 0; i < 40; ++i) {
    line.ask("log joint0 50 10");  // what fell, fell
  }
  static_cast<void>(line.take_way());
  Outcome outcome;
  std::string step;
  std::uint32_t since = line.board().machine().telemetry().tick;
  Operator person{.tell = [&](const std::string& text) { step = text; },
                  .agrees = [&](const std::string&) { return stop_before.empty() || !step.starts_with(stop_before); },
                  .keep =
                      [&](int, const Progress& now) {
                        const bool over = now.done.size() > outcome.progress.done.size();
                        outcome.progress = now;
                        if (!over) {
                          return;
                        }
                        const std::uint32_t tick = line.board().machine().telemetry().tick;
                        outcome.steps_s += " " + now.done.back() + " " + rounded(1e-3 * (tick - since), 3);
                        since = tick;
                      }};
  try {
    commission(line, person,
               {.axis = 0, .corridor_rad = kCorridor, .inertia_kgm2 = scenario.plant.motor_inertia_kgm2, .key = {}},
               std::move(progress));
    outcome.done = true;
  } catch (const Refusal& refusal) {
    outcome.sentence = refusal.what();
  }
  const SimShell::Way way = line.take_way();
  outcome.motor_rad = way.motor_rad;
  outcome.joint_rad = way.joint_rad;
  outcome.seconds = way.seconds;
  outcome.torque_off = !energised(line.board().machine().telemetry().state);
  outcome.stiffness = line.board().machine().config()[0].control.stiffness_nm_per_rad.to_double();
  return outcome;
}

TEST(Commission, DrawnJointsAreCommissionedWithinTheirCorridorAndEndWithoutTorque) {
  const std::uint64_t first = number_from("CAPSTAN_SEED", 730);
  for (std::uint64_t seed = first; seed < first + number_from("CAPSTAN_PLANTS", 2); ++seed) {
    const sim::Scenario scenario = draw(seed);
    const Outcome outcome = run(scenario, {});
    std::printf("%llu | %s | joint %.2f rad, %.0f s |%s | %s\n", static_cast<unsigned long long>(seed),
                outcome.done ? "done" : "stopped", outcome.joint_rad, outcome.seconds, outcome.steps_s.c_str(),
                outcome.sentence.c_str());
    for (const std::string& found : outcome.progress.found) {
      std::printf("  %s\n", found.c_str());
    }
    EXPECT_TRUE(outcome.done) << seed << ": " << outcome.sentence;
    EXPECT_TRUE(outcome.torque_off) << seed;
    EXPECT_LT(outcome.joint_rad, kCorridor + 0.02) << seed;
  }
}

// The wrist's tendons are stiff and rub, the finger's joint swings on them at 45 Hz.
TEST(Commission, OtherInstrumentsAreCommissionedToo) {
  for (const char* name : {"da_vinci_wrist:0", "robot_finger:0"}) {
    const Outcome outcome = run(draw(921, joint_of(name)), {});
    EXPECT_TRUE(outcome.done) << name << ": " << outcome.sentence;
    EXPECT_TRUE(outcome.torque_off) << name;
    EXPECT_LT(outcome.joint_rad, kCorridor + 0.02) << name;
  }
}

// Its home and its torque had so many digits that the shell said line_too_long.
TEST(Commission, TheShakesOrderFitsTheShellsLine) {
  const Outcome outcome = run(draw(767), {});
  EXPECT_TRUE(outcome.done) << outcome.sentence;
}

/// A person who presses Ctrl-C while the board answers a line that has this in it.
class StoppedShell final : public BoardShell {
 public:
  StoppedShell(const sim::Scenario& scenario, std::string answering)
      : line_(scenario), answering_(std::move(answering)) {
    stop_by(stop_);
  }
  [[nodiscard]] auto board() -> SimBoard& { return line_.board(); }
  [[nodiscard]] auto armed_afterwards() const -> int { return armed_afterwards_; }

 private:
  auto do_ask(const std::string& line) -> std::vector<std::string> override {
    armed_afterwards_ += stop_ != 0 && line == "arm" ? 1 : 0;
    if (stop_ == 0 && line.find(answering_) != std::string::npos) {
      stop_ = 1;
      throw Refusal("stopped while the board was answering");
    }
    return line_.ask(line);
  }
  SimShell line_;
  std::string answering_;
  volatile std::sig_atomic_t stop_ = 0;
  int armed_afterwards_ = 0;
};

TEST(Commission, StoppedWhileItTunesItDoesNotTryAgainAndPutsTheGainsBack) {
  const sim::Scenario scenario;
  StoppedShell line(scenario, "travel=");
  Progress progress;
  progress.done = {"look", "shake", "press", "travel", "motor"};
  progress.inertia_kgm2 = scenario.plant.motor_inertia_kgm2;
  const double before = line.board().machine().config()[0].control.stiffness_nm_per_rad.to_double();
  const Operator person{.tell = [](const std::string&) {},
                        .agrees = [](const std::string&) { return true; },
                        .keep = [](int, const Progress&) {}};
  EXPECT_THROW(
      commission(line, person, {.axis = 0, .corridor_rad = kCorridor, .inertia_kgm2 = {}, .key = {}}, progress),
      Refusal);
  EXPECT_EQ(line.armed_afterwards(), 0);
  EXPECT_FALSE(energised(line.board().machine().telemetry().state));
  EXPECT_EQ(line.board().machine().config()[0].control.stiffness_nm_per_rad.to_double(), before);
}

// It was told that the motor ran away and that its tendons are off.
TEST(Commission, AStopIsTakenForNothingThatTheMotorDid) {
  struct Stop {
    const char* answering;  ///< part of the line
    const char* step;
  };
  for (const Stop& stop : {Stop{"multisine on=torque", "shake"}, Stop{"begin", "shake"},
                           Stop{"torque_triangle", "press"}, Stop{"experiment joint0 triangle", "travel"}}) {
    StoppedShell line(draw(730), stop.answering);
    for (const std::string& one : data_sheet(draw(730).plant)) {
      line.ask(one);
    }
    const std::vector<std::string> before = line.ask("dump");
    const Operator person{.tell = [](const std::string&) {},
                          .agrees = [](const std::string&) { return true; },
                          .keep = [](int, const Progress&) {}};
    try {
      commission(line, person, {.axis = 0, .corridor_rad = kCorridor, .inertia_kgm2 = {}, .key = {}}, {});
      ADD_FAILURE() << stop.step << " went on";
    } catch (const Refusal& refusal) {
      EXPECT_EQ(std::string(refusal.what()),
                std::string(stop.step) + ": stopped on request, torque is off; the same command continues from here");
    }
    EXPECT_FALSE(energised(line.board().machine().telemetry().state)) << stop.step;
    EXPECT_EQ(line.ask("dump"), before) << stop.step;
  }
}

/// Counts the lines of each step, and lets the power fail after some of one.
class CutShell final : public BoardShell {
 public:
  CutShell(SimShell& board, const std::string& step) : board_(board), step_(step) {}
  void cut(const std::string& step, int after) {
    cut_step_ = step;
    after_ = after;
  }
  std::map<std::string, int> asked;

 private:
  auto do_ask(const std::string& line) -> std::vector<std::string> override {
    dead_ = dead_ || (step_ == cut_step_ && asked[step_] == after_);
    if (dead_) {
      throw Refusal("the board does not answer");
    }
    ++asked[step_];
    return board_.ask(line);
  }
  SimShell& board_;
  const std::string& step_;
  std::string cut_step_;
  int after_ = -1;
  bool dead_ = false;
};

TEST(Commission, AfterAPowerCutInAnyStepTheBoardIsDisarmedWithTheOldOrTheNewSetAndCommissioningGoesOn) {
  const sim::Scenario scenario = draw(741);
  const CommissionOptions options{
      .axis = 0, .corridor_rad = kCorridor, .inertia_kgm2 = scenario.plant.motor_inertia_kgm2, .key = {}};
  std::string step;
  std::string last_step;
  Progress known;
  const Operator person{
      .tell = [&](const std::string& text) { step = text.front() == ' ' ? step : text.substr(0, text.find(':')); },
      .agrees = [&](const std::string&) { return last_step.empty() || !known.is_done(last_step); },
      .assures = [](const std::string&) { return true; },
      .keep = [&](int, const Progress& now) { known = now; }};
  FileBanks whole_banks = FileBanks::temporary();
  SimShell whole(scenario, whole_banks);
  const std::vector<std::string> set_before = whole.ask("dump");
  CutShell counting(whole, step);
  commission(counting, person, options, {});
  const std::vector<std::string> steps = known.done;
  const std::vector<std::string> set_after = SimShell(scenario, whole_banks).ask("dump");
  EXPECT_NE(set_after, set_before);
  known = {};
  for (const std::string& name : steps) {
    FileBanks banks = FileBanks::temporary();
    last_step = name;
    {
      SimShell board(scenario, banks);
      CutShell cut(board, step);
      cut.cut(name, counting.asked[name] / 2);
      EXPECT_THROW(commission(cut, person, options, known), Refusal) << name;
    }
    ASSERT_FALSE(known.is_done(name));
    SimShell board(scenario, banks);
    EXPECT_FALSE(energised(board.board().machine().telemetry().state)) << name;
    const std::vector<std::string> now = board.ask("dump");
    EXPECT_TRUE(now == set_before || now == set_after) << name;
    try {
      commission(board, person, options, known);
    } catch (const Refusal& refusal) {
      EXPECT_NE(std::string(refusal.what()).find("stopped on request"), std::string::npos) << refusal.what();
    }
    EXPECT_TRUE(known.is_done(name)) << name;
    known.done.resize(static_cast<std::size_t>(&name - steps.data()) +
                      1);  // `save` moves nothing, so it does not ask before it begins
  }
}

// The board goes on with the narrow limits of the step, which were taken for those of before: a joint within them is
// blocked.
TEST(Commission, WhatARunThatWasKilledHadSetForAWhileIsGivenBackByTheNextOne) {
  const sim::Scenario scenario = draw(741);
  const CommissionOptions options{
      .axis = 0, .corridor_rad = kCorridor, .inertia_kgm2 = scenario.plant.motor_inertia_kgm2, .key = {}};
  std::string step;
  Progress known;
  const Operator person{
      .tell = [&](const std::string& text) { step = text.front() == ' ' ? step : text.substr(0, text.find(':')); },
      .agrees = [&](const std::string&) { return !known.is_done("travel"); },
      .keep = [&](int, const Progress& now) { known = Progress::parse(now.text(), "state"); }};
  SimShell board(scenario);
  const std::vector<std::string> set_before = board.ask("dump");
  CutShell killed(board, step);
  killed.cut("press", 20);
  EXPECT_THROW(commission(killed, person, options, {}), Refusal);
  EXPECT_FALSE(known.is_done("press"));
  EXPECT_NE(board.ask("dump"), set_before);
  try {
    commission(board, person, options, known);
  } catch (const Refusal& refusal) {
    EXPECT_EQ(std::string(refusal.what()).find("motor: stopped on request"), 0) << refusal.what();
  }
  EXPECT_EQ(known.done, (std::vector<std::string>{"look", "shake", "press", "travel"}));
  EXPECT_TRUE(known.before.empty());
  EXPECT_EQ(board.ask("dump"), set_before);
}

TEST(Commission, WrongWiringsAreFoundBeforeTheMotorMovesFiveDegrees) {
  struct Wrong {
    const char* what;
    std::vector<std::string> lines;
    const char* sentence;  ///< part of it
  };
  const auto counts = [](double factor) {
    const double right = instrument().encoder_counts_per_turn;
    return "set joint0.motor.encoder_counts " + std::to_string(std::lround(factor * right));
  };
  const std::vector<Wrong> all = {
      {"encoder sign", {"set joint0.motor.encoder_sign -1"}, "encoder counts against the torque"},
      {"counts x4", {counts(4.0)}, "encoder_counts"},
      {"counts / 2", {counts(0.5)}, "encoder_counts"},
      {"current sign", {"fail current sign"}, "wrong sign"},
      {"current sensor stuck", {"fail current stuck"}, "current sensor"},
      {"amplifier off", {"fail amplifier off"}, "does not follow"},
      {"encoder stuck", {"fail encoder stuck"}, "encoder"},
      {"tendon off", {"fail tendon_top snap"}, "tendon"},
      {"both tendons off", {"fail tendon_top snap", "fail tendon_bottom snap"}, "tendon"},
  };
  const std::uint64_t first = number_from("CAPSTAN_SEED", 730);
  for (std::uint64_t seed = first; seed < first + number_from("CAPSTAN_PLANTS", 2); ++seed) {
    for (const Wrong& wrong : all) {
      const Outcome outcome = run(draw(seed), wrong.lines);
      std::printf("%llu | %s | motor %.2f deg | %s\n", static_cast<unsigned long long>(seed), wrong.what,
                  57.29577951308232 * outcome.motor_rad, outcome.sentence.c_str());
      EXPECT_FALSE(outcome.done) << seed << ' ' << wrong.what;
      EXPECT_NE(outcome.sentence.find(wrong.sentence), std::string::npos)
          << seed << ' ' << wrong.what << ": " << outcome.sentence;
      EXPECT_LT(outcome.motor_rad, kFiveDegrees) << seed << ' ' << wrong.what;
      EXPECT_TRUE(outcome.torque_off) << seed << ' ' << wrong.what;
      EXPECT_DOUBLE_EQ(outcome.stiffness, 1.0) << seed << ' ' << wrong.what << ": gains are those of before";
    }
  }
}

// Elbows, whose counts are coarse: healthy ones spring back by a count less than is asked (1505, 1706, 1855), and
// without tendons light motors swing back by as much (1700, 1703).
TEST(Commission, TendonsAreToldFromNoneByMoreThanACount) {
  for (const std::uint64_t seed : {1505U, 1700U, 1703U, 1706U, 1855U}) {
    const sim::Scenario elbow = draw(seed, joint_of("raven2:1"));
    EXPECT_TRUE(run(elbow, {}, {}, "travel").progress.is_done("press")) << seed;
    const Outcome off = run(elbow, {"fail tendon_top snap", "fail tendon_bottom snap"}, {}, "travel");
    EXPECT_FALSE(off.progress.is_done("press")) << seed;
    EXPECT_NE(off.sentence.find("no tendon pulls at it"), std::string::npos) << seed << ": " << off.sentence;
    EXPECT_LT(off.motor_rad, kFiveDegrees) << seed;
  }
}

// Shaken harder, it left its limits fast and ran on to 6.6 deg.
TEST(Commission, ALightMotorWithoutTendonsIsNotShakenOutOfItsLimits) {
  const Outcome off =
      run(draw(3009, joint_of("raven2:1")), {"fail tendon_top snap", "fail tendon_bottom snap"}, {}, "travel");
  EXPECT_NE(off.sentence.find("no tendon pulls at it"), std::string::npos) << off.sentence;
  EXPECT_LT(off.motor_rad, kFiveDegrees);
}

// Without its upper tendon this elbow has fallen further than the limits of the motor from its zero.
TEST(Commission, AJointThatFellFarIsToldSo) {
  const Outcome outcome = run(draw(3015, joint_of("raven2:1")), {"fail tendon_top snap"}, {}, "travel");
  EXPECT_NE(outcome.sentence.find("tendon"), std::string::npos) << outcome.sentence;
}

TEST(Commission, ABlockedJointIsFound) {
  const std::uint64_t first = number_from("CAPSTAN_SEED", 730);
  for (std::uint64_t seed = first; seed < first + number_from("CAPSTAN_PLANTS", 2); ++seed) {
    sim::Scenario scenario = draw(seed);
    scenario.plant.environment.kind = sim::EnvironmentKind::kLocked;
    const Outcome outcome = run(scenario, {});
    std::printf("%llu | blocked | motor %.2f deg | %s\n", static_cast<unsigned long long>(seed),
                57.29577951308232 * outcome.motor_rad, outcome.sentence.c_str());
    EXPECT_NE(outcome.sentence.find("blocked"), std::string::npos) << seed << ": " << outcome.sentence;
    EXPECT_TRUE(outcome.torque_off) << seed;
  }
}

TEST(Commission, WhatWasStoppedGoesOnWhereItWas) {
  const sim::Scenario scenario = draw(730);
  const Outcome stopped = run(scenario, {}, {}, "press");
  EXPECT_FALSE(stopped.done);
  EXPECT_TRUE(stopped.torque_off);
  EXPECT_EQ(stopped.progress.done, (std::vector<std::string>{"look", "shake"}));
  const Outcome resumed = run(scenario, {}, Progress::parse(stopped.progress.text(), "state"), "motor");
  EXPECT_EQ(resumed.progress.done, (std::vector<std::string>{"look", "shake", "press", "travel"}));
  EXPECT_DOUBLE_EQ(resumed.progress.inertia_kgm2, stopped.progress.inertia_kgm2) << "was not shaken again";
  EXPECT_DOUBLE_EQ(resumed.stiffness, 1.0) << "what a step sets for a while is taken back";
}

TEST(Commission, ProgressIsReadBackAndForeignFilesAreRefused) {
  Progress progress;
  progress.done = {"look", "shake"};
  progress.set = {{"control.stiffness", "0.5 Nm/rad"}};
  progress.found = {"a = b"};
  progress.before = {{"limits.motor_min", "-6 rad"}};
  progress.axis = 2;
  progress.board = "board sim joints 1, 40960 counts, sign 1, 0.1 Nm/A";
  progress.home_rad = -0.25;
  const Progress read = Progress::parse(progress.text(), "state");
  EXPECT_EQ(read.axis, progress.axis);
  EXPECT_EQ(read.board, progress.board);
  EXPECT_EQ(read.home_rad, progress.home_rad);
  EXPECT_EQ(read.done, progress.done);
  EXPECT_EQ(read.set, progress.set);
  EXPECT_EQ(read.before, progress.before);
  EXPECT_EQ(read.found, progress.found);
  EXPECT_THROW(Progress::parse("time_s,axis0/q1_rad\n", "state"), BadInput);
  EXPECT_THROW(Progress::parse("done look\n", "state"), BadInput);
}

}  // namespace
}  // namespace capstan::tools
