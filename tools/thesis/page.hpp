// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "capstan/tools/report/svg_plot.hpp"
#include "capstan/tools/thesis/table.hpp"

namespace capstan::tools {

/// One figure of the thesis on the simulator.
struct ThesisFigure {
  std::string number;
  std::string title;
  std::string caption;  ///< what to look for
  std::vector<Plot> plots;
};

/// Every figure, in the thesis's order. Takes half a minute.
auto thesis_figures() -> std::vector<ThesisFigure>;

/// One self-contained page.
auto thesis_page(const std::vector<ThesisTable>& tables, const std::vector<ThesisFigure>& figures) -> std::string;

}  // namespace capstan::tools
