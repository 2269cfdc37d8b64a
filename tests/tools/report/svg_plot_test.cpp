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

/// A piece of text in a picture: where it begins and ends, at 6 px a letter, and its line.
struct Text {
  double from, to, foot;
  std::string words;
};

auto texts_of(const std::string& svg) -> std::vector<Text> {
  std::vector<Text> texts;
  for (auto at = svg.find("<text"); at != std::string::npos; at = svg.find("<text", at + 1)) {
    const std::string tag = svg.substr(at, svg.find("</text>", at) - at);
    const auto number = [&tag](const std::string& name) { return std::stod(tag.substr(tag.find(name) + name.size())); };
    Text text{number(" x=\""), 0.0, number(" y=\""), tag.substr(tag.find('>') + 1)};
    const double width = 6.0 * static_cast<double>(text.words.size());
    text.from -= tag.find("\"end\"") != std::string::npos ? width : 0.0;
    text.to = text.from + width;
    texts.push_back(std::move(text));
  }
  return texts;
}

TEST(SvgPlot, NoNameOfALegendLiesOnTheTitleOrOnAnotherOrOnTheTraces) {
  Plot plot = long_trace(100);
  const Series trace = plot.series[0];
  plot.series.clear();
  const std::string name = "a name of two dozen signs";
  for (const std::size_t names : {1U, 2U, 4U, 9U}) {
    for (const std::string& title : {std::string("short"), std::string(60, 'l')}) {
      plot.title = title;
      plot.series.assign(names, trace);
      for (Series& series : plot.series) {
        series.label = name;
      }
      plot.series.push_back(trace);
      plot.series.back().label.clear();
      const std::string svg = svg_of(plot);
      std::vector<Text> found;
      for (const Text& text : texts_of(svg)) {
        if (text.words == name || text.words == title) {
          found.push_back(text);
        }
      }
      ASSERT_EQ(found.size(), names + 1) << title;
      for (std::size_t i = 0; i < found.size(); ++i) {
        EXPECT_GE(found[i].from, 0.0);
        for (std::size_t k = 0; k < i; ++k) {
          const bool apart =
              found[i].foot != found[k].foot || found[i].from > found[k].to || found[k].from > found[i].to;
          EXPECT_TRUE(apart) << title << ", " << names << " names: " << i << " and " << k;
        }
      }
      const auto points = svg.find("points=\"");
      double highest = 1e9;
      const std::string trace_points = svg.substr(points, svg.find("/>", points) - points);
      for (auto comma = trace_points.find(','); comma != std::string::npos; comma = trace_points.find(',', comma + 1)) {
        highest = std::min(highest, std::stod(trace_points.substr(comma + 1)));
      }
      for (const Text& text : found) {
        EXPECT_LT(text.foot, highest) << title << ", " << names << " names";
      }
    }
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
