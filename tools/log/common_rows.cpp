// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/log/common_rows.hpp"

#include <algorithm>
#include <cmath>

#include "capstan/tools/support/errors.hpp"

namespace capstan::tools {
namespace {

using Eigen::Index;

struct Channel {
  std::string name;
  Eigen::VectorXd values;       // NaN where nothing was measured
  std::vector<Index> measured;  // rows
};

auto channel_of(const CsvLog& log, const std::string& name) -> Channel {
  Channel channel{name, log.column_with_gaps(name), {}};
  for (Index i = 0; i < channel.values.size(); ++i) {
    if (!std::isnan(channel.values[i])) {
      channel.measured.push_back(i);
    }
  }
  if (channel.measured.size() < 2) {
    throw BadInput(place(log.name(), 2) + "column " + name + " is empty; name another one with --map " + name +
                   "=COLUMN");
  }
  return channel;
}

/// On a straight line between the measured rows around it.
auto at_row(const Channel& channel, const Eigen::VectorXd& time, Index row) -> double {
  const auto right = std::lower_bound(channel.measured.begin(), channel.measured.end(), row);
  if (*right == row) {
    return channel.values[row];
  }
  const Index before = *(right - 1);
  const double part = (time[row] - time[before]) / (time[*right] - time[before]);
  return (1.0 - part) * channel.values[before] + part * channel.values[*right];
}

}  // namespace

auto with_common_rows(const CsvLog& log, const std::vector<std::string>& main, const std::vector<std::string>& others,
                      std::vector<std::string>& notes) -> CsvLog {
  if (log.rows() < 2) {
    return log;
  }
  std::vector<Channel> channels;
  for (const auto& names : {main, others}) {
    for (const auto& name : names) {
      if (log.has(name)) {
        channels.push_back(channel_of(log, name));
      }
    }
  }
  const auto rows = static_cast<Index>(log.rows());
  const bool whole = std::all_of(channels.begin(), channels.end(), [&](const Channel& channel) {
    return static_cast<Index>(channel.measured.size()) == rows;
  });
  if (channels.empty() || whole) {
    return log;
  }
  const auto mains = std::count_if(main.begin(), main.end(), [&](const auto& name) { return log.has(name); });
  const auto slowest =
      std::min_element(channels.begin(), channels.begin() + std::max<std::ptrdiff_t>(mains, 1),
                       [](const auto& a, const auto& b) { return a.measured.size() < b.measured.size(); });
  Index first = 0;
  Index last = rows - 1;
  for (const Channel& channel : channels) {
    first = std::max(first, channel.measured.front());
    last = std::min(last, channel.measured.back());
  }
  const Eigen::VectorXd time = log.time();
  std::vector<std::size_t> kept;
  for (const Index row : slowest->measured) {
    if (row >= first && row <= last) {
      kept.push_back(static_cast<std::size_t>(row));
    }
  }
  std::map<std::string, Eigen::VectorXd> columns;
  for (const Channel& channel : channels) {
    Eigen::VectorXd values(static_cast<Index>(kept.size()));
    for (Index i = 0; i < values.size(); ++i) {
      values[i] = at_row(channel, time, static_cast<Index>(kept[static_cast<std::size_t>(i)]));
    }
    columns[channel.name] = std::move(values);
  }
  constexpr Index kFewMissing = 100;  // one row in as many: cells that were lost, no other rate
  if (const Index missing = rows - static_cast<Index>(slowest->measured.size());
      missing > 0 && kFewMissing * missing <= rows) {
    notes.push_back(log.name() + ": " + std::to_string(missing) + (missing == 1 ? " row has" : " rows have") +
                    " no number for " + slowest->name + ", so the other " + std::to_string(kept.size()) +
                    " are used; what else is missing there is interpolated");
  } else {
    notes.push_back(log.name() + ": the channels have different rates; the " + std::to_string(kept.size()) +
                    " rows of " + slowest->name + ", the slowest, are used, and the others are interpolated there");
  }
  if (kept.empty()) {
    throw BadInput(log.name() + ": the channels were never measured at the same time; record them together");
  }
  return log.with_rows(kept, std::move(columns));
}

}  // namespace capstan::tools
