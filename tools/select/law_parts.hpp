// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/tools/select/effort_design.hpp"

namespace capstan::tools {

/// Something that a law may be given as a whole: some coefficients of a term, and the settings of its shapes that are
/// worth trying. Settings are shares of the log's own ranges, so that no choice depends on units.
struct LawPart {
  std::string term;
  std::vector<std::size_t> coefficients;
  std::vector<Shapes> settings;
  std::string needs = {};  ///< a term without which it is none of its own
};

/// How far the logs reach: what shapes are shares of.
struct MotionRanges {
  double lowest = 0.0, highest = 0.0;  ///< of the motor angle
  double speed = 0.0;                  ///< exceeded in 1 % of the samples
  double torque = 0.0;                 ///< the motor's; 0 where it is no input
  bool many_places = true;             ///< the motor was at enough places to tell periods of its angle

  [[nodiscard]] auto centre() const -> double { return 0.5 * (lowest + highest); }
  [[nodiscard]] auto half() const -> double { return 0.5 * (highest - lowest); }
};

auto motion_ranges(const EffortDesign& design) -> MotionRanges;

/// Parts of a law of an effort, those of rigid dynamics (inertia, viscous and Coulomb friction, offset) first.
/// @param others  axes whose motion is known
auto effort_parts(const MotionRanges& ranges, const std::vector<KnownAxis>& others, AxisKind axis)
    -> std::vector<LawPart>;
/// Parts of a law of the torque behind a gear, gain and offset first.
auto gear_parts(const MotionRanges& ranges) -> std::vector<LawPart>;

/// How many parts at the front a law begins with.
inline constexpr std::size_t kRigidParts = 4;
inline constexpr std::size_t kGearBaseParts = 2;

}  // namespace capstan::tools
