// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "capstan/tools/identify/law_fit.hpp"

namespace capstan::tools {

/// Names of the terms that change a loop, or how late the joint follows.
inline constexpr const char* kPlayTerm = "play";
inline constexpr const char* kPretensionTerm = "pretension_offset";
inline constexpr const char* kHardeningTerm = "stiffness_hardening";
inline constexpr const char* kDelayTerm = "transport_delay";
inline constexpr const char* kDragTerm = "transmission_viscous";

/// The loop between motor and joint that tendons draw under a free tip: half its width, at the motor, and the torque
/// that it takes, half the distance between both directions. Both tendons slide then before the joint moves, so its
/// angle is exactly play(q1), and the two numbers say what its shape can not: a gap widens the loop and takes no
/// torque, stiffer tendons narrow it, more pretension does both, and a torque that the tendons do not carry changes the
/// torque alone.
struct Loop {
  double half_width_rad = 0.0;
  double torque_nm = 0.0;
  std::optional<double> late_s = {};  ///< by which the joint's sensor is later than the motor's, if it was asked

  /// Torque of the motor under which the tendons stretch by so much at the motor: twice as much, per torque, as by
  /// their own friction, which makes the loop.
  [[nodiscard]] auto torque_stretching(double by_rad) const -> double {
    return by_rad * torque_nm / (2.0 * half_width_rad);
  }
};

/// Of a law with tendons: of the logs that it is from, or else as the law itself says. Nothing of another law, or of a
/// file without steady torque.
auto loop_of(const JointFile& joint) -> std::optional<Loop>;

/// The law that has a loop and nothing else, its width fitted from one that is known.
auto fit_loop(const LawDesign& design, const Eigen::VectorXd& target, const Blocks& rows, const Loop& known) -> LawForm;
auto half_width_of(const LawForm& loop) -> double;

/// A law with a loop, and how late the joint is fitted beside its width; other shapes as they are. Half a cycle of 1
/// ms, as drawn healthy joints have, makes the loop 0.7 % too wide, and a gap found from two widths 2 % too small
/// (joint 700, November 2026). A law with drag along the tendons is left without: the two look alike.
auto with_lateness(const LawDesign& design, const Eigen::VectorXd& target, const Blocks& rows, LawForm loop) -> LawForm;
/// 0 of a law without delay.
auto lateness_of(const LawForm& law) -> double;

auto friction_of(const SteadyTorque& torque) -> double;
/// Torque of the loop on these rows, where the motor has gone through its whole width since it turned, both tendons
/// sliding: small strokes do not say it. Nothing where no stroke is that long.
auto loop_torque(const LawDesign& design, const Blocks& rows, double half_width_rad) -> std::optional<double>;

}  // namespace capstan::tools
