// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/identify/error_bar.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "capstan/tools/support/statistics.hpp"

namespace capstan::tools {
namespace {

constexpr double kHeld = 0.95;  // of all samples

/// An error and how far the motor had come since it turned.
struct Error {
  double travel_rad;
  double size_rad;
};

template <typename Belongs>
auto width_of(const std::vector<Error>& errors, const Belongs& belongs) -> std::optional<HeldWidth> {
  std::vector<double> sizes;
  for (const Error& error : errors) {
    if (belongs(error)) {
      sizes.push_back(error.size_rad);
    }
  }
  return held_width(sizes);
}

/// The two widths for one turn, both of the samples that a board with this turn tells them of.
auto with_turn(const std::vector<Error>& errors, double turn_rad) -> std::optional<std::pair<HeldWidth, HeldWidth>> {
  const auto steady = width_of(errors, [&](const Error& e) { return e.travel_rad >= turn_rad; });
  const auto turning = width_of(errors, [&](const Error& e) { return e.travel_rad < turn_rad; });
  return steady && turning ? std::optional(std::pair(*steady, *turning)) : std::nullopt;
}

struct Seen {
  std::vector<Error> errors;
  double from_rad = std::numeric_limits<double>::max();
  double to_rad = std::numeric_limits<double>::lowest();
  double torque_nm = 0.0;
};

auto see(const std::vector<Samples>& samples, const Eigen::VectorXd& error_rad, const Blocks& settled) -> Seen {
  Seen seen;
  Eigen::Index row = 0;
  for (std::size_t log = 0; log < samples.size(); ++log) {
    for (const auto& now : samples[log]) {
      if (row >= settled[log].begin) {
        seen.errors.push_back({std::abs(now.q1 - now.q1_reversal), std::abs(error_rad[row])});
      }
      ++row;
      seen.from_rad = std::min(seen.from_rad, now.q1);
      seen.to_rad = std::max(seen.to_rad, now.q1);
      seen.torque_nm = std::max(seen.torque_nm, std::abs(now.tau));
    }
  }
  return seen;
}

}  // namespace

auto held_width(const std::vector<double>& sizes) -> std::optional<HeldWidth> {
  constexpr std::size_t kFewest = 100;
  if (sizes.size() < kFewest) {
    return std::nullopt;
  }
  const Eigen::VectorXd all = Eigen::Map<const Eigen::VectorXd>(sizes.data(), static_cast<Eigen::Index>(sizes.size()));
  HeldWidth width{quantile(all, kHeld)};
  for (const double size : sizes) {
    const double beyond = size - width.half;
    width.loss += beyond > 0.0 ? kHeld * beyond : (kHeld - 1.0) * beyond;
  }
  return width;
}

auto error_bar(const std::vector<Samples>& samples, const Eigen::VectorXd& error_rad, const Blocks& settled)
    -> std::optional<ErrorBarNumbers> {
  // A board that goes where the logs went passes their ends by as much at times.
  constexpr double kBeyond = 0.05;
  // Shares of the range of motion, from where presliding ends to where a stroke does.
  constexpr std::array<double, 7> kTurns = {0.01, 0.02, 0.05, 0.1, 0.15, 0.2, 0.3};
  const Seen seen = see(samples, error_rad, settled);
  const double range = seen.to_rad - seen.from_rad;
  const auto whole = width_of(seen.errors, [](const Error&) { return true; });
  if (!whole || range <= 0.0) {
    return std::nullopt;
  }
  double steady = whole->half;
  double turning = whole->half;
  double turn = kTurns.back() * range;
  double loss = std::numeric_limits<double>::max();
  for (const double share : kTurns) {
    const auto widths = with_turn(seen.errors, share * range);
    if (widths && widths->first.loss + widths->second.loss < loss) {
      loss = widths->first.loss + widths->second.loss;
      steady = widths->first.half;
      turning = widths->second.half;
      turn = share * range;
    }
  }
  return ErrorBarNumbers{{steady, turning, turn, seen.from_rad - kBeyond * range, seen.to_rad + kBeyond * range,
                          (1.0 + kBeyond) * seen.torque_nm}};
}

}  // namespace capstan::tools
