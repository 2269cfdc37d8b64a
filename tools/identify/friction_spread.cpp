// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/identify/friction_spread.hpp"

#include <cmath>

namespace capstan::tools {
namespace {

/// Torque beyond the steady one while the motor goes one way.
struct Side {
  double torque_nm = 0.0;
  int count = 0;

  void take(double beyond_nm) {
    torque_nm += beyond_nm;
    ++count;
  }
  [[nodiscard]] auto is_full() const -> bool { return count >= MonitorStretch::kSamples; }
  [[nodiscard]] auto mean() const -> double { return torque_nm / count; }
};

/// What the logs say.
struct Friction {
  std::vector<double> squares;        ///< of what each stretch's friction is beyond the steady one
  std::vector<double> speed, torque;  ///< of each sample, along the motion; the torque beyond the steady one
};

void add_stretches(const Samples& samples, const SteadyTorque& steady, Friction& all) {
  Side backward;
  Side forward;
  double last = samples.front().q1;
  int strides = 0;
  for (const auto& now : samples) {
    if (std::abs(now.q1 - last) < MonitorStretch::kStrideRad) {
      continue;
    }
    last = now.q1;
    ++strides;
    if (strides <= MonitorStretch::kUnsettled || std::abs(now.q1 - now.q1_reversal) <= MonitorStretch::kSettleRad) {
      continue;
    }
    const double beyond = now.tau - (now.forward ? steady.forward_nm : steady.backward_nm);
    (now.forward ? forward : backward).take(beyond);
    all.speed.push_back(std::abs(now.dq1));
    all.torque.push_back(now.forward ? beyond : -beyond);
    if (forward.is_full() && backward.is_full()) {
      all.squares.push_back(std::pow(0.5 * (forward.mean() - backward.mean()), 2.0));
      forward = backward = Side{};
    }
  }
}

auto vector_of(const std::vector<double>& values) -> Eigen::VectorXd {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

/// What the friction owes to the speed: motion to come may be all slow or all fast, where a stretch of the logs has
/// some of either.
auto by_speed(const Friction& all) -> double {
  const Eigen::VectorXd speed = vector_of(all.speed).array() - vector_of(all.speed).mean();
  return std::abs(speed.dot(vector_of(all.torque))) /
         std::sqrt(speed.squaredNorm() * static_cast<double>(speed.size()));
}

}  // namespace

auto friction_spread(const std::vector<AxisLog>& logs, const std::vector<Samples>& samples, const SteadyTorque& steady)
    -> std::optional<double> {
  constexpr std::size_t kFewest = 8;
  Friction all;
  for (std::size_t i = 0; i < logs.size(); ++i) {
    if (logs[i].has_torque && !samples[i].empty()) {
      add_stretches(samples[i], steady, all);
    }
  }
  if (all.squares.size() < kFewest) {
    return std::nullopt;
  }
  return std::hypot(std::sqrt(vector_of(all.squares).mean()), by_speed(all));
}

}  // namespace capstan::tools
