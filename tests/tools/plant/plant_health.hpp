// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "capstan/firmware/estimate/tendon_health.hpp"
#include "capstan/firmware/safety/warnings.hpp"
#include "capstan/hal/sim/parameters.hpp"
#include "capstan/tools/joint_file/joint_file.hpp"

namespace capstan::tools::plant {

/// What is done to the tendons of a joint that a board moves and watches.
struct TendonFault {
  std::string name;
  TendonHealth cause;  ///< what the board has to say with a joint sensor
  TendonHealth blind;  ///< and by the motor's torque alone
};
auto tendon_faults() -> const std::vector<TendonFault>&;

/// What a board said of it.
struct HealthAnswer {
  TendonHealth health = TendonHealth::kNothing;  ///< at the end
  double after_s = -1.0;                         ///< from the onset until the last change of it
  double tension = 0.0;                          ///< at the end, as the board says it
  double true_tension = 1.0;                     ///< pretension that is left, where only that changes
  double pretension_n = 0.0;                     ///< at the end, as the board says it
  double pretension_95_n = 0.0;
  WarningSet warnings = 0;
};

/// A joint with the law that its own healthy log gave.
class WatchedJoint {
 public:
  /// @param model  of the law: pseudo_kinematic or tendon. Throws Refusal where the firmware stops or no law comes out.
  WatchedJoint(sim::PlantParameters plant, std::uint64_t seed, const std::string& model);
  /// With a law that is at hand.
  WatchedJoint(sim::PlantParameters plant, std::uint64_t seed, const JointFile& joint);
  /// 20 s of healthy motion and `seconds` more with the fault; swings whose amplitude and middle wander. Sizes are
  /// drawn by `seed`. @param fault  empty: healthy to the end
  [[nodiscard]] auto watch(const std::string& fault, bool joint_sensor, double seconds, std::uint64_t seed) const
      -> HealthAnswer;

 private:
  sim::PlantParameters plant_;
  std::vector<std::string> lines_;
  double error_rms_rad_ = 0.0;
};

}  // namespace capstan::tools::plant
