// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>

#include "capstan/tools/identify/conditioning.hpp"
#include "capstan/tools/identify/torque_parts.hpp"

namespace capstan::tools {

/// Logs of which every one has torque and joint angle, and their samples.
struct TorqueLogs {
  const std::vector<AxisLog>& logs;
  const std::vector<Samples>& samples;
  double half_width_rad;  ///< of the loop between motor and joint, at the motor: rows within it take no part
  double beta = 1.0;      ///< joint angle per motor angle; counts for a mass alone, as the next does
  double late_s = 0.0;    ///< by which the joint's sensor is later than the motor's
};

/// What the motor's torque is made of; nothing where too little of the motion goes through the loop.
auto torque_parts(const TorqueLogs& from) -> std::optional<TorqueParts>;

/// What alone could have changed a joint's torque.
enum class TorqueCause : std::uint8_t {
  kFriction,  ///< the same everywhere
  kWeight,    ///< hangs on the joint's angle, whichever way it moves
  kMass,      ///< in phase with the acceleration
  kDrag,      ///< in phase with the speed
  kBristle,   ///< friction that has to bend before it slides: it comes over a way
};
inline constexpr std::size_t kTorqueCauses = 5;

/// How the torque differs from that of the healthy joint's parts, but for a constant.
struct TorqueChange {
  double rms_nm = 0.0;
  std::array<double, kTorqueCauses> share{};    ///< of its energy that each cause takes away alone
  std::array<double, kTorqueCauses> size{};     ///< Nm, but kgm2 of a mass and Nms/rad of drag; at the motor
  std::array<double, kTorqueCauses> size_95{};  ///< half width of its interval
  double bristle_way_rad = 0.0;                 ///< at the motor, until it slides
  /// What a spring at the joint leaves of it, rms, over what a weight does, either beside friction that goes with its
  /// load: a tip in contact pulls like a spring. 1: this motion does not tell them apart.
  double spring_over_weight = 1.0;
  double spring_nm_per_rad = 0.0;  ///< at the motor, per angle of the joint
  double spring_95 = 0.0;

  [[nodiscard]] auto share_of(TorqueCause cause) const -> double { return share[static_cast<std::size_t>(cause)]; }
  [[nodiscard]] auto size_of(TorqueCause cause) const -> double { return size[static_cast<std::size_t>(cause)]; }
};
auto torque_change(const TorqueLogs& now, const TorqueParts& healthy) -> std::optional<TorqueChange>;

/// Amplitude, Nm, of the change that repeats `order` times a turn of the motor; 0 where there is no torque to ask.
auto periodic_torque(const TorqueLogs& now, const TorqueParts& healthy, double order) -> double;

}  // namespace capstan::tools
