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
  double against = 0.0;  ///< of that, run in the other direction
  double low = 0.0, high = 0.0;
};

/// One slow stroke of the motor, the law going on from where it is.
auto stroke_of(MotionLaw<double>& law, double from, double to, double torque) -> Stroke {
  constexpr int kSteps = 4000;
  Stroke stroke;
  double forward = 0.0;
  double backward = 0.0;
  double before = law.update(from, torque).q2;
  stroke.low = stroke.high = before;
  for (int i = 1; i <= kSteps; ++i) {
    const double angle = law.update(from + (to - from) * i / kSteps, torque).q2;
    (angle > before ? forward : backward) += std::abs(angle - before);
    stroke.low = std::min(stroke.low, angle);
    stroke.high = std::max(stroke.high, angle);
    before = angle;
  }
  stroke.way = forward - backward;
  stroke.against = std::min(forward, backward);
  return stroke;
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
  MotionLaw<double> law(SamplePeriod<double>(0.001), parameters);
  stroke_of(law, motor[0], motor[1], torque.forward_nm);  // until nothing of the start is left
  const Stroke back = stroke_of(law, motor[1], motor[0], torque.backward_nm);
  const Stroke forth = stroke_of(law, motor[0], motor[1], torque.forward_nm);
  const double beta = law.beta();
  const std::string over =
      "over the motor's " + rounded(motor[0], 3) + " to " + rounded(motor[1], 3) + " rad the joint would ";
  for (const auto& [stroke, sign] : {std::pair(forth, 1.0), std::pair(back, -1.0)}) {
    const double wanted = stroke.way * sign * (beta < 0.0 ? -1.0 : 1.0);
    if (wanted <= 0.0 || stroke.against > kMostAgainst * (std::abs(stroke.way) + stroke.against)) {
      return over + "run against its motor for " + rounded(wanted <= 0.0 ? std::abs(stroke.way) : stroke.against, 2) +
             " rad of " + rounded(std::abs(stroke.way) + stroke.against, 2);
    }
  }
  const double way = std::max(forth.high, back.high) - std::min(forth.low, back.low);
  const double farthest =
      std::max({std::abs(forth.low), std::abs(forth.high), std::abs(back.low), std::abs(back.high)});
  if (farthest > kMostTimes * (way + std::abs(beta) * std::max(std::abs(motor[0]), std::abs(motor[1])))) {
    return over + "be as far as " + rounded(farthest, 3) + " rad from zero, and move over " + rounded(way, 3) +
           " there: joint_offset puts it there";
  }
  if (range && joint.fit->joint_range > 0.0 && way > kMostTimes * joint.fit->joint_range) {
    return over + "go " + rounded(way, 3) + " rad, and in the logs it went " + rounded(joint.fit->joint_range, 3);
  }
  return {};
}

}  // namespace capstan::tools
