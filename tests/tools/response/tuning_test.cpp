// SPDX-License-Identifier: Apache-2.0
// Gains against a motor whose loop is known in closed form, and against that motor run with them.
#include "capstan/tools/response/tuning.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "capstan/tests/tools/response/known_motor.hpp"
#include "capstan/tools/response/limit_cycle.hpp"
#include "capstan/tools/response/response_report.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

using test::gentle;
using test::kPi;
using test::Motor;
using test::true_margins;

TEST(Tuning, MarginsPromisedAreTheTrueOnesOfManyMotors) {
  for (const double inertia : {4e-6, 2e-5, 1e-4}) {
    for (const int delay : {0, 1, 3}) {
      const Motor motor{.inertia = inertia, .drag = 10.0 * inertia, .delay = delay};
      LoopGains present;
      present.stiffness = 5e3 * inertia;
      present.damping = 200.0 * inertia;
      present.continuous_nm = 1e3 * inertia;
      const Tuning tuning = tune(motor.response(present), present, {});
      const Margins truth = true_margins(motor, tuning.gains);
      EXPECT_GE(truth.phase_deg, 45.0) << inertia << ' ' << delay;
      EXPECT_GE(truth.gain_db, 6.0) << inertia << ' ' << delay;
      EXPECT_GE(truth.modulus, 0.5) << inertia << ' ' << delay;
      EXPECT_NEAR(tuning.whole_nominal.phase_deg, truth.phase_deg, 1.0) << inertia << ' ' << delay;
      EXPECT_NEAR(tuning.whole_nominal.gain_db, truth.gain_db, 0.3) << inertia << ' ' << delay;
      EXPECT_NEAR(tuning.whole_nominal.modulus, truth.modulus, 0.01) << inertia << ' ' << delay;
      EXPECT_NEAR(tuning.motor.inertia_kgm2, inertia, 0.05 * inertia) << delay;
      EXPECT_NEAR(1e3 * (tuning.motor.delay_s + tuning.motor.lag_s), delay + 0.5, 0.1)
          << "the hold's half a cycle too; delay and a short lag look alike";
      ASSERT_FALSE(motor.grows(present, 1.0)) << "a log is of a stable loop";
      EXPECT_FALSE(motor.grows(tuning.gains, 1.0)) << inertia << ' ' << delay;
      EXPECT_FALSE(motor.grows(tuning.gains, std::pow(10.0, (truth.gain_db - 0.7) / 20.0))) << delay;
      EXPECT_TRUE(motor.grows(tuning.gains, std::pow(10.0, (truth.gain_db + 0.7) / 20.0))) << delay;
    }
  }
}

// Gains that suit the mean of both ways have less than 45 deg one way.
TEST(Tuning, MarginsOfAMotorThatDiffersBackwardAndForwardAreTheLowerOnes) {
  const Motor heavy{.inertia = 4e-5};
  const Motor light{.inertia = 1.2e-5};
  const LoopGains present = gentle();
  const auto least = [&](const LoopGains& gains) {
    const Margins a = true_margins(heavy, gains);
    const Margins b = true_margins(light, gains);
    return Margins{.phase_deg = std::min(a.phase_deg, b.phase_deg),
                   .gain_db = std::min(a.gain_db, b.gain_db),
                   .modulus = std::min(a.modulus, b.modulus)};
  };
  Response response = heavy.response(present);
  response.ways = {heavy.response(present), light.response(present)};
  for (std::size_t i = 0; i < response.points.size(); ++i) {
    ResponsePoint& both = response.points[i];
    both.motor.value = 0.5 * (both.motor.value + response.ways[1].points[i].motor.value);
    both.loop.value = 0.5 * (both.loop.value + response.ways[1].points[i].loop.value);
  }
  const Tuning tuning = tune(response, present, {});
  const Margins truth = least(tuning.gains);
  EXPECT_GE(truth.phase_deg, 45.0);
  EXPECT_GE(truth.gain_db, 6.0);
  EXPECT_GE(truth.modulus, 0.5);
  EXPECT_NEAR(tuning.whole_nominal.phase_deg, truth.phase_deg, 1.0);
  EXPECT_NEAR(tuning.whole_nominal.gain_db, truth.gain_db, 0.3);
  EXPECT_NEAR(tuning.whole_nominal.modulus, truth.modulus, 0.01);
  EXPECT_NE(tuning.ways.find("otherwise backward than forward"), std::string::npos);
  const auto both = predict_limit_cycle(response, tuning.gains);
  const auto first = predict_limit_cycle(response.ways[1], tuning.gains);
  ASSERT_TRUE(both && first);
  EXPECT_DOUBLE_EQ(both->onset, first->onset) << "the lighter swings first";
  response.ways.clear();
  EXPECT_LT(least(tune(response, present, {}).gains).phase_deg, 44.0);
}

