// SPDX-License-Identifier: Apache-2.0
// The steps of commissioning in which a person lends a hand: a known angle for the counts, a known weight for the
// torque.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "capstan/tools/commission/steps.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

constexpr double kTurnRad = 2.0 * std::numbers::pi;

// Numbers that decide, from what a hand and a scale can do (November 2026), not from logs; wrong counts and data sheets
// are off by a half or more.
constexpr double kHandRad = 3.0 * std::numbers::pi / 180.0;  // a mark that a hand turns to
constexpr double kLeastHandShare = 0.01;
constexpr double kJointHandShare = 0.2;  // a joint that a hand turns bends its tendons before the motor follows
constexpr double kFewestCounts = 16.0;   // of an encoder that counts a turn by hand
// Present counts times these: right, or of edges that are counted or are not.
constexpr std::array kFactors = {1.0, 0.125, 0.25, 0.5, 2.0, 4.0, 8.0};
constexpr double kLetGoShare = 0.15;  // by which a motor that is let go springs back: 0.07 rad of 1 (forceps 4476)

constexpr double kWeighReach = 0.6;      // of the corridor, as in `travel`
constexpr double kFrictionShare = 0.02;  // by which friction changes from one slow motion to the next: 0.99 to 1.02
constexpr double kWeightShare = 0.05;    // of a weight and an arm that a person measures
constexpr double kLeastLoad = 0.2;       // of friction, by which the weight has to change the torque ...
// ... and at most may: one tendon goes slack at 1 / (e^eta - 1) of it, 0.47 on the forceps, and then passes more on.
constexpr double kMostLoad = 0.45, kGoodLoad = 0.35;

auto degrees(double rad) -> std::string {
  return rounded(rad * 360.0 / kTurnRad, 4) + " deg";
}

}  // namespace

void CommissionSteps::require_done(const std::string& question) {
  if (!person_.agrees(question)) {
    throw Stopped();
  }
}

void CommissionSteps::turn(CommissionSteps& steps) {
  JointConsole& joint = steps.joint_;
  const HandTurn& hand = *steps.options_.turn;
  const std::string what = hand.of_joint ? joint.name() : "the motor's pulley of " + joint.name();
  const double motor_rad = hand.of_joint ? hand.angle_rad / joint.value("motor_angle.beta") : hand.angle_rad;
  const double began = steps.motor_here();
  steps.require_done("turn " + what + " by hand by " + degrees(hand.angle_rad) +
                     ", in the direction in which its angle is to grow, and hold it there: done?");
  const double there = steps.motor_here() - began;
  steps.require_done("turn it back to where it was, and hold it: done?");
  const double back = began + there - steps.motor_here();
  const double counts = 0.5 * (there + back) / joint.count_rad();
  if (std::fabs(counts) < kFewestCounts) {
    throw Refusal("the encoder gave " + rounded(std::fabs(counts), 2) + " counts while " + what +
                  " was turned by hand: it is dead, not plugged in, or nothing was turned; check its cable and supply");
  }
  const double share =
      std::max(kLeastHandShare, kHandRad / std::fabs(hand.angle_rad)) + (hand.of_joint ? kJointHandShare : 0.0);
  if (std::fabs(there - back) > share * std::fabs(there + back)) {
    throw Refusal("the encoder gave " + rounded(there / joint.count_rad(), 4) + " counts there and " +
                  rounded(back / joint.count_rad(), 4) +
                  " back, so it loses counts, or it was not turned back to where it was; turn it once more, or check "
                  "the encoder's cable");
  }
  steps.judge_counts(counts * kTurnRad / motor_rad, share);
  steps.stood_rad_ = steps.here();
  steps.corridor_ = steps.corridor();
}

