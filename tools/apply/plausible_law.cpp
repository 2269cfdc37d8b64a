// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/apply/plausible_law.hpp"

#include <algorithm>
#include <cmath>

#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

/// Of a stroke: what runs against its direction. A tenth is twice what the curve of a ratio at its least slope, a
/// cogging of 5 % and a stretch that turns with the torque leave of a stroke in the tests' laws (2026-11-22).
constexpr double kMostAgainst = 0.1;
/// Of the joint's range in the logs: further is no motion that they showed. Also how far away its zero may be.
constexpr double kMostTimes = 10.0;

struct Stroke {
  double way = 0.0;      ///< of the joint, from end to end, with its sign
  double against = 0.0;  ///< run in the other direction
  double behind = 0.0;   ///< of that, behind the lost motion
  double low = 0.0, high = 0.0;
};

/// One slow stroke of the motor, the law going on from where it is.
/// @param lost_rad  the stroke's beginning, in which the motor crosses the law's lost motion. The torque turns there
///                  with the motor's way, here at once, and what the tendons stretch by it is no motion of the joint.
auto stroke_of(MotionLaw<double>& law, Interval motor, double torque, double lost_rad) -> Stroke {
  constexpr int kSteps = 4000;
  const auto& [from, to] = motor;
  const double begin = law.update(from, torque).q2;
  Stroke stroke{.low = begin, .high = begin};
  double rises = 0.0;
  double falls = 0.0;
  double rises_behind = 0.0;
  double falls_behind = 0.0;
  double before = begin;
  for (int i = 1; i <= kSteps; ++i) {
    const double gone = (to - from) * i / kSteps;
    const double angle = law.update(from + gone, torque).q2;
    (angle > before ? rises : falls) += std::abs(angle - before);
    if (std::abs(gone) > lost_rad) {
      (angle > before ? rises_behind : falls_behind) += std::abs(angle - before);
    }
    stroke.low = std::min(stroke.low, angle);
    stroke.high = std::max(stroke.high, angle);
    before = angle;
  }
  stroke.way = before - begin;
  stroke.against = stroke.way > 0.0 ? falls : rises;
  stroke.behind = stroke.way > 0.0 ? falls_behind : rises_behind;
  return stroke;
}

/// A crossed transmission is one, but then its logs said so: a sign that was changed afterwards has an interval on the
/// other side of zero.
auto is_turned_round(const JointFile& joint) -> bool {
  const auto& ci95 = joint.coefficient_ci95[joint.catalogue->term("motor_angle").first_coefficient];
  return ci95 && (beta_of(joint) < 0.0 ? (*ci95)[0] > 0.0 : (*ci95)[1] < 0.0);
}

}  // namespace

auto implausible(const JointFile& joint) -> std::string {
  const LawParameters<double> parameters = motion_parameters(joint);
  const auto range = joint.fit ? joint.fit->motor_range : std::nullopt;
  const Interval motor = range.value_or(Interval{-1.0, 1.0});
  const SteadyTorque torque = joint.steady_torque.value_or(SteadyTorque{});
  if (torque.forward_nm < torque.backward_nm) {
    return "its steady torque is less forward than backward, so friction would push the joint on";
  }
  if (is_turned_round(joint)) {
    return "its joint would move in the other direction than in the logs: beta is " + rounded(beta_of(joint), 3) +
           ", and its own interval lies on the other side of zero";
  }
  MotionLaw<double> law(SamplePeriod<double>(0.001), parameters);
  const double lost_rad = law.lost_motion(torque.backward_nm, torque.forward_nm);
  stroke_of(law, motor, torque.forward_nm, lost_rad);  // until nothing of the start is left
  const Stroke back = stroke_of(law, {motor[1], motor[0]}, torque.backward_nm, lost_rad);
  const Stroke forth = stroke_of(law, motor, torque.forward_nm, lost_rad);
  const double beta = law.beta();
  if (!joint.fit && std::abs(beta) > kMostTimes) {
    return "its joint goes " + rounded(beta, 3) +
           " times as far as its motor, and a file without [fit] does not say that " + "it did so in any log";
  }
  const std::string over =
      "over the motor's " + rounded(motor[0], 3) + " to " + rounded(motor[1], 3) + " rad the joint would ";
  for (const auto& [stroke, sign] : {std::pair(forth, 1.0), std::pair(back, -1.0)}) {
    const double wanted = stroke.way * sign * (beta < 0.0 ? -1.0 : 1.0);
    if (wanted <= 0.0 || stroke.behind > kMostAgainst * (std::abs(stroke.way) + stroke.against)) {
      return over + "run against its motor for " + rounded(wanted <= 0.0 ? std::abs(stroke.way) : stroke.against, 2) +
             " rad of " + rounded(std::abs(stroke.way) + stroke.against, 2);
    }
  }
  const double way = std::max(forth.high, back.high) - std::min(forth.low, back.low);
  const double farthest =
      std::max({std::abs(forth.low), std::abs(forth.high), std::abs(back.low), std::abs(back.high)});
  if (farthest > kMostTimes * (way + std::abs(beta) * std::max(std::abs(motor[0]), std::abs(motor[1])))) {
    return over + "be as far as " + rounded(farthest, 3) + " rad from zero, and move over " + rounded(way, 3) +
           " there: the law's joint_offset causes this";
  }
  if (range && joint.fit->joint_range > 0.0 && way > kMostTimes * joint.fit->joint_range) {
    return over + "go " + rounded(way, 3) + " rad, and in the logs it went " + rounded(joint.fit->joint_range, 3);
  }
  return {};
}

}  // namespace capstan::tools
