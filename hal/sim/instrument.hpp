// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "capstan/hal/sim/parameters.hpp"

namespace capstan::sim {

/// One axis of an instrument. Its tendons may pass other joints on their way: `carried_radius_m[j]` is the radius at
/// which they wrap around joint j, positive if turning that joint with this axis' motor still carries this axis' joint
/// along, by carried_radius_m[j] / output_radius_m. Empty, or one per axis with 0 for its own joint.
struct InstrumentAxis {
  std::string name;
  PlantParameters plant;
  std::vector<double> carried_radius_m;
};

struct Instrument {
  std::string name;
  std::vector<InstrumentAxis> axes;
};

/// The names of the axes, in order.
[[nodiscard]] std::vector<std::string> axis_names(const Instrument& instrument);

/// Reads an instrument file. Every key is checked: names, types, units, ranges. Throws ScenarioError.
[[nodiscard]] Instrument parse_instrument(std::string_view text, const std::filesystem::path& file);

/// One of those built in: micro_forceps, da_vinci_wrist, raven2, robot_finger, with or without ".toml". Empty if there
/// is none of that name. They are the files in instruments/.
[[nodiscard]] std::string_view built_in_instrument(std::string_view name);

}  // namespace capstan::sim
