// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/identify/palpation_log.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "capstan/tools/support/errors.hpp"

namespace capstan::tools {
namespace {

auto rows_within(const AxisLog& log, const SiteSpan& span) -> AxisLog {
  std::vector<Eigen::Index> rows;
  for (Eigen::Index i = 0; i < log.samples(); ++i) {
    if (log.time_s[i] >= span.begin_s && log.time_s[i] < span.end_s) {
      rows.push_back(i);
    }
  }
  return only_rows(log, rows);
}

/// @param stiffness_in  of a span, with at least two rows of this log in it
template <typename StiffnessIn>
auto mapped(const std::vector<NumberedSite>& sites, const AxisLog& log, StiffnessIn&& stiffness_in)
    -> std::vector<MapRow> {
  std::vector<MapRow> rows;
  for (const auto& [number, span] : sites) {
    const AxisLog part = rows_within(log, span);
    rows.push_back({log.name, number, part.samples() < 2 ? SiteStiffness{} : stiffness_in(part, span)});
  }
  return rows;
}

/// "   0.0612 +- 0.0011"
auto cell(const std::optional<Stiffness>& stiffness) -> std::string {
  std::array<char, 40> text{};
  if (stiffness) {
    std::snprintf(text.data(), text.size(), "%9.4f +- %6.4f", stiffness->value, stiffness->half_interval);
  } else {
    std::snprintf(text.data(), text.size(), "%19s", "-");
  }
  return text.data();
}

/// The value as a bar, its interval in it.
auto bar(const Stiffness& stiffness, double full_scale) -> std::string {
  constexpr double kWidth = 40.0;
  const auto column = [full_scale](double value) {
    return static_cast<std::size_t>(std::clamp(std::lround(kWidth * value / full_scale), 0L, std::lround(kWidth)));
  };
  std::string text(column(stiffness.value), '#');
  const std::size_t low = column(stiffness.value - stiffness.half_interval);
  const std::size_t high = column(stiffness.value + stiffness.half_interval);
  text.resize(std::max(text.size(), high), ' ');
  std::fill(text.begin() + static_cast<std::ptrdiff_t>(low), text.begin() + static_cast<std::ptrdiff_t>(high), '-');
  return text;
}

}  // namespace

auto read_palpation_log(const CsvLog& log, int axis) -> AxisLog {
  const Eigen::VectorXd torque = log.column(axis_column(axis, "tau_Nm"));
  if (torque.size() < kFewestForceSamples || torque.maxCoeff() == torque.minCoeff()) {
    throw BadInput(log.name() + ": no site was pressed in " + std::to_string(torque.size()) +
                   " samples; press and release each at least once, with a row every 10 ms or more often");
  }
  return read_axis(log, {.axis = axis, .needs_target = false, .needs_torque = true});
}

auto sites_of(const CsvLog& log, double period_s) -> std::vector<NumberedSite> {
  constexpr double kForever = std::numeric_limits<double>::infinity();
  const Eigen::VectorXd time = log.time();
  if (time.size() == 0) {
    return {};
  }
  std::vector<NumberedSite> sites;
  if (log.has("site")) {
    const Eigen::VectorXd numbers = log.column("site");
    for (Eigen::Index i = 0; i < time.size(); ++i) {
      const int number = static_cast<int>(std::lround(std::clamp(numbers[i], -1e9, 1e9)));
      if (static_cast<double>(number) != numbers[i]) {
        throw BadInput(log.name() + ": line " + std::to_string(log.line_of(static_cast<std::size_t>(i))) +
                       ": the site is not a whole number; correct it");
      }
      if (sites.empty() || sites.back().number != number) {
        if (!sites.empty()) {
          sites.back().span.end_s = time[i];
        }
        sites.push_back({number, {time[i], kForever}});
      }
    }
  } else if (period_s > 0.0) {
    const double last = time[time.size() - 1];
    for (double begin = time[0]; last - begin > 0.5 * period_s; begin += period_s) {
      sites.push_back({static_cast<int>(sites.size()) + 1, {begin, begin + period_s}});
    }
  } else {
    sites.push_back({1, {time[0], kForever}});
  }
  return sites;
}

auto map_sites(const std::vector<NumberedSite>& sites, const Jaw& jaw) -> std::vector<MapRow> {
  return mapped(sites, jaw.log, [&](const AxisLog& part, const SiteSpan& span) {
    return palpate(part, jaw.parameters, {span}).front();
  });
}

auto map_grip(const std::vector<NumberedSite>& sites, const Jaw& first, const Jaw& second) -> std::vector<MapRow> {
  if (first.log.number == second.log.number) {
    throw BadInput(first.log.name + ": both jaws are axis " + std::to_string(first.log.number) +
                   "; give the other jaw's axis with --against");
  }
  return mapped(sites, first.log, [&](const AxisLog& part, const SiteSpan& span) {
    const AxisLog other = rows_within(second.log, span);
    return palpate_between({part, first.parameters}, {other, second.parameters}, {span}).front();
  });
}

auto map_text(const std::vector<MapRow>& rows, double stiff_factor) -> std::string {
  std::vector<SiteStiffness> sites;
  double largest = 0.0;
  for (const MapRow& row : rows) {
    sites.push_back(row.stiffness);
    if (const auto& all = row.stiffness.combined) {
      largest = std::max(largest, all->value + all->half_interval);
    }
  }
  const auto stiff = stiff_sites(sites, stiff_factor);
  std::string text = "  site  Nm/rad, 95 %         both tendons         one tendon slack\n";
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const SiteStiffness& site = rows[i].stiffness;
    const bool stands_out = std::find(stiff.begin(), stiff.end(), i) != stiff.end();
    std::array<char, 32> number{};
    std::snprintf(number.data(), number.size(), "%c %4d", stands_out ? '*' : ' ', rows[i].site);
    text += number.data() + cell(site.combined) + "  " + cell(site.both_active) + "  " + cell(site.one_slack);
    text += site.combined ? "  " + bar(*site.combined, largest) + "\n" : "  not pressed far enough\n";
  }
  return text;
}

auto map_csv(const std::vector<MapRow>& rows) -> std::string {
  std::string text = "site,stiffness_Nm_per_rad,ci95_half_Nm_per_rad\n";
  for (const MapRow& row : rows) {
    const auto& all = row.stiffness.combined;
    text += std::to_string(row.site) +
            (all ? "," + log_number(all->value) + "," + log_number(all->half_interval) : ",,") + "\n";
  }
  return text;
}

}  // namespace capstan::tools
