// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/tools/identify/term_catalogue.hpp"

namespace capstan::tools {

/// Axes of a log whose motion may act on a joint's effort: axis0 to axis7.
inline constexpr int kMostCouplingAxes = 8;

/// Everything that a law of an effort may be grown from: effort_catalogue() with the terms that measured machines need.
/// A term that a law may hold more than once has further places, "angle_periodic_2"; what another joint's motion brings
/// is "axis_coupling_axis<N>" and is a term of that joint's samples (CatalogueTerm::of_axis).
auto effort_law_catalogue(AxisKind axis) -> const Catalogue&;

/// The same for the torque behind a gear, from the motor's torque: gain, load friction and saturation first, then what
/// an effort may hold, with any sign.
auto gear_law_catalogue() -> const Catalogue&;

/// The effect's name by the contract: without the number of its place or axis.
auto effect_name(const std::string& term) -> std::string;

}  // namespace capstan::tools