void CommissionSteps::judge_counts(double per_turn, double hand_share) {
  const std::string by_hand = "by hand the encoder counts " + rounded(std::fabs(per_turn), 4) +
                              " per turn of the motor's pulley (within " + rounded(100.0 * hand_share, 2) + " %)";
  if (per_turn < 0.0) {
    const std::string sign = rounded(-joint_.value("motor.encoder_sign"));
    require_done("the encoder counts against that direction; set motor.encoder_sign to " + sign + "?");
    decide("motor.encoder_sign", sign);
    find("motor.encoder_sign is " + sign + " now: the encoder counted against the direction");
  }
  const double counts = joint_.value("motor.encoder_counts");
  const double ratio = std::fabs(per_turn) / counts;
  const auto near = [ratio](double share) {
    return std::find_if(kFactors.begin(), kFactors.end(),
                        [&](double one) { return std::fabs(ratio / one - 1.0) <= share; });
  };
  const auto* const factor = near(hand_share);
  if (factor == kFactors.begin()) {
    find(by_hand + ", and motor.encoder_counts agrees: " + rounded(counts, 8));
    return;
  }
  if (factor == kFactors.end() && (options_.turn->of_joint || near(kLetGoShare) != kFactors.end())) {
    throw Refusal(by_hand + ", and motor.encoder_counts is " + rounded(counts, 8) +
                  ": neither right nor wrong by a factor. Turn the motor (--turn-motor) by more, and hold it at both "
                  "ends until you have answered, for tendons spring back; or compare the encoder's data sheet");
  }
  const std::string right = rounded(std::round(factor == kFactors.end() ? std::fabs(per_turn) : *factor * counts), 8);
  require_done(by_hand + ", and motor.encoder_counts is " + rounded(counts, 8) + "; set it to " + right + "?");
  decide("motor.encoder_counts", right);
  find(by_hand + "; motor.encoder_counts was " + rounded(counts, 8) + " and is " + right + " now" +
       (factor == kFactors.end() ? ", as near as a hand turns: take the encoder's data sheet if it says nearly that"
                                 : ""));
}

void CommissionSteps::weigh(CommissionSteps& steps) {
  const JointConsole& joint = steps.joint_;
  const Progress& known = steps.all_.progress;
  const double load = *steps.options_.weight_nm * std::fabs(joint.value("motor_angle.beta"));
  if (load > steps.continuous_nm()) {
    throw Refusal("a weight of " + rounded(*steps.options_.weight_nm, 3) + " Nm at the joint loads the motor with " +
                  rounded(load, 3) + " Nm, and it has " + rounded(steps.continuous_nm(), 3) +
                  " Nm continuously; take a lighter one, or a shorter arm");
  }
  steps.keep_to_corridor();
  steps.require_done("hang the weight on " + joint.name() + ", on an arm that is level at " +
                     rounded(steps.corridor_.middle, 3) +
                     " rad or by a thread from a drum, and support it if the joint does not hold it: done?");
  const SlowMotion with = [&steps] {
    try {
      return steps.slow_motion(kWeighReach * steps.corridor_.half);
    } catch (const Refusal& refusal) {
      throw Refusal("take the weight off; a lighter one may do: " + std::string(refusal.what()));
    }
  }();
  steps.require_done("take the weight off: done?");
  // Taut tendons of stiffness a and b pass the weight on by (a e^eta + b) / (a + b e^eta) forward, and by the
  // reciprocal of that backward: one to one where they are alike.
  const double forward = with.forward_nm - known.forward_nm;
  const double backward = with.backward_nm - known.backward_nm;
  const double shift = std::sqrt(std::max(0.0, forward * backward));
  const double friction = 0.5 * (known.forward_nm - known.backward_nm);
  const std::string changed = "the weight changed the torque by " + rounded(1e3 * shift, 2) + " mNm, ";
  const std::string about = "; take one about " + rounded(kGoodLoad * friction / std::max(shift, 1e-3 * friction), 2) +
                            " times as heavy, or an arm as much longer";
  if (shift < kLeastLoad * friction) {
    throw Refusal(changed + "which " + rounded(1e3 * friction, 2) + " mNm of friction hide" + about +
                  ", and hang it so that the joint carries it");
  }
  if (shift > kMostLoad * friction) {
    throw Refusal(changed + "beside " + rounded(1e3 * friction, 2) +
                  " mNm of friction: so heavy that a tendon may go slack" + about);
  }
  steps.judge_torque(load / shift, kWeightShare + kFrictionShare * friction / shift);
}

void CommissionSteps::judge_torque(double factor, double share) {
  const double present = joint_.value("motor.torque_per_current");
  const std::string right = rounded(factor * present, 4) + " Nm/A";
  const std::string weighed =
      "by the weight the torque per current is " + right + " (within " + rounded(100.0 * share, 2) + " %)";
  if (std::fabs(factor - 1.0) <= share) {
    find(weighed + ", and motor.torque_per_current agrees: " + joint_.text("motor.torque_per_current"));
    return;
  }
  require_done(weighed + ", and motor.torque_per_current is " + joint_.text("motor.torque_per_current") +
               "; set it to " + right + "?");
  joint_.restore();  // torques that were set for a while were of the other scale
  find(weighed + "; motor.torque_per_current was " + joint_.text("motor.torque_per_current") + " and is " + right +
       " now");
  decide("motor.torque_per_current", right);
  Progress& known = all_.progress;
  for (double* const torque : {&known.inertia_kgm2, &known.backward_nm, &known.forward_nm}) {
    *torque *= factor;  // all were told by the current
  }
  require_no_lighter(known.inertia_kgm2);
}

}  // namespace capstan::tools
