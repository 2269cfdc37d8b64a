// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/report/svg_plot.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace capstan::tools {
namespace {

auto long_trace(Eigen::Index rows) -> Plot {
  Plot plot;
  plot.title = "a < b & c";
  plot.x_label = "time [s]";
  plot.y_label = "angle [deg]";
  Series series{"trace", "#444", Eigen::VectorXd::LinSpaced(rows, 0.0, 10.0), Eigen::VectorXd::Zero(rows)};
  series.y[rows / 3] = 5.0;
  series.y[rows / 2] = -7.0;
  plot.series = {series};
  return plot;
}

TEST(SvgPlot, LabelsAndUnitsAreInThePictureAndTextIsMadeSafe) {
  const std::string svg = svg_of(long_trace(50));
  EXPECT_NE(svg.find("time [s]"), std::string::npos);
  EXPECT_NE(svg.find("angle [deg]"), std::string::npos);
  EXPECT_NE(svg.find("a &lt; b &amp; c"), std::string::npos);
  EXPECT_EQ(svg.find("a < b"), std::string::npos);
}

TEST(SvgPlot, ALongTraceStaysSmallAndKeepsItsSpikes) {
  const std::string svg = svg_of(long_trace(600000));
  EXPECT_LT(svg.size(), 200000U);
  // The two spikes reach the ends of the range, 4 % of it from the frame: the lowest and highest points of the picture.
  const auto begin = svg.find("points=\"");
  const std::string points = svg.substr(begin + 8, svg.find('"', begin + 8) - begin - 8);
  double highest = 1e9;
  double lowest = -1e9;
  for (std::size_t comma = points.find(','); comma != std::string::npos; comma = points.find(',', comma + 1)) {
    const double y = std::stod(points.substr(comma + 1));
    highest = std::min(highest, y);
    lowest = std::max(lowest, y);
  }
  EXPECT_LT(highest, 50.0);
  EXPECT_GT(lowest, 275.0);
}

TEST(SvgPlot, ARangeOfTheLastDigitsHasAScaleToo) {
  for (const double at : {40.11, 1e-9, 1e12, 0.0}) {
    Plot plot = long_trace(100);
    plot.series[0].y.setConstant(at);
    plot.series[0].y[50] = std::nextafter(at, 1e300);
    const std::string svg = svg_of(plot);
    EXPECT_LT(svg.size(), 20000U) << at;
    EXPECT_EQ(svg.find("nan"), std::string::npos) << at;
    EXPECT_EQ(svg.find("inf"), std::string::npos) << at;
    plot.y_range = {at, std::nextafter(at, 1e300)};
    EXPECT_LT(svg_of(plot).size(), 20000U) << "as a caller may ask for it";
  }
}

TEST(SvgPlot, AFlatTraceStillHasAScale) {
  Plot plot = long_trace(100);
  plot.series[0].y.setZero();
  const std::string svg = svg_of(plot);
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  EXPECT_EQ(svg.find("inf"), std::string::npos);
}

TEST(SvgPlot, ATraceThatDiffersInTheLastDigitsIsDrawnAsFlat) {
  Plot plot = long_trace(100);
  plot.series[0].y.setConstant(0.7);
  plot.series[0].y[50] = std::nextafter(0.7, 1.0);
  const std::string svg = svg_of(plot);
  EXPECT_LT(svg.size(), 20000U);
  EXPECT_EQ(svg.find("nan"), std::string::npos);
}

}  // namespace
}  // namespace capstan::tools
