// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "hal/sim/motion.hpp"
#include "hal/sim/parameters.hpp"
#include "hal/sim/sensors.hpp"

namespace capstan::sim {

/// "file:line: sentence; cure".
class ScenarioError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// One run: the plant (effects included), what fails when, what the joint is asked to do.
struct Scenario {
  std::string name;
  std::uint64_t seed = 1;
  PlantParameters plant;
  std::vector<Fault> faults;
  std::vector<std::string> shell;  ///< lines for the firmware's shell before the motion
  Motion motion;
  double duration_s = 0.0;  ///< as given, otherwise the motion's
};

/// Reads a scenario. `base = "other.toml"` begins with all that another one says; lists given here replace the base's.
/// `instrument = "name.toml"` is looked for beside the scenario, then in `instruments_folder`, then among the
/// instruments built in (micro_forceps). Throws ScenarioError.
[[nodiscard]] Scenario load_scenario(const std::filesystem::path& file,
                                     const std::filesystem::path& instruments_folder = {});

/// The same from text; `file` is only named in errors and gives the folder.
[[nodiscard]] Scenario parse_scenario(std::string_view text, const std::filesystem::path& file,
                                      const std::filesystem::path& instruments_folder = {});

/// Applies "play=0.03" or "play.half_width_rad=0.03", as on the command line. Throws ScenarioError without a line
/// number.
void override_effect(Scenario& scenario, std::string_view assignment);

}  // namespace capstan::sim