// Margins alone do not keep it away: 6 dB are less than two times, and here less is asked for.
TEST(Tuning, WhatTheSearchChoosesByItselfIsNeverTooNearToSwinging) {
  const LoopGains present = gentle();
  const Response response = Motor{.delay = 3}.response(present);
  Wanted wanted{.phase_deg = 20.0, .gain_db = 3.0, .modulus = 0.2, .onset = 1.0, .bandwidth_hz = {}};
  const auto careless = predict_limit_cycle(response, tune(response, present, wanted).gains);
  ASSERT_TRUE(careless);
  EXPECT_LT(careless->onset, 1.9);
  wanted.onset = Wanted{}.onset;
  const Tuning tuning = tune(response, present, wanted);
  const auto cycle = predict_limit_cycle(response, tuning.gains);
  ASSERT_TRUE(cycle);
  EXPECT_GE(cycle->onset, 2.0);
  EXPECT_LT(cycle->onset, 2.3) << "and no more is given away";
  EXPECT_NE(tuning.limited_by.find("gain margin"), std::string::npos) << tuning.limited_by;
  EXPECT_NE(tuning.swings.find("the joint of this log stood"), std::string::npos) << tuning.swings;
  EXPECT_EQ(tuning.swings.find("0 rad/s"), std::string::npos) << tuning.swings;
}

TEST(Tuning, ABandwidthThatIsAskedForIsTheCrossoverAndTooMuchIsRefused) {
  const Motor motor;
  const LoopGains present = gentle();
  Wanted wanted;
  wanted.bandwidth_hz = 15.0;
  const Tuning tuning = tune(motor.response(present), present, wanted);
  EXPECT_GE(tuning.servo.crossover_hz, 15.0);
  EXPECT_LE(tuning.servo.crossover_hz, 15.0 * 1.15);
  for (const auto& [hz, cure] : {std::pair{250.0, "at 250 Hz; ask for less bandwidth"},
                                 std::pair{0.5, "Hz keep them, so ask for more bandwidth"}}) {
    wanted.bandwidth_hz = hz;
    try {
      static_cast<void>(tune(motor.response(present), present, wanted));
      ADD_FAILURE() << hz;
    } catch (const Refusal& refusal) {
      EXPECT_NE(std::string(refusal.what()).find(cure), std::string::npos) << refusal.what();
    }
  }
}

TEST(Tuning, WiderCirclesLeaveLessGain) {
  const Motor motor;
  const LoopGains present = gentle();
  const Tuning sure = tune(motor.response(present, 1e-3), present, {});
  const Tuning unsure = tune(motor.response(present, 0.4), present, {});
  EXPECT_LT(unsure.gains.stiffness, 0.9 * sure.gains.stiffness);
  EXPECT_GT(unsure.whole_nominal.phase_deg, sure.whole_nominal.phase_deg + 3.0);
}

