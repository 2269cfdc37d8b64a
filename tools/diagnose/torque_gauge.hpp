// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "capstan/tools/diagnose/diagnosis.hpp"
#include "capstan/tools/identify/torque_balance.hpp"

namespace capstan::tools {

/// What has come to a joint, by its motor's torque alone: tendons carry it, so the joint's angle hardly shows it.
struct TorqueFinding {
  std::string name;      ///< of the catalogue
  EffectSize size;       ///< at the joint; of drag at the motor
  std::string sentence;  ///< how large it is, for people
  double share;          ///< of the change's energy that it takes away
};

/// @param friction_nm  of the healthy joint   @param beta  joint angle per motor angle
auto found_in_torque(const TorqueChange& change, double friction_nm, double beta) -> std::optional<TorqueFinding>;

}  // namespace capstan::tools
