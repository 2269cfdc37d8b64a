// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/diagnose/torque_gauge.hpp"

#include <algorithm>
#include <cmath>

#include "capstan/tools/identify/loop.hpp"
#include "capstan/tools/select/deciding_numbers.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

auto text_of(const EffectSize& size) -> std::string {
  if (!size.ci95) {
    return rounded(size.value, 2) + " " + size.unit + " or less";
  }
  return with_interval(size.value, (*size.ci95)[0], (*size.ci95)[1], 3) + " " + size.unit;
}

auto shows_spring(const TorqueChange& change) -> bool {
  return change.spring_over_weight < kLoadTold;
}

/// A torque that hangs on the joint's angle: a weight has a name, a tip in contact has none.
/// @param weight  its size, if it is one
auto load_at_joint(const TorqueChange& change, const EffectSize& weight, double beta) -> TorqueFinding {
  const double share = change.share_of(TorqueCause::kWeight);
  const std::string cure = "; free the tip to see the joint itself";
  if (shows_spring(change)) {
    const double value = change.spring_nm_per_rad / beta;
    const double half = std::abs(change.spring_95 / beta);
    const EffectSize size{value, "Nm/rad", Interval{value - half, value + half}};
    return {"", size, "a spring of " + text_of(size) + " at the joint and no weight, as a tip in contact has" + cure,
            share};
  }
  if (0.5 * ((*weight.ci95)[1] - (*weight.ci95)[0]) > kWeightUnsure * std::abs(weight.value)) {
    return {
        "", weight,
        "a load at the joint that is none that a weight of one size has, as where a tip touches now and then" + cure,
        share};
  }
  const std::string also =
      change.spring_over_weight * kLoadTold < 1.0
          ? ", or of what a tip in contact pulls like a spring: this motion does not tell them apart, and one with the "
            "tip free, or to larger angles, does"
          : "";
  return {"gravity", weight, "a weight of " + text_of(weight) + " times sin q2 at the joint" + also, share};
}

/// At the joint: its torque is the motor's over beta, its speed the motor's times beta.
auto finding(TorqueCause cause, const TorqueChange& change, double beta) -> TorqueFinding {
  const auto at = static_cast<std::size_t>(cause);
  const auto size_by = [&](double gain, const char* unit, double known = 0.0) -> EffectSize {
    const double value = change.size[at] / gain;
    const double half = std::hypot(change.size_95[at] / gain, known * value);
    return {value, unit, Interval{value - half, value + half}};
  };
  const auto told = [&](const char* name, const EffectSize& size, const std::string& what,
                        const std::string& where) -> TorqueFinding {
    return {name, size, what + text_of(size) + where, change.share[at]};
  };
  switch (cause) {
    case TorqueCause::kWeight:
      return load_at_joint(change, size_by(beta, "Nm"), beta);
    case TorqueCause::kMass:
      return told("load_inertia", size_by(beta * beta, "kgm2", kMassKnown), "a mass of ", " at the joint");
    case TorqueCause::kDrag:
      return told(kDragTerm, size_by(1.0, "Nms/rad"), "drag of ", " at the motor");
    case TorqueCause::kBristle:
      return told("presliding", size_by(beta, "Nm"), "friction of ",
                  " at the joint that bends over " + rounded(std::abs(beta) * change.bristle_way_rad, 2) +
                      " rad before it slides");
    case TorqueCause::kFriction:
      break;
  }
  return {"", {}, "", change.share[at]};
}

}  // namespace

auto torque_has_changed(const TorqueChange& change, double friction_nm) -> bool {
  return change.rms_nm >= kTorqueTold * std::abs(friction_nm);
}

auto found_in_torque(const TorqueChange& change, double friction_nm, double beta) -> std::optional<TorqueFinding> {
  const auto is_certain = [&](TorqueCause cause) {
    const auto at = static_cast<std::size_t>(cause);
    return change.size[at] > change.size_95[at];
  };
  if (!torque_has_changed(change, friction_nm)) {
    return std::nullopt;
  }
  const double slides = change.share_of(TorqueCause::kFriction);
  const double bending = change.share_of(TorqueCause::kBristle);
  const bool bends = bending > kBendsShare && bending > slides + kBendsBeyond &&
                     1.0 - bending < kBendsLeaves * (1.0 - slides) && bending > change.share_of(TorqueCause::kDrag);
  if (bends && is_certain(TorqueCause::kBristle)) {
    return finding(TorqueCause::kBristle, change, beta);
  }
  for (const TorqueCause cause : {TorqueCause::kWeight, TorqueCause::kMass, TorqueCause::kDrag}) {
    const bool told = cause == TorqueCause::kWeight || is_certain(cause);  // weight may pull either way
    const double share = change.share_of(cause);
    const bool is_friction = share < slides + kBeyondFriction && 1.0 - share > kBendsLeaves * (1.0 - slides);
    if (told && share > kTorqueCauseShare && !is_friction) {
      return finding(cause, change, beta);
    }
  }
  return std::nullopt;
}

auto contradicted_by_torque(const std::string& name, const TorqueChange& change, double friction_nm) -> bool {
  const bool changed = torque_has_changed(change, friction_nm);
  const double more = change.size_of(TorqueCause::kFriction) / friction_nm;
  if (name == "gravity") {
    return !changed || change.share_of(TorqueCause::kWeight) < kTorqueCauseShare || shows_spring(change);
  }
  if (name == "load_inertia") {
    return !changed || change.share_of(TorqueCause::kMass) < kTorqueCauseShare;
  }
  if (name == kDragTerm) {
    return changed && change.share_of(TorqueCause::kDrag) < change.share_of(TorqueCause::kFriction);
  }
  if (name == kPretensionTerm || name == kHardeningTerm) {
    const double by_friction = change.share_of(TorqueCause::kFriction);
    const double rest = change.rms_nm * std::sqrt(std::max(0.0, 1.0 - by_friction));
    return by_friction < kPretensionShare && rest >= kTorqueTold * std::abs(friction_nm);
  }
  if (name == "viscoelastic_creep") {  // which lets tension go
    return changed && more > 0.0;
  }
  return name == "angle_periodic" && std::abs(more) > kAngleErrorTorque;
}

auto friction_has_changed(const TorqueChange& change, double friction_nm) -> bool {
  return torque_has_changed(change, friction_nm) && change.share_of(TorqueCause::kFriction) > kTorqueCauseShare;
}

}  // namespace capstan::tools
