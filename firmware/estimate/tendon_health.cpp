// SPDX-License-Identifier: Apache-2.0
#include "capstan/firmware/estimate/tendon_health.hpp"

namespace capstan {
namespace {

// Of the healthy joint's, below which the tendons can not pull any more.
constexpr Q24 kSlackShare = Q24::from_double(1.0 / 3.0);
// Of it, a change that has to be there before the tendons are its cause: a weight, a bend that came or a warmer day
// changes what the motor feels by less, and is none of theirs.
constexpr Q24 kLeastChange = Q24::from_double(0.1);
constexpr Q24 kMostShare = Q24::from_int(8);

/// Of the tendons' friction; what rubs beside them, the motor and the joint, does not go with their tension.
auto tension_of(const TendonJudge::Stretch& stretch, Q24 tendons_nm) -> Q24 {
  const Q24 healthy =
      stretch.healthy_nm > Q24{} && tendons_nm > Q24{} ? tendons_nm : stretch.healthy_nm - stretch.motors_nm;
  const Q24 now = healthy + (stretch.friction_nm - stretch.healthy_nm);
  if (healthy <= Q24{} || now <= Q24{}) {
    return Q24{};
  }
  return now >= kMostShare * healthy ? kMostShare : now / healthy;
}

}  // namespace

auto TendonJudge::rt_cause(const MonitorConfig& config, const Stretch& stretch, WarningSet warnings) const
    -> TendonHealth {
  constexpr auto kFriction = static_cast<WarningSet>(bit(Warning::kFrictionHigher) | bit(Warning::kFrictionLower));
  const Q24 allowed_nm = config.excess * config.torque_rms_nm;
  const Q24 allowed_rad = config.excess * config.joint_rms_rad;
  const Q24 less = stretch.healthy_nm - stretch.friction_nm;
  const Q24 shift = abs(stretch.shifted_rad);
  const bool moved = stretch.has_joint && config.joint_rms_rad > Q24{} && shift > allowed_rad;
  const bool rubs_otherwise =
      (warnings & kFriction) != 0 && stretch.healthy_nm > Q24{} && abs(tension_ - Q24::from_int(1)) > kLeastChange;
  if (rubs_otherwise && less > allowed_nm) {
    // Both tendons alike shift the zero by a part of what they take from the loop, one alone by as much as that.
    const bool one_alone = moved && (shift + shift) * stretch.healthy_nm > loop_rad_ * less;
    if (tension_ < kSlackShare) {
      return one_alone ? TendonHealth::kBroken : TendonHealth::kSlack;
    }
    return one_alone ? TendonHealth::kFrayed : TendonHealth::kLoose;
  }
  if (rubs_otherwise && less < -allowed_nm) {
    return TendonHealth::kWorn;
  }
  // A zero that moves within a stretch makes the ways differ too, but by less.
  const bool zero = moved && shift >= abs(stretch.wider_rad);
  if (!stretch.has_joint || (warnings & bit(Warning::kLawMisfit)) == 0) {
    return TendonHealth::kNothing;
  }
  if (!zero && stretch.wider_rad > allowed_rad) {
    return TendonHealth::kPlay;
  }
  if (!moved) {
    return TendonHealth::kNothing;
  }
  const bool again = health_ == TendonHealth::kZeroMoved && abs(stretch.shifted_rad - moved_rad_) > allowed_rad;
  return again || health_ == TendonHealth::kSlips ? TendonHealth::kSlips : TendonHealth::kZeroMoved;
}

void TendonJudge::rt_judge(const MonitorConfig& config, const Stretch& stretch, WarningSet warnings) {
  tension_ = tension_of(stretch, config.tendon_friction_nm);
  pretension_n_ = tension_ * config.pretension_n;
  pretension_95_n_ = tension_ * config.pretension_95_n;
  if (warnings == 0 || loop_rad_ == Q24{}) {
    loop_rad_ = stretch.loop_rad;
  }
  const TendonHealth cause = rt_cause(config, stretch, warnings);
  // A change may lie within a stretch, so it takes two.
  if (cause == last_ && cause != TendonHealth::kNothing && cause != health_) {
    health_ = cause;
    moved_rad_ = stretch.shifted_rad;
  }
  last_ = cause;
}

}  // namespace capstan
