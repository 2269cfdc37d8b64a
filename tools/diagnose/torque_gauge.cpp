// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/diagnose/torque_gauge.hpp"

#include <algorithm>
#include <cmath>

#include "capstan/tools/select/deciding_numbers.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

auto within(double value, double half, const std::string& unit) -> std::string {
  return rounded(value, 3) + " +- " + rounded(half, 2) + " " + unit;
}

/// At the joint: its torque is the motor's over beta, its speed the motor's times beta.
auto finding(TorqueCause cause, const TorqueChange& change, double beta) -> TorqueFinding {
  const auto at = static_cast<std::size_t>(cause);
  const double share = change.share[at];
  const auto at_joint = [&](double gain, const char* unit) {
    return within(change.size[at] / gain, change.size_95[at] / std::abs(gain), unit);
  };
  switch (cause) {
    case TorqueCause::kWeight:
      return {"gravity", "the weight is " + at_joint(beta, "Nm") + " times sin q2, at the joint", share};
    case TorqueCause::kMass:
      return {"load_inertia", "the mass is " + at_joint(beta * beta, "kgm2") + ", at the joint", share};
    case TorqueCause::kDrag:
      return {"transmission_viscous", "the drag is " + at_joint(1.0, "Nms/rad") + ", at the motor", share};
    case TorqueCause::kBristle:
      return {"presliding",
              "the friction that bends first is " + at_joint(beta, "Nm") + ", at the joint, and slides after " +
                  rounded(std::abs(beta) * change.bristle_way_rad, 2) + " rad from the other side",
              share};
    case TorqueCause::kFriction:
      break;
  }
  return {"", "", share};
}

}  // namespace

auto found_in_torque(const TorqueChange& change, double friction_nm, double beta) -> std::optional<TorqueFinding> {
  const auto share = [&](TorqueCause cause) { return change.share[static_cast<std::size_t>(cause)]; };
  const auto is_certain = [&](TorqueCause cause) {
    const auto at = static_cast<std::size_t>(cause);
    return change.size[at] > change.size_95[at];
  };
  if (change.rms_nm < kTorqueTold * friction_nm) {
    return std::nullopt;
  }
  const double slides = share(TorqueCause::kFriction);
  const bool bends = share(TorqueCause::kBristle) > kBendsShare && share(TorqueCause::kBristle) > slides + kBendsBeyond;
  if (bends && is_certain(TorqueCause::kBristle)) {
    return finding(TorqueCause::kBristle, change, beta);
  }
  for (const TorqueCause cause : {TorqueCause::kWeight, TorqueCause::kMass, TorqueCause::kDrag}) {
    const bool told = cause == TorqueCause::kWeight || is_certain(cause);  // weight may pull either way
    if (told && share(cause) > kTorqueCauseShare && share(cause) > slides + kBendsBeyond) {
      return finding(cause, change, beta);
    }
  }
  return std::nullopt;
}

}  // namespace capstan::tools
