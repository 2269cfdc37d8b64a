// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "capstan/tools/identify/conditioning.hpp"

namespace capstan::tools {

/// How far the signals of logs go, which is what shapes are shares of. Of several logs the farthest counts.
struct SignalReach {
  double q1 = 0.0, dq1 = 0.0, tau = 0.0;     ///< range; speed that is exceeded in 1 % of the samples; range
  std::array<double, kMostOthers> others{};  ///< ranges of the other joints' motor angles, by slot
  double duration_s = 0.0;
};
/// @param periods_s  of the samples of each
auto reach_of(const std::vector<Samples>& samples, const std::vector<double>& periods_s) -> SignalReach;

/// Values of a shape that logs can tell apart.
struct ShapeRange {
  double low = 0.0, high = 0.0;

  [[nodiscard]] auto size() const -> double { return high - low; }
  /// The range made wide enough for a value that is there already.
  [[nodiscard]] auto with(double value) const -> ShapeRange;
};

/// Whether a motor was at more places than a law with periods of its angle has numbers: through a few places periods of
/// some order always go. A motion that sweeps its range is at a hundred, one that rests at six at hardly more than six.
auto at_many_places(const Eigen::VectorXd& q1) -> bool;

/// Where a search of a shape begins and ends: at shares of what the logs show of its signal, so that nothing depends on
/// the unit, within the limits that fixed point sets (ShapeInfo). Those limits alone where the shape is a share of
/// nothing, or the logs have nothing of its signal.
auto range_of(const ShapeInfo& info, const SignalReach& reach) -> ShapeRange;

}  // namespace capstan::tools