// The rate's filter takes phase that gains could use; a coarse encoder needs it all the same.
TEST(Tuning, TheRatesFilterIsAsFastAsTheEncoderAllows) {
  const Motor motor{.delay = 0};
  LoopGains present = gentle();
  const Tuning fine = tune(motor.response(present), present, {});
  EXPECT_LT(fine.gains.rate_time_constant_s, 0.5 * present.rate_time_constant_s);
  EXPECT_GE(true_margins(motor, fine.gains).phase_deg, 45.0);
  present.counts_per_turn = 1000.0;
  const Tuning coarse = tune(motor.response(present), present, {});
  EXPECT_GT(coarse.gains.rate_time_constant_s, fine.gains.rate_time_constant_s);
  EXPECT_LT(coarse.gains.stiffness, 0.7 * fine.gains.stiffness);
  const std::vector<std::string> lines = tuning_lines(fine.gains, 0);
  EXPECT_TRUE(std::any_of(lines.begin(), lines.end(), [&fine](const std::string& line) {
    return line == "set joint0.control.rate_time_constant " + rounded(fine.gains.rate_time_constant_s) + " s";
  }));
}

TEST(Tuning, ItSaysWhatLimits) {
  const LoopGains present = gentle();
  const std::string delay = tune(Motor{.delay = 4}.response(present), present, {}).limited_by;
  EXPECT_EQ(delay.rfind("delay", 0), 0U) << delay;
  EXPECT_NE(delay.find("4.5 ms"), std::string::npos) << delay;
  LoopGains coarse = present;
  coarse.counts_per_turn = 2000.0;
  coarse.rate_time_constant_s = 0.0005;
  const Tuning limited = tune(Motor{.delay = 0}.response(coarse), coarse, {});
  EXPECT_EQ(limited.limited_by.rfind("encoder", 0), 0U) << limited.limited_by;
}

TEST(Tuning, ALogOfOtherGainsIsRefused) {
  const Motor motor;
  LoopGains others = gentle();
  others.stiffness = 0.28;
  try {
    static_cast<void>(tune(motor.response(others), gentle(), {}));
    FAIL();
  } catch (const Refusal& refusal) {
    EXPECT_NE(std::string(refusal.what()).find("--dump"), std::string::npos) << refusal.what();
  }
}

// Each line is that of the gains, but their neighbours say nothing of each other.
TEST(Tuning, AJointThatSwingsMoreSharplyThanTheLinesTellIsRefusedWithThatSentence) {
  const LoopGains present = gentle();
  Response response = Motor{}.response(present);
  constexpr double kResonanceHz = 12.0;
  for (ResponsePoint& point : response.points) {
    const double relative = point.hz / kResonanceHz;
    const Complex resonance = 1.0 / Complex(1.0 - relative * relative, 0.06 * relative) + 1.0;
    point.motor.value *= resonance;
    point.motor.radius95 *= std::abs(resonance);
    point.loop.value *= resonance;
    point.loop.radius95 *= std::abs(resonance);
  }
  std::string sentence;
  try {
    static_cast<void>(tune(response, present, {}));
  } catch (const Refusal& refusal) {
    sentence = refusal.what();
  }
  EXPECT_NE(sentence.find("swings on its tendons"), std::string::npos) << sentence;
  EXPECT_EQ(sentence.find("--dump"), std::string::npos) << sentence;
}

// A joint in its own bearing behind an undamped tendon: what brakes it shows below its swing too.
TEST(Tuning, AJointThatIsBrakedItselfIsPartOfTheModel) {
  constexpr double kInertia = 1.3e-5, kJoint = 1.2e-5, kTendon = 0.14, kBrake = 2e-4, kLateS = 8e-4;
  Response response{.name = "known", .points = {}, .distortion = {}};
  for (double hz = 2.0; hz < 200.0; hz *= 1.15) {
    const double w = 2.0 * kPi * hz;
    const Complex joint(-kJoint * w * w, kBrake * w);
    const double held = std::sin(0.5e-3 * w) / (0.5e-3 * w);  // torque, for a cycle; its delay is in kLateS
    const Complex value = std::polar(held, -w * kLateS) / (-kInertia * w * w + kTendon * joint / (kTendon + joint));
    response.points.push_back({hz, {value, 1e-3 * std::abs(value)}, {1.0, 0.0}, {value, 1e-3 * std::abs(value)}, 1.0});
  }
  const MotorModel model = fit_motor_and_joint(response);
  EXPECT_NEAR(model.inertia_kgm2, kInertia, 0.02 * kInertia);
  EXPECT_NEAR(model.joint_inertia_kgm2, kJoint, 0.02 * kJoint);
  EXPECT_NEAR(model.joint_hz, std::sqrt(kTendon / kJoint) / (2.0 * kPi), 0.1);
  EXPECT_NEAR(model.joint_drag, kBrake / kJoint / (2.0 * std::sqrt(kTendon / kJoint)), 0.005);
  EXPECT_LT(model.share_left, 0.02);
}

