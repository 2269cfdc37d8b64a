// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/log/channel_delay.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <vector>

#include "capstan/tools/log/channel_shape.hpp"
#include "capstan/tools/support/statistics.hpp"

namespace capstan::tools {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index kLongestShift = 15;  // rows to either side
constexpr Index kParts = 8;          // of the log, for the jackknife
constexpr Index kEnoughRows = 8000;  // looked at; longer logs are thinned, shifts stay those of every row
constexpr Index kFewestRows = 400;
/// A motor angle that is late is late against its torque, too. A joint that leads both, as creep or a swinging load
/// makes it, is no late channel: the motor's angle alone has to explain so many times what both together do. Chosen
/// 2026-11-22 on seeds 3000 to 3349 of tools/channel_benchmark, where three of the five clean joints accused led so.
constexpr double kOfMotorAlone = 1.2;

struct Motion {
  VectorXd speed, acceleration, direction;  // per row; the direction is held at rest
};

/// Sign of the speed, held at rest. A turn is certain only some rows after it; it is put where the speed crossed zero,
/// so that the direction is not behind.
auto direction_of(const VectorXd& speed) -> VectorXd {
  const double certain = 0.02 * quantile(speed.cwiseAbs(), 0.9);
  VectorXd direction(speed.size());
  double held = 0.0;
  Index crossed = 0;
  for (Index i = 0; i < speed.size(); ++i) {
    const double sign = speed[i] > 0.0 ? 1.0 : -1.0;
    crossed = sign == held ? i + 1 : crossed;
    if (std::abs(speed[i]) > certain && sign != held) {
      held = sign;
      direction.segment(crossed, i - crossed).setConstant(sign);
      crossed = i + 1;
    }
    direction[i] = held;
  }
  return direction;
}

/// Central differences over a window that is as long as the angle's resolution asks for.
auto motion_of(const VectorXd& q) -> Motion {
  const Index n = q.size();
  const double step = quantisation_step(q);
  const double usual = quantile((q.tail(n - 1) - q.head(n - 1)).cwiseAbs(), 0.7);
  Index reach = 2;
  while (reach < 8 && static_cast<double>(reach) * usual < 4.0 * step) {
    ++reach;
  }
  Motion m{VectorXd::Zero(n), VectorXd::Zero(n), VectorXd::Zero(n)};
  const auto at = [&](const VectorXd& x, Index i) { return x[std::clamp<Index>(i, 0, n - 1)]; };
  for (Index i = 0; i < n; ++i) {
    m.speed[i] = (at(q, i + reach) - at(q, i - reach)) / static_cast<double>(2 * reach);
  }
  for (Index i = 0; i < n; ++i) {
    m.acceleration[i] = (at(m.speed, i + reach) - at(m.speed, i - reach)) / static_cast<double>(2 * reach);
  }
  m.direction = direction_of(m.speed);
  return m;
}

auto play_of(const VectorXd& q, double half_width) -> VectorXd {
  VectorXd result(q.size());
  double position = q[0];
  for (Index i = 0; i < q.size(); ++i) {
    position = std::clamp(position, q[i] - half_width, q[i] + half_width);
    result[i] = position;
  }
  return result;
}

/// x(i - rows), held at the ends.
auto shifted(const VectorXd& x, Index rows) -> VectorXd {
  const Index n = x.size();
  VectorXd result(n);
  for (Index i = 0; i < n; ++i) {
    result[i] = x[std::clamp<Index>(i - rows, 0, n - 1)];
  }
  return result;
}

/// What the target is explained by.
class Law {
 public:
  explicit Law(const DelayChannels& channels) : channels_(channels), motion_(motion_of(*channels.q1)) {
    const VectorXd& q1 = *channels.q1;
    const double range = robust_range(q1);
    if (channels.target_is_effort) {
      from_q1_ = {motion_.acceleration, motion_.speed, motion_.direction, q1, q1.array().square().matrix()};
      return;
    }
    from_q1_ = {q1, motion_.speed, motion_.direction};
    for (const double share : {0.01, 0.03, 0.1, 0.3}) {
      from_q1_.push_back(play_of(q1, share * range));
    }
  }

  /// @param of_q1, of_tau  rows by which the columns are behind the target
  [[nodiscard]] auto design(Index of_q1, Index of_tau) const -> MatrixXd {
    std::vector<VectorXd> columns;
    for (const VectorXd& column : from_q1_) {
      columns.push_back(shifted(column, of_q1));
    }
    if (channels_.tau != nullptr) {
      const VectorXd tau = shifted(*channels_.tau, of_tau);
      const VectorXd direction = shifted(motion_.direction, of_q1);
      columns.push_back(tau);
      columns.push_back(tau.cwiseProduct(direction));
      columns.push_back(tau.cwiseAbs());
    }
    MatrixXd all(channels_.q1->size(), static_cast<Index>(columns.size()) + 1);
    for (std::size_t i = 0; i < columns.size(); ++i) {
      const double scale = std::max(rms(columns[i]), 1e-300);
      all.col(static_cast<Index>(i)) = columns[i] / scale;
    }
    all.rightCols(1).setOnes();
    return all;
  }

