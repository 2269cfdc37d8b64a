// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/thesis/figures.hpp"

#include "capstan/tools/support/text.hpp"
#include "capstan/tools/thesis/detection.hpp"

namespace capstan::tools {

auto plot_of(std::string title, std::string x, std::string y) -> Plot {
  Plot plot;
  plot.title = std::move(title);
  plot.x_label = std::move(x);
  plot.y_label = std::move(y);
  return plot;
}

auto hertz(double frequency) -> std::string {
  return rounded(frequency, 3) + " Hz";
}

auto thesis_figures() -> std::vector<ThesisFigure> {
  std::vector<ThesisFigure> all = force_figures();
  for (auto more : {motion_figures, study_figures}) {
    for (ThesisFigure& figure : more()) {
      all.push_back(std::move(figure));
    }
  }
  all.push_back(detection_figure());
  return all;
}

}  // namespace capstan::tools
