// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "capstan/tools/identify/palpation_log.hpp"
#include "capstan/tools/report/svg_plot.hpp"

namespace capstan::tools {

/// A map as a picture: a bar for each site with its 95 % interval, those that stand out in another colour, and the
/// stiffness from which on a site does. Sites stand by their numbers, or by their order where numbers repeat. A site
/// that was not pressed far enough has no bar.
auto palpation_map(const std::vector<MapRow>& rows, double stiff_factor = kStiffFactor) -> Plot;

}  // namespace capstan::tools
