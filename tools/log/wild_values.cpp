// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/log/wild_values.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "capstan/tools/log/channel_shape.hpp"
#include "capstan/tools/support/statistics.hpp"

namespace capstan::tools {
namespace {

using Eigen::Index;
using Rows = std::vector<Index>;

/// Chosen 2026-11-22 on seeds 1 to 160 and 2000 to 2050 of tools/channel_benchmark and on the shared measured machines.
/// A wild value stands out by this share of the range at least; less does not matter.
constexpr double kSpikeShare = 0.1;
/// ... and by so many times what nearly all (99.5 %) rows stand out.
constexpr double kSpikeNoises = 6.0;
constexpr double kUsualShare = 0.995;
/// More are no single values any more, but how the channel is.
constexpr double kMostSpikes = 0.01;
/// Usual even in a channel with so many, each with a change to it and one back.
constexpr double kSurelyUsualShare = 1.0 - 2.5 * kMostSpikes;

/// Where they are more, each stands out from the median around it by half of the range that nearly all rows keep to, by
/// more than the same multiple of what they do, and to one in between there are so many of them.
constexpr double kMostFarValues = 0.15;
constexpr double kFarShare = 0.5;
constexpr double kFarUsualShare = 1.0 - 1.5 * kMostFarValues;
constexpr double kFarToBetween = 4.0;
constexpr Index kReach = 4;  // rows on both sides

/// By how much rows i .. i + width - 1 stand out from both neighbours, signed; 0 if they do not.
auto standing_out(const Eigen::VectorXd& x, Index i, Index width) -> double {
  const double before = x[i - 1];
  const double after = x[i + width];
  const auto inside = x.segment(i, width);
  const double up = inside.minCoeff() - std::max(before, after);
  const double down = std::min(before, after) - inside.maxCoeff();
  return up > 0.0 ? up : down > 0.0 ? -down : 0.0;
}

/// What a row has to stand out by, from how far those do that are usual.
auto spike_threshold(const Eigen::VectorXd& x, double usual) -> double {
  Eigen::VectorXd single = Eigen::VectorXd::Zero(x.size());
  for (Index i = 1; i + 1 < x.size(); ++i) {
    single[i] = std::abs(standing_out(x, i, 1));
  }
  return std::max(
      {kSpikeShare * robust_range(x), kSpikeNoises * quantile(single, usual), 2.0 * quantile(changes_of(x), usual)});
}

auto rows_above(const Eigen::VectorXd& x, double threshold) -> Rows {
  Rows rows;
  for (Index i = 1; i + 1 < x.size(); ++i) {
    for (Index width = 1; width <= kLongestSpike && i + width < x.size(); ++width) {
      if (std::abs(standing_out(x, i, width)) > threshold) {
        for (const Index end = i + width; i < end; ++i) {
          rows.push_back(i);
        }
        break;
      }
    }
  }
  return rows;
}

/// By how much each row differs from the median of those around it, which keeps steps.
auto from_median(const Eigen::VectorXd& x) -> Eigen::VectorXd {
  Eigen::VectorXd apart(x.size());
  for (Index i = 0; i < x.size(); ++i) {
    const Index begin = std::max<Index>(0, i - kReach);
    apart[i] = x[i] - median(x.segment(begin, std::min(x.size(), i + kReach + 1) - begin));
  }
  return apart;
}

/// Rows of wild values in a channel with many; none if they are too many, or no other rows than the rest.
auto far_rows(const Eigen::VectorXd& x) -> Rows {
  const Eigen::VectorXd apart = from_median(x);
  const double range = quantile(x, 1.0 - kMostFarValues) - quantile(x, kMostFarValues);
  const double threshold = std::max(
      {kSpikeShare * robust_range(x), kFarShare * range, kSpikeNoises * quantile(apart.cwiseAbs(), kFarUsualShare)});
  const auto is_far = [&](Index row) { return std::abs(apart[row]) > threshold; };
  Rows rows;
  for (Index i = 1; i + 1 < x.size(); ++i) {
    if (!is_far(i)) {
      continue;
    }
    // A short stroke goes there step by step; a wild value stands out from the next rows on both sides that are none.
    Index before = i - 1;
    Index after = i + 1;
    while (before > std::max<Index>(0, i - kReach) && is_far(before)) {
      --before;
    }
    while (after < std::min(x.size() - 1, i + kReach) && is_far(after)) {
      ++after;
    }
    const double out = apart[i] > 0.0 ? x[i] - std::max(x[before], x[after]) : std::min(x[before], x[after]) - x[i];
    if (out > threshold) {
      rows.push_back(i);
    }
  }
  const auto count = static_cast<double>(rows.size());
  const auto between =
      static_cast<double>((apart.array().abs() > 0.5 * threshold && apart.array().abs() <= threshold).count());
  const bool are_others = count <= kMostFarValues * static_cast<double>(x.size()) && count > kFarToBetween * between;
  return are_others ? rows : Rows{};
}

/// One row in a hundred at most.
auto few_rows(const Eigen::VectorXd& x) -> Rows {
  const double most = kMostSpikes * static_cast<double>(x.size());
  const auto few = [most](const Rows& rows) { return static_cast<double>(rows.size()) <= most; };
  // In a short log a few wild values are among what is usual, and hide themselves: first without so much of it.
  const Rows suspects = rows_above(x, spike_threshold(x, kSurelyUsualShare));
  const Rows rows = rows_above(x, spike_threshold(few(suspects) ? without(x, suspects) : x, kUsualShare));
  return few(rows) ? rows : Rows{};
}

}  // namespace

auto without(Eigen::VectorXd x, const Rows& rows) -> Eigen::VectorXd {
  for (std::size_t i = 0; i < rows.size();) {
    std::size_t j = i;
    while (j + 1 < rows.size() && rows[j + 1] == rows[j] + 1) {
      ++j;
    }
    const Index before = rows[i] - 1;
    const Index after = rows[j] + 1;
    const bool inside = before >= 0 && after < x.size();
    for (Index row = rows[i]; inside && row < after; ++row) {
      const double part = static_cast<double>(row - before) / static_cast<double>(after - before);
      x[row] = (1.0 - part) * x[before] + part * x[after];
    }
    i = j + 1;
  }
  return x;
}

auto spike_rows(const Eigen::VectorXd& x, bool has_pulses) -> Rows {
  constexpr Index kFewestRows = 50;
  if (x.size() < kFewestRows) {
    return {};
  }
  const Rows far = has_pulses ? Rows{} : far_rows(x);
  if (static_cast<double>(far.size()) <= kMostSpikes * static_cast<double>(x.size())) {
    return few_rows(x);
  }
  const Rows others = few_rows(without(x, far));
  Rows all;
  std::set_union(far.begin(), far.end(), others.begin(), others.end(), std::back_inserter(all));
  return all;
}

}  // namespace capstan::tools
