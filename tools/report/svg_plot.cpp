// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/report/svg_plot.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "capstan/tools/report/html.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

constexpr double kWidth = 760.0;
constexpr double kHeight = 340.0;
constexpr double kLeft = 74.0;
constexpr double kRight = 16.0;
constexpr double kTopMargin = 34.0;
constexpr double kBottomMargin = 48.0;
constexpr double kLine = 16.0;       // of text
constexpr double kPerLetter = 7.0;   // at most, on average
constexpr double kBetween = 12.0;    // names of a legend
constexpr double kTitleLine = 20.0;  // its foot
constexpr Eigen::Index kMostPoints = 4000;

/// One axis: data range on a stretch of pixels.
struct Scale {
  double low, high, pixel_low, pixel_high;
  [[nodiscard]] auto at(double value) const -> double {
    return pixel_low + (value - low) / (high - low) * (pixel_high - pixel_low);
  }
};

auto coordinate(double value) -> std::string {
  char text[32];
  std::snprintf(text, sizeof(text), "%.1f", value);
  return text;
}

/// Round steps of 1, 2 or 5 times a power of ten, about `count` of them.
auto ticks_of(double low, double high, int count) -> std::vector<double> {
  const double raw = (high - low) / count;
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  const double share = raw / power;
  const double step = (share < 1.5 ? 1.0 : share < 3.5 ? 2.0 : share < 7.5 ? 5.0 : 10.0) * power;
  std::vector<double> ticks;
  const double first = std::ceil(low / step);
  // Counted: a sum of steps too short for the numbers would stand still.
  for (int i = 0; i <= 2 * count && (first + i) * step <= high + 1e-9 * step; ++i) {
    const double tick = (first + i) * step;
    ticks.push_back(std::abs(tick) < 1e-9 * step ? 0.0 : tick);
  }
  return ticks;
}

/// What differs by its last digits only is drawn as a constant: a picture has no room for them.
auto widened(double low, double high) -> std::pair<double, double> {
  constexpr double kLastDigits = 1e-12;
  const double size = std::max(std::abs(low), std::abs(high));
  const double room = high - low > kLastDigits * size ? 0.04 * (high - low) : std::max(1e-6, 0.1 * size);
  return {low - room, high + room};
}

auto x_range(const Plot& plot) -> std::pair<double, double> {
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (const auto& series : plot.series) {
    if (series.x.size() > 0) {
      low = std::min(low, series.x.minCoeff());
      high = std::max(high, series.x.maxCoeff());
    }
  }
  return low <= high ? widened(low, high) : std::pair(0.0, 1.0);
}

auto is_rising(const Eigen::VectorXd& x) -> bool {
  return x.size() < 2 || ((x.tail(x.size() - 1) - x.head(x.size() - 1)).array() >= 0.0).all();
}

/// Rows worth drawing: for a rising x the first, lowest, highest and last of every pixel column.
auto drawn_rows(const Series& series, const Scale& x) -> std::vector<Eigen::Index> {
  std::vector<Eigen::Index> rows;
  const Eigen::Index n = series.x.size();
  if (n <= kMostPoints || !is_rising(series.x)) {
    for (Eigen::Index i = 0; i < n; i += std::max<Eigen::Index>(1, n / kMostPoints)) {
      rows.push_back(i);
    }
    return rows;
  }
  for (Eigen::Index begin = 0; begin < n;) {
    const double column = std::floor(x.at(series.x[begin]));
    Eigen::Index end = begin;
    Eigen::Index lowest = begin;
    Eigen::Index highest = begin;
    for (; end < n && std::floor(x.at(series.x[end])) == column; ++end) {
      lowest = series.y[end] < series.y[lowest] ? end : lowest;
      highest = series.y[end] > series.y[highest] ? end : highest;
    }
    std::vector<Eigen::Index> picked = {begin, std::min(lowest, highest), std::max(lowest, highest), end - 1};
    picked.erase(std::unique(picked.begin(), picked.end()), picked.end());
    rows.insert(rows.end(), picked.begin(), picked.end());
    begin = end;
  }
  return rows;
}

auto line(double x1, double y1, double x2, double y2, const char* colour) -> std::string {
  return "<line x1=\"" + coordinate(x1) + "\" y1=\"" + coordinate(y1) + "\" x2=\"" + coordinate(x2) + "\" y2=\"" +
         coordinate(y2) + "\" stroke=\"" + colour + "\"/>\n";
}

auto label(double x, double y, const char* anchor, const std::string& text, const std::string& extra = "")
    -> std::string {
  return "<text x=\"" + coordinate(x) + "\" y=\"" + coordinate(y) + "\" text-anchor=\"" + anchor + "\"" + extra + ">" +
         escaped(text) + "</text>\n";
}

