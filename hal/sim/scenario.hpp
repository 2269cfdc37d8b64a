// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "capstan/hal/sim/faults.hpp"
#include "capstan/hal/sim/instrument.hpp"
#include "capstan/hal/sim/motion.hpp"
#include "capstan/hal/sim/parameters.hpp"

namespace capstan::sim {

/// "file:line: sentence; cure".
class ScenarioError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// An axis beyond the first.
struct OtherAxis {
  InstrumentAxis joint;  ///< effects and environment of the run included
  Motion motion;
};

/// One run: the plant (effects included), what fails when, what the joint is asked to do.
struct Scenario {
  std::string name;
  std::uint64_t seed = 1;
  PlantParameters plant;
  std::vector<Fault> faults;
  std::vector<std::string> shell;  ///< lines for the firmware's shell before the motion
  Motion motion;
  double duration_s = 0.0;  ///< as given, otherwise that of the longest motion

  // Of an instrument with several axes; `plant` and `motion` are the first one's.
  std::string axis_name = "joint0";
  std::vector<double> carried_radius_m;
  std::vector<OtherAxis> other_axes;
};

/// Whether supplies of the bench drive the motors with torques, instead of the firmware moving the joints.
[[nodiscard]] bool on_bench(const Scenario& scenario);

/// All axes, in order, for MultiPlant.
[[nodiscard]] std::vector<InstrumentAxis> axes_of(const Scenario& scenario);

/// Reads a scenario. `base = "other.toml"` begins with all that another one says; lists given here replace the base's.
/// `instrument = "name.toml"` is looked for beside the scenario, then in `instruments_folder`, then among the
/// instruments built in (built_in_instrument). [plant], [effects], [environment] and [motion] speak of the first axis;
/// [[axes]] with `axis = "name"` and these four of any. [torque] in place of [motion], in N m (amplitude_nm, points_nm,
/// ...), is what the motor gives: the instrument is then on the bench, all axes of it. Throws ScenarioError.
[[nodiscard]] Scenario load_scenario(const std::filesystem::path& file,
                                     const std::filesystem::path& instruments_folder = {});

/// The same from text; `file` is only named in errors and gives the folder.
[[nodiscard]] Scenario parse_scenario(std::string_view text, const std::filesystem::path& file,
                                      const std::filesystem::path& instruments_folder = {});

/// Applies "play=0.03" or "play.half_width_rad=0.03", as on the command line. Throws ScenarioError without a line
/// number.
void override_effect(Scenario& scenario, std::string_view assignment);

/// Reads "encoder stuck at 3 for 0.5" or "current jump at 2 amount 0.3", as from a shell or command line: target, kind,
/// then any of at, for, amount, axis (0: the first) with their numbers. Throws ScenarioError without a line number.
[[nodiscard]] Fault parse_fault(std::string_view text);

}  // namespace capstan::sim
