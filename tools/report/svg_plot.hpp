// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace capstan::tools {

/// One line of a plot.
struct Series {
  std::string label;
  std::string colour;  ///< any CSS colour
  Eigen::VectorXd x, y;
};

/// A line plot with labelled axes.
struct Plot {
  std::string title, x_label, y_label;
  std::vector<Series> series;
  std::optional<std::pair<double, double>> y_range;  ///< to draw two plots to one scale
};

/// The plot as a complete SVG element. Lines over a rising x keep the extremes of every pixel column; others (loops)
/// are thinned evenly. Either way the size does not grow with the log.
auto svg_of(const Plot& plot) -> std::string;

/// Smallest and largest y of all series, with some room; the same for plots that share a scale.
auto common_range(const std::vector<Plot>& plots) -> std::pair<double, double>;

}  // namespace capstan::tools