 private:
  DelayChannels channels_;
  Motion motion_;
  std::vector<VectorXd> from_q1_;
};

/// Sums of squares of one shift by part of the log, so that fits without one part cost nothing.
struct Part {
  MatrixXd gram;
  VectorXd right;
  double squares = 0.0;
};
using Parts = std::array<Part, kParts>;

auto parts_of(const MatrixXd& design, const VectorXd& target, Index stride) -> Parts {
  Parts parts;
  const Index n = target.size();
  const Index used = n - 2 * kLongestShift;
  for (Index p = 0; p < kParts; ++p) {
    const Index begin = kLongestShift + used * p / kParts;
    const Index rows = (kLongestShift + used * (p + 1) / kParts - begin) / stride;
    MatrixXd x(rows, design.cols());
    VectorXd y(rows);
    for (Index i = 0; i < rows; ++i) {
      x.row(i) = design.row(begin + i * stride);
      y[i] = target[begin + i * stride];
    }
    parts[static_cast<std::size_t>(p)] = {x.transpose() * x, x.transpose() * y, y.squaredNorm()};
  }
  return parts;
}

/// Residual squares of a fit to all parts but one (-1: to all).
auto residual(const Parts& parts, Index without) -> double {
  MatrixXd gram = MatrixXd::Zero(parts[0].gram.rows(), parts[0].gram.cols());
  VectorXd right = VectorXd::Zero(gram.rows());
  double squares = 0.0;
  for (Index p = 0; p < kParts; ++p) {
    if (p != without) {
      const Part& part = parts[static_cast<std::size_t>(p)];
      gram += part.gram;
      right += part.right;
      squares += part.squares;
    }
  }
  gram.diagonal().array() += 1e-10 * gram.diagonal().maxCoeff();
  return std::max(squares - right.dot(gram.ldlt().solve(right)), 1e-14 * squares);
}

/// The residual's minimum over the shifts, between the rows by a parabola; nothing at the end of the range.
auto best_shift(const std::vector<Parts>& profile, Index without) -> std::optional<double> {
  VectorXd squares(static_cast<Index>(profile.size()));
  for (Index k = 0; k < squares.size(); ++k) {
    squares[k] = residual(profile[static_cast<std::size_t>(k)], without);
  }
  Index best = 0;
  squares.minCoeff(&best);
  if (best == 0 || best + 1 == squares.size()) {
    return std::nullopt;
  }
  const double bend = squares[best - 1] - 2.0 * squares[best] + squares[best + 1];
  return static_cast<double>(best - kLongestShift) + 0.5 * (squares[best - 1] - squares[best + 1]) / bend;
}

auto estimate(LateChannel channel, const Law& law, const VectorXd& target, Index stride)
    -> std::optional<ChannelDelay> {
  std::vector<Parts> profile;
  for (Index k = -kLongestShift; k <= kLongestShift; ++k) {
    const Index of_q1 = channel == LateChannel::kTarget ? k : channel == LateChannel::kMotorAngle ? -k : 0;
    const Index of_tau = channel == LateChannel::kTarget ? k : channel == LateChannel::kMotorEffort ? -k : 0;
    profile.push_back(parts_of(law.design(of_q1, of_tau), target, stride));
  }
  const auto whole = best_shift(profile, -1);
  if (!whole) {
    return std::nullopt;
  }
  VectorXd without(kParts);
  for (Index p = 0; p < kParts; ++p) {
    const auto shift = best_shift(profile, p);
    if (!shift) {
      return std::nullopt;
    }
    without[p] = *shift;
  }
  const double parts = static_cast<double>(kParts);
  const double error = std::sqrt((parts - 1.0) / parts * (without.array() - without.mean()).square().sum());
  const double half = student_t95(parts - 1.0) * error;
  const auto nearest = static_cast<std::size_t>(std::lround(*whole) + kLongestShift);
  const double before = residual(profile[kLongestShift], -1);
  const double after = residual(profile[nearest], -1);
  const double spread = (target.array() - target.mean()).square().sum() / static_cast<double>(stride);
  return ChannelDelay{channel, *whole, *whole - half, *whole + half, 1.0 - after / before, std::sqrt(after / spread)};
}

}  // namespace

auto delay_between(const DelayChannels& channels) -> std::optional<ChannelDelay> {
  const VectorXd& target = *channels.target;
  if (target.size() < kFewestRows) {
    return std::nullopt;
  }
  const Index stride = std::max<Index>(1, target.size() / kEnoughRows);
  const Law law(channels);
  std::optional<ChannelDelay> best;
  double of_both = 0.0;  // gain of motor angle and torque late together
  std::vector<LateChannel> candidates = {LateChannel::kTarget};
  if (channels.tau != nullptr) {
    candidates.push_back(LateChannel::kMotorEffort);
    candidates.push_back(LateChannel::kMotorAngle);
  }
  for (const LateChannel candidate : candidates) {
    auto found = estimate(candidate, law, target, stride);
    if (found && found->rows < 0.0 && channels.target_is_effort) {  // of two channels, one ahead is the other behind
      found = ChannelDelay{LateChannel::kMotorAngle, -found->rows, -found->high, -found->low, found->gain, found->left};
    }
    if (found && candidate == LateChannel::kTarget && found->rows < 0.0) {
      of_both = found->gain;
    }
    if (found && found->rows > 0.0 && (!best || found->gain > best->gain)) {
      best = found;
    }
  }
  const bool leads = channels.tau != nullptr && best && best->channel == LateChannel::kMotorAngle &&
                     best->gain < kOfMotorAlone * of_both;
  return leads ? std::nullopt : best;
}

}  // namespace capstan::tools