auto grid(const Plot& plot, const Scale& x, const Scale& y) -> std::string {
  std::string svg;
  for (const double tick : ticks_of(x.low, x.high, 8)) {
    svg += line(x.at(tick), y.pixel_high, x.at(tick), kHeight - kBottomMargin, "#ddd");
    svg += label(x.at(tick), kHeight - kBottomMargin + 16.0, "middle", rounded(tick, 6));
  }
  for (const double tick : ticks_of(y.low, y.high, 6)) {
    svg += line(kLeft, y.at(tick), kWidth - kRight, y.at(tick), tick == 0.0 ? "#888" : "#ddd");
    svg += label(kLeft - 6.0, y.at(tick) + 4.0, "end", rounded(tick, 6));
  }
  svg += label((kLeft + kWidth - kRight) / 2.0, kHeight - 10.0, "middle", plot.x_label);
  const double middle = (y.pixel_high + kHeight - kBottomMargin) / 2.0;
  svg += label(16.0, middle, "middle", plot.y_label, " transform=\"rotate(-90 16 " + coordinate(middle) + ")\"");
  svg += label(kLeft, kTitleLine, "start", plot.title, " font-weight=\"bold\"");
  return svg;
}

auto trace(const Series& series, const Scale& x, const Scale& y) -> std::string {
  std::string points;
  for (const Eigen::Index row : drawn_rows(series, x)) {
    points += coordinate(x.at(series.x[row])) + "," + coordinate(y.at(series.y[row])) + " ";
  }
  return "<polyline fill=\"none\" stroke=\"" + series.colour + "\" stroke-width=\"1.2\" points=\"" + points + "\"/>\n";
}

auto width_of(const std::string& text) -> double {
  return kPerLetter * static_cast<double>(text.size());
}

/// Names of a legend, line by line.
using Legend = std::vector<std::vector<const Series*>>;

/// One line beside the title, if they fit there; else as many as it takes below it, and none beside it.
auto legend_of(const Plot& plot) -> Legend {
  Legend lines(1);
  double used = width_of(plot.title) + kBetween;
  const auto add = [&](const Series& series) {
    const double more = kBetween + width_of(series.label);
    if (used + more > kWidth - kLeft - kRight && (lines.size() == 1 || !lines.back().empty())) {
      return false;
    }
    used += more;
    lines.back().push_back(&series);
    return true;
  };
  const auto named = [](const Series& series) { return !series.label.empty(); };
  if (std::all_of(plot.series.begin(), plot.series.end(), [&](const Series& s) { return !named(s) || add(s); })) {
    return lines;
  }
  lines = {{}, {}};
  used = 0.0;
  for (const Series& series : plot.series) {
    if (named(series) && !add(series)) {
      lines.emplace_back();
      used = 0.0;
      static_cast<void>(add(series));
    }
  }
  return lines;
}

auto legend_text(const Legend& lines) -> std::string {
  std::string svg;
  double foot = kTitleLine;
  for (const auto& names : lines) {
    double right = kWidth - kRight;
    for (auto series = names.rbegin(); series != names.rend(); ++series) {
      svg += label(right, foot, "end", (*series)->label, " fill=\"" + (*series)->colour + "\"");
      right -= kBetween + width_of((*series)->label);
    }
    foot += kLine;
  }
  return svg;
}

}  // namespace

auto common_range(const std::vector<Plot>& plots) -> std::pair<double, double> {
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (const auto& plot : plots) {
    for (const auto& series : plot.series) {
      if (series.y.size() > 0) {
        low = std::min(low, series.y.minCoeff());
        high = std::max(high, series.y.maxCoeff());
      }
    }
  }
  return low <= high ? widened(low, high) : std::pair(0.0, 1.0);
}

auto svg_of(const Plot& plot) -> std::string {
  const auto [x_low, x_high] = x_range(plot);
  const auto [y_low, y_high] = plot.y_range ? *plot.y_range : common_range({plot});
  const Scale x{x_low, x_high, kLeft, kWidth - kRight};
  const Legend legend = legend_of(plot);
  const double top = kTopMargin + kLine * static_cast<double>(legend.size() - 1);
  const Scale y{y_low, y_high, kHeight - kBottomMargin, top};
  std::string svg = "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " + coordinate(kWidth) + " " +
                    coordinate(kHeight) + "\" width=\"" + coordinate(kWidth) + "\" height=\"" + coordinate(kHeight) +
                    "\" font-family=\"sans-serif\" font-size=\"12\" role=\"img\" aria-label=\"" + escaped(plot.title) +
                    "\">\n";
  svg += "<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n";
  svg += grid(plot, x, y);
  for (const auto& series : plot.series) {
    svg += trace(series, x, y);
  }
  return svg + legend_text(legend) + "</svg>\n";
}

}  // namespace capstan::tools
