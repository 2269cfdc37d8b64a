// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "capstan/firmware/parameters/config.hpp"
#include "capstan/firmware/safety/supervisor.hpp"
#include "capstan/tools/campaign/fault_modes.hpp"
#include "capstan/tools/campaign/hazard.hpp"

namespace capstan::tools {

/// A joint of the campaign: the simulated one, and how its firmware is set.
struct JointSetup {
  sim::PlantParameters plant;
  AxisConfig config;
  double amplitude_rad = 0.3;  ///< of its motions
};
/// Without what commissioning finds.
[[nodiscard]] auto plain_setup(Joint joint) -> JointSetup;
/// Of kJoints: commissioned when it is first asked for.
[[nodiscard]] auto setup_of(Joint joint) -> const JointSetup&;

/// One run from rest to some time after an onset.
struct Scene {
  Joint joint{};
  Situation situation{};
  int phase = 0;  ///< of kPhases, where the motion is at the onset
};
struct Trouble {
  OneFault first;
  std::optional<OneFault> second = {};  ///< 50 ms later
  bool cut_at_onset = false;            ///< torque off by hand at the onset: what no firmware can better
};

/// What became of the firmware and of the true joint.
struct RunResult {
  Course course;  ///< from the onset until the joint stood
  State end = State::kDisarmed;
  Fault fault = Fault::kNone;  ///< what took the torque or blocks it
  int detected_ms = -1;        ///< after the onset; 1: in the first cycle that could see it
  int off_after_cycles = -1;   ///< from the detecting cycle to the first drive without torque; 0: in the same cycle
  bool blocked = false;        ///< arming was refused
  bool torque_returned = false;
};

/// How long a run is watched after the onset.
inline constexpr int kObservedCycles = 1500;

/// The firmware in closed loop with the simulated joint. Without trouble: the healthy twin.
[[nodiscard]] auto run_scene(const Scene& scene, const std::optional<Trouble>& trouble) -> RunResult;

}  // namespace capstan::tools
