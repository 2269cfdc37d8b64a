// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "capstan/tools/diagnose/diagnosis.hpp"
#include "capstan/tools/identify/torque_balance.hpp"

namespace capstan::tools {

/// What has come to a joint, by its motor's torque alone: tendons carry it, so the joint's angle hardly shows it.
struct TorqueFinding {
  std::string name;      ///< of the catalogue; empty: a load at the joint that is no weight
  EffectSize size;       ///< at the joint; of drag at the motor
  std::string sentence;  ///< how large it is, for people
  double share;          ///< of the change's energy that it takes away
};

/// @param friction_nm  of the healthy joint, negative where its torque is counted the other way
/// @param beta  joint angle per motor angle
auto found_in_torque(const TorqueChange& change, double friction_nm, double beta) -> std::optional<TorqueFinding>;

/// Whether the torque is another than the healthy joint's.
auto torque_has_changed(const TorqueChange& change, double friction_nm) -> bool;

/// Whether the motor's torque says that it can not be this effect, which the joint's angle alone would have: a weight
/// or a mass of which it shows nothing, or a friction that has not changed as that effect changes it.
auto contradicted_by_torque(const std::string& name, const TorqueChange& change, double friction_nm) -> bool;

/// Tendons of another friction: they are longer, shorter or worn, and have not slipped.
auto friction_has_changed(const TorqueChange& change, double friction_nm) -> bool;

}  // namespace capstan::tools
