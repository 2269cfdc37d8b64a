// SPDX-License-Identifier: Apache-2.0
// Steps of `capstan commission` in which a person lends a hand: counts by a turn, torque per current by a weight; and
// end stops.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <numbers>

#include "capstan/tests/tools/run/happening.hpp"
#include "capstan/tests/tools/run/number_from.hpp"
#include "capstan/tools/commission/commission.hpp"
#include "capstan/tools/support/errors.hpp"

namespace capstan::tools {
namespace {

constexpr double kCorridor = 0.8;
constexpr double kDegree = std::numbers::pi / 180.0;

auto options_of(const sim::Scenario& scenario) -> CommissionOptions {
  return {.axis = 0, .corridor_rad = kCorridor, .inertia_kgm2 = scenario.plant.motor_inertia_kgm2, .key = {}};
}

/// The hand of a person on the motor's pulley, or on the joint, which holds it there: a supply of the bench.
void turn_to(SimBoard& board, double angle_rad, bool joint) {
  constexpr double kApPerRad = 12.0, kAsPerRad = 0.15, kMostA = 2.4, kSlowRadS = 1.0, kThereRad = 0.002;
  const auto where = [&] { return joint ? board.truth(0).q2_rad : board.truth(0).q1_rad; };
  double reference = where();
  double integral = 0.0;
  double last = where();
  int rests = 0;  // cycles at its end, so that what holds it there is steady
  for (int cycle = 0; cycle < 20'000 && rests < 500; ++cycle) {
    rests += reference == angle_rad && std::fabs(where() - angle_rad) < kThereRad ? 1 : 0;
    reference += std::clamp(angle_rad - reference, -1e-3 * kSlowRadS, 1e-3 * kSlowRadS);
    const double off = reference - where();
    integral = std::clamp(integral + 0.01 * off, -0.2, 0.2);
    const double rate = (where() - last) / 1e-3;
    last = where();
    board.tick_on_bench(
        std::array<double, 1>{std::clamp(kApPerRad * (off + integral) - kAsPerRad * rate, -kMostA, kMostA)});
  }
}
void let_go(SimBoard& board) {
  for (int cycle = 0; cycle < 50; ++cycle) {
    board.tick_on_bench({});
  }
}

struct Said {
  std::string refusal;
  Progress progress;
  std::vector<std::string> questions;
};

/// @param hand  what the person does at a question, before the answer yes
auto commissioned(Happening& line, const CommissionOptions& options, const std::string& last_step,
                  const std::function<void(const std::string&)>& hand, Progress progress = {}) -> Said {
  Said said{.refusal = {}, .progress = progress, .questions = {}};
  const Operator person{
      .tell = [](const std::string&) {},
      .agrees =
          [&](const std::string& question) {
            said.questions.push_back(question);
            if (question == "may the joint move?" && said.progress.is_done(last_step)) {
              return false;
            }
            hand(question);
            return true;
          },
      .keep = [&](int, const Progress& now) { said.progress = Progress::parse(now.text(), "state"); }};
  try {
    commission(line, person, options, std::move(progress));
  } catch (const Refusal& refusal) {
    said.refusal = refusal.what();
  }
  return said;
}

/// Turns it by as much as the question says, and back.
auto turning(Happening& line, const HandTurn& turn, double done_share = 1.0, bool lets_go = false)
    -> std::function<void(const std::string&)> {
  return [&line, turn, done_share, lets_go](const std::string& question) {
    SimBoard& board = line.board().board();
    const bool back = question.starts_with("turn it back");
    if (!back && !question.starts_with("turn ")) {
      let_go(board);
      return;
    }
    const double way = back ? -done_share * turn.angle_rad : turn.angle_rad;
    turn_to(board, (turn.of_joint ? board.truth(0).q2_rad : board.truth(0).q1_rad) + way, turn.of_joint);
    if (lets_go) {
      let_go(board);
    }
  };
}

auto counts_of(Happening& line) -> std::int64_t {
  return line.board().board().machine().config()[0].motor.encoder_counts_per_turn;
}

TEST(TurnByHand, CountsAndSignThatAreWrongAreFoundAndSetBeforeAnythingMoves) {
  const sim::Scenario scenario = draw(4475);
  struct Case {
    const char* wrong;
    bool of_joint;
    const char* found;
  };
  for (const Case& one : {Case{"", false, "motor.encoder_counts agrees"},
                          Case{"set joint0.motor.encoder_counts 10240", false, "was 10240 and is 40960 now"},
                          Case{"set joint0.motor.encoder_counts 81920", false, "was 81920 and is 40960 now"},
                          Case{"set joint0.motor.encoder_counts 30000", false, "was 30000 and is 4"},
                          Case{"set joint0.motor.encoder_sign -1", false, "motor.encoder_sign is 1 now"},
                          Case{"", true, "motor.encoder_counts agrees"},
                          Case{"set joint0.motor.encoder_counts 10240", true, "was 10240 and is 40960 now"}}) {
    Happening line(scenario);
    if (one.wrong[0] != '\0') {
      line.ask(one.wrong);
    }
    CommissionOptions options = options_of(scenario);
    options.turn = HandTurn{.angle_rad = (one.of_joint ? 60.0 : 180.0) * kDegree, .of_joint = one.of_joint};
    const Said said = commissioned(line, options, "turn", turning(line, *options.turn));
    EXPECT_EQ(said.refusal.find("shake: stopped on request"), 0U) << one.wrong << ": " << said.refusal;
    EXPECT_TRUE(std::any_of(said.progress.found.begin(), said.progress.found.end(),
                            [&](const std::string& sentence) { return sentence.find(one.found) != std::string::npos; }))
        << one.wrong << ": " << said.progress.found.back();
    EXPECT_NEAR(static_cast<double>(counts_of(line)), 40960.0, 0.02 * 40960.0) << one.wrong;
    EXPECT_EQ(line.last("arm"), "") << "no torque";
  }
}

TEST(TurnByHand, AJointThatWasTurnedIsShakenWhereItIsNowAndGoesOnAfterAPowerCut) {
  const sim::Scenario scenario = draw(4476);
  Happening line(scenario);
  line.ask("set joint0.motor.encoder_counts 10240");
  CommissionOptions options = options_of(scenario);
  options.inertia_kgm2 = {};
  options.turn = HandTurn{.angle_rad = 1.0, .of_joint = false};
  // Back by half: it stands elsewhere behind it, and is told so first.
  const Said half = commissioned(line, options, "shake", turning(line, *options.turn, 0.5));
  EXPECT_NE(half.refusal.find("turn: the encoder gave "), std::string::npos) << half.refusal;
  EXPECT_NE(half.refusal.find("or it was not turned back"), std::string::npos) << half.refusal;
  let_go(line.board().board());
  const Said said = commissioned(line, options, "shake", turning(line, *options.turn));
  EXPECT_TRUE(said.progress.is_done("shake")) << said.refusal;
  ASSERT_TRUE(said.progress.home_rad.has_value());
  const double stands = line.board().board().machine().axis_telemetry(0).q2_rad.to_double();
  EXPECT_NEAR(*said.progress.home_rad, stands, 0.06) << "with the counts that were found";
  // A restarted board has the counts of before, and is told what was found.
  Happening restarted(scenario);
  restarted.ask("set joint0.motor.encoder_counts 10240");
  Progress progress = said.progress;
  Operator person{.tell = [](const std::string&) {},
                  .agrees = [](const std::string&) { return false; },
                  .assures = [](const std::string&) { return true; },
                  .keep = [](int, const Progress&) {}};
  try {
    commission(restarted, person, options, progress);
  } catch (const Refusal& refusal) {
    EXPECT_EQ(std::string(refusal.what()).find("press: stopped on request"), 0U) << refusal.what();
  }
  EXPECT_EQ(counts_of(restarted), 40960);
}

TEST(TurnByHand, AnEncoderThatDoesNotCountOrAPersonWhoDoesNotTurnIsToldSo) {
  const sim::Scenario scenario = draw(4475);
  CommissionOptions options = options_of(scenario);
  options.turn = HandTurn{.angle_rad = 1.0, .of_joint = false};
  Happening idle(scenario);
  const Said nothing = commissioned(idle, options, "turn", [](const std::string&) {});
  EXPECT_NE(nothing.refusal.find("it is dead, not plugged in, or nothing was turned"), std::string::npos)
      << nothing.refusal;
  Happening dead(scenario);
  dead.ask("fail encoder stuck");
  const Said stuck = commissioned(dead, options, "turn", turning(dead, *options.turn));
  EXPECT_NE(stuck.refusal.find("it is dead, not plugged in"), std::string::npos) << stuck.refusal;
}

// Its tendons turned it back by 0.07 rad of 1, both ways, and 7 % too few counts were taken for the encoder's.
TEST(TurnByHand, AMotorThatIsLetGoSpringsBackAndIsNotTakenForItsEncoder) {
  const sim::Scenario scenario = draw(4476);
  Happening line(scenario);
  CommissionOptions options = options_of(scenario);
  options.turn = HandTurn{.angle_rad = 1.0, .of_joint = false};
  const Said said = commissioned(line, options, "turn", turning(line, *options.turn, 1.0, true));
  EXPECT_NE(said.refusal.find("neither right nor wrong by a factor"), std::string::npos) << said.refusal;
  EXPECT_EQ(counts_of(line), 40960);
}

TEST(TurnByHand, AStepThatIsAskedForTooLateIsRefused) {
  const sim::Scenario scenario = draw(4475);
  Happening line(scenario);
  Progress progress;
  progress.done = {"look", "shake"};
  CommissionOptions options = options_of(scenario);
  options.turn = HandTurn{.angle_rad = 1.0, .of_joint = false};
  const Said said = commissioned(
      line, options, "turn", [](const std::string&) {}, progress);
  EXPECT_NE(said.refusal.find("turn: comes ahead of 'shake', which is done already"), std::string::npos)
      << said.refusal;
}

/// Hangs the weight, a torque on the joint, and takes it off.
auto hanging(Happening& line, double weight_nm) -> std::function<void(const std::string&)> {
  return [&line, weight_nm](const std::string& question) {
    const auto pull = [&](double torque) {
      line.ask("fail tip jump amount " + std::to_string(torque));
      line.ask("log joint0 50 10");
    };
    if (question.starts_with("hang the weight")) {
      pull(-weight_nm);
    } else if (question.starts_with("take the weight off")) {
      pull(weight_nm);
    }
  };
}

TEST(WeighByHand, TheTorquePerCurrentComesFromAKnownWeight) {
  const std::uint64_t first = number_from("CAPSTAN_SEED", 4477);
  for (std::uint64_t seed = first; seed < first + number_from("CAPSTAN_PLANTS", 1); ++seed) {
    const sim::Scenario scenario = draw(seed);
    const double right = scenario.plant.torque_constant_nm_per_a;
    for (const double wrong : {1.0, 0.6, 1.5}) {
      Happening line(scenario);
      line.ask("set joint0.motor.torque_per_current " + rounded(wrong * right) + " Nm/A");
      CommissionOptions options = options_of(scenario);
      options.inertia_kgm2 = {};
      const Said weighs_none = commissioned(line, options, "travel", [](const std::string&) {});
      const Progress& known = weighs_none.progress;
      ASSERT_TRUE(known.is_done("travel")) << seed << ": " << weighs_none.refusal;
      const double friction = 0.5 * (known.forward_nm - known.backward_nm) / wrong;
      options.weight_nm = 0.35 * friction * scenario.plant.output_radius_m / scenario.plant.input_radius_m;
      const Said said = commissioned(line, options, "weigh", hanging(line, *options.weight_nm), known);
      EXPECT_EQ(said.refusal.find("motor: stopped on request"), 0U) << seed << ' ' << wrong << ": " << said.refusal;
      const double found = line.board().board().machine().config()[0].motor.torque_per_current_nm_per_a.to_double();
      std::printf("%llu | set to %.2f of it | found %.3f of it | %s\n", static_cast<unsigned long long>(seed), wrong,
                  found / right, said.progress.found.empty() ? "" : said.progress.found.back().c_str());
      EXPECT_NEAR(found / right, 1.0, 0.12) << seed << ' ' << wrong;
      EXPECT_NEAR(said.progress.inertia_kgm2 / scenario.plant.motor_inertia_kgm2, 1.0, 0.35) << "goes along";
    }
  }
}

TEST(WeighByHand, AWeightThatCannotTellOrDoesNotHangIsRefused) {
  const sim::Scenario scenario = draw(4477);
  struct Case {
    double weight_nm;
    const char* sentence;
  };
  for (const Case& one :
       {Case{0.01, "mNm of friction hide; take one about "}, Case{0.04, "a tendon may go slack; take one about "},
        Case{0.5, "Nm continuously; take a lighter one"}}) {
    Happening line(scenario);
    CommissionOptions options = options_of(scenario);
    options.weight_nm = one.weight_nm;
    const Said said = commissioned(line, options, "weigh", hanging(line, one.weight_nm));
    EXPECT_EQ(said.refusal.find("weigh: "), 0U) << said.refusal;
    EXPECT_NE(said.refusal.find(one.sentence), std::string::npos) << said.refusal;
    EXPECT_FALSE(energised(line.board().board().machine().telemetry().state));
  }
}

TEST(EndStops, AreFoundAtLowTorqueAndTheJointIsCommissionedBetweenThem) {
  const std::uint64_t first = number_from("CAPSTAN_SEED", 4478);
  for (std::uint64_t seed = first; seed < first + number_from("CAPSTAN_PLANTS", 1); ++seed) {
    sim::Scenario scenario = draw(seed);
    scenario.plant.stop_low_rad = -0.35;
    scenario.plant.stop_high_rad = 0.5;
    scenario.plant.stop_stiffness_nm_per_rad = 50.0;
    Happening line(scenario);
    CommissionOptions options = options_of(scenario);
    options.finds_ends = true;
    const Said ends = commissioned(line, options, "ends", [](const std::string&) {});
    EXPECT_TRUE(ends.progress.is_done("ends")) << seed << ": " << ends.refusal;
    if (!ends.refusal.starts_with("travel: stopped on request")) {
      continue;
    }
    std::printf("%llu | %s\n", static_cast<unsigned long long>(seed), ends.progress.found.back().c_str());
    const LimitConfig& limits = line.board().board().machine().config()[0].limits;
    // An estimate is off by what the tendons bend: most on elbows, whose are unlike and soft.
    EXPECT_NEAR(limits.joint_min_rad.to_double(), -0.35, 0.15) << seed;
    EXPECT_NEAR(limits.joint_max_rad.to_double(), 0.5, 0.15) << seed;
    EXPECT_LT(limits.motor_max_rad.to_double(), 1.0) << seed;
    EXPECT_GT(limits.motor_min_rad.to_double(), -1.0) << seed;
    const Said all = commissioned(
        line, options, "", [](const std::string&) {}, ends.progress);
    EXPECT_EQ(all.refusal, "") << seed;
    EXPECT_EQ(all.progress.found.back(), "saved") << seed;
  }
}

TEST(EndStops, WithoutAnyTheLimitsStayAsTheyWereGiven) {
  const sim::Scenario scenario = draw(4479);
  Happening line(scenario);
  CommissionOptions options = options_of(scenario);
  options.finds_ends = true;
  const std::vector<std::string> before = line.ask("dump");
  static_cast<void>(line.board().take_way());
  const Said said = commissioned(line, options, "ends", [](const std::string&) {});
  ASSERT_TRUE(said.progress.is_done("ends")) << said.refusal;
  EXPECT_NE(said.progress.found.back().find("backward none within the corridor, forward none within the corridor"),
            std::string::npos)
      << said.progress.found.back();
  EXPECT_EQ(line.ask("dump"), before);
  EXPECT_LT(line.board().take_way().joint_rad, kCorridor + 0.02);
}

}  // namespace
}  // namespace capstan::tools