TEST(Tuning, AChirpOrAShakenReferenceGivesNoGains) {
  const Motor motor;
  Response response = motor.response(gentle());
  response.multisine = false;
  EXPECT_THROW(static_cast<void>(tune(response, gentle(), {})), Refusal);
  response.multisine = true;
  response.on_torque = false;
  EXPECT_THROW(static_cast<void>(tune(response, gentle(), {})), Refusal);
}

TEST(Tuning, AMarginIsTakenFromGainBothWaysAndFromTheCircle) {
  // -0.5 at a phase of 180 deg: 6.02 dB; with a circle of 0.1, 20 log10(0.6).
  std::vector<LoopPoint> loop;
  for (int i = 0; i <= 200; ++i) {
    const double turn = -kPi * (0.5 + 0.005 * i);
    loop.push_back({1.0 + i, std::polar(2.0 * std::pow(0.5, i / 50.0), turn), 0.1});
  }
  const Margins bare = margins_of(loop, false);
  EXPECT_NEAR(bare.gain_db, 6.02, 0.05);
  EXPECT_NEAR(bare.phase_deg, 45.0, 0.1) << "a gain of 1 at -135 deg";
  const Margins worst = margins_of(loop);
  EXPECT_NEAR(worst.gain_db, -20.0 * std::log10(0.6), 0.05);
  EXPECT_NEAR(worst.phase_deg, 45.0 - std::asin(0.1) * 180.0 / kPi, 0.1);
}

TEST(Tuning, ADumpGivesTheGainsAndAnotherTextIsRefused) {
  const LoopGains gains = read_gains(
      "begin\nset joint1.control.kp 0.3\nset joint0.control.kp 0.7\nset joint1.control.stiffness 1.5 Nm/rad\n"
      "set joint1.control.rate_time_constant 0.004 s\nset joint1.motor.torque_per_current 0.05 Nm/A\n"
      "set joint1.limits.continuous_current 2 A\ncommit\n",
      1);
  EXPECT_EQ(gains.kp, 0.3);
  EXPECT_EQ(gains.stiffness, 1.5);
  EXPECT_EQ(gains.rate_time_constant_s, 0.004);
  EXPECT_NEAR(gains.continuous_nm, 0.1, 1e-12);
  EXPECT_THROW(static_cast<void>(read_gains("hello", 0)), BadInput);
  for (const char* wrong : {"much", "nan", "inf", "-1"}) {
    EXPECT_THROW(static_cast<void>(read_gains(std::string("set joint0.control.kp ") + wrong, 0)), BadInput) << wrong;
  }
}

TEST(Tuning, ThePageShowsBodeAndNyquist) {
  const Motor motor;
  const LoopGains present = gentle();
  const Response response = motor.response(present);
  const std::string path =
      write_response_report(testing::TempDir() + "response_report", response, tune(response, present, {}), 2);
  const std::string page = read_text_file(path);
  for (const char* words : {"Motor angle per torque: gain", "Coherence", "Nyquist", "set joint2.control.stiffness"}) {
    EXPECT_NE(page.find(words), std::string::npos) << words;
  }
}

}  // namespace
}  // namespace capstan::tools
