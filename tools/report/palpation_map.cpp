// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/report/palpation_map.hpp"

#include <algorithm>

#include "capstan/tools/support/statistics.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

constexpr const char* kPlain = "#1d4ed8";
constexpr const char* kStiffColour = "#c2410c";
constexpr const char* kLimit = "#444";

auto line(const std::string& label, const std::string& colour, const std::vector<std::pair<double, double>>& path)
    -> Series {
  const auto points = static_cast<Eigen::Index>(path.size());
  Series series{label, colour, Eigen::VectorXd(points), Eigen::VectorXd(points)};
  for (Eigen::Index i = 0; i < points; ++i) {
    series.x[i] = path[static_cast<std::size_t>(i)].first;
    series.y[i] = path[static_cast<std::size_t>(i)].second;
  }
  return series;
}

auto bar(double at, const Stiffness& s, const std::string& label, const std::string& colour) -> Series {
  constexpr double kHalf = 0.32;
  constexpr double kCap = 0.12;
  const double low = s.value - s.half_interval;
  const double high = s.value + s.half_interval;
  return line(label, colour,
              {{at - kHalf, 0.0},
               {at - kHalf, s.value},
               {at, s.value},
               {at, low},
               {at - kCap, low},
               {at + kCap, low},
               {at, low},
               {at, high},
               {at - kCap, high},
               {at + kCap, high},
               {at, high},
               {at, s.value},
               {at + kHalf, s.value},
               {at + kHalf, 0.0}});
}

auto numbers_rise(const std::vector<MapRow>& rows) -> bool {
  return std::adjacent_find(rows.begin(), rows.end(),
                            [](const MapRow& a, const MapRow& b) { return a.site >= b.site; }) == rows.end();
}

}  // namespace

auto palpation_map(const std::vector<MapRow>& rows, double stiff_factor) -> Plot {
  std::vector<SiteStiffness> sites;
  std::vector<double> values;
  for (const MapRow& row : rows) {
    sites.push_back(row.stiffness);
    if (row.stiffness.combined) {
      values.push_back(row.stiffness.combined->value);
    }
  }
  const auto stiff = stiff_sites(sites, stiff_factor);
  const bool by_number = numbers_rise(rows);
  Plot plot;
  plot.title = "Stiffness that was felt, with its 95 % interval";
  plot.x_label = by_number ? "site" : "site, in the order of the logs";
  plot.y_label = "N m/rad";
  double first = 1.0;
  double last = 1.0;
  bool plain_named = false;
  bool stiff_named = false;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double at = by_number ? rows[i].site : static_cast<double>(i + 1);
    first = i == 0 ? at : first;
    last = at;
    if (!rows[i].stiffness.combined) {
      continue;
    }
    const bool stands_out = std::find(stiff.begin(), stiff.end(), i) != stiff.end();
    bool& named = stands_out ? stiff_named : plain_named;
    const std::string label = named ? "" : stands_out ? "stiffer than the rest" : "site";
    named = true;
    plot.series.push_back(bar(at, *rows[i].stiffness.combined, label, stands_out ? kStiffColour : kPlain));
  }
  if (!values.empty()) {
    const double limit = stiff_factor * median(Eigen::Map<const Eigen::VectorXd>(
                                            values.data(), static_cast<Eigen::Index>(values.size())));
    plot.series.push_back(
        line(rounded(stiff_factor, 3) + " times the median", kLimit, {{first - 0.5, limit}, {last + 0.5, limit}}));
  }
  return plot;
}

}  // namespace capstan::tools
