// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/log/delay_law.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "capstan/tools/log/channel_shape.hpp"
#include "capstan/tools/support/play_column.hpp"
#include "capstan/tools/support/statistics.hpp"

namespace capstan::tools {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Share of a rate that the angle's noise and steps may make. Chosen 2026-11-23 on seeds 3000 to 3199 of
/// tools/channel_benchmark, where 0.03 and 0.003 name 71 and 70 % of the late channels and 0.01 72 %.
constexpr double kRateNoise = 0.01;
/// From turn to turn there is room for so many windows at least. A fast motion looks like noise, and would be lost.
constexpr Index kWindowsPerSwing = 8;
constexpr std::array<Index, 10> kWindows = {2, 3, 4, 6, 8, 12, 16, 24, 32, 48};

/// Travel in which friction builds up, of the motion's range: as a play, and as a bristle. From well below what is
/// usual behind tendons to most of the way.
constexpr std::array<double, 8> kPlays = {0.0007, 0.0015, 0.003, 0.006, 0.015, 0.04, 0.1, 0.25};
constexpr std::array<double, 4> kBristles = {0.0025, 0.006, 0.015, 0.05};
constexpr std::array<double, 3> kTorquePlays = {0.02, 0.06, 0.2};  // of the torque's range
constexpr std::array<double, 2> kSlowSpeeds = {0.1, 0.4};          // of the speed's rms: friction changes over it
constexpr std::array<double, 2> kCreepTimes = {0.3, 1.5};          // s
constexpr Index kMostStrokes = 200;                                // of a motion that is repeated as a whole
constexpr Index kAngleKnots = 24;                                  // of any function of the angle
constexpr Index kFrictionKnots = 6;                                // of friction by angle
constexpr Index kTorqueKnots = 8;
constexpr Index kElongationKnots = 4;  // of the torque's function by direction

/// What happens per row of a memory: state = step(state, row).
template <typename Step>
auto remembered(Index rows, double first, Step step) -> VectorXd {
  VectorXd result(rows);
  double state = first;
  for (Index i = 0; i < rows; ++i) {
    state = step(state, i);
    result[i] = state;
  }
  return result;
}

auto bristle_of(const VectorXd& x, double width) -> VectorXd {
  return remembered(x.size(), 0.0, [&](double bend, Index i) {
    const double travel = i > 0 ? x[i] - x[i - 1] : 0.0;
    const double kept = std::exp(-std::abs(travel) / width);
    return bend * kept + std::copysign(1.0 - kept, travel);
  });
}

auto low_passed(const VectorXd& x, double rows) -> VectorXd {
  const double share = 1.0 - std::exp(-1.0 / rows);
  return remembered(x.size(), x[0], [&](double at, Index i) { return at + share * (x[i] - at); });
}

/// x at the last turn.
auto at_last_turn(const VectorXd& x, const VectorXd& direction) -> VectorXd {
  return remembered(x.size(), x[0],
                    [&](double at, Index i) { return i > 0 && direction[i] != direction[i - 1] ? x[i] : at; });
}

/// Difference over `reach` rows to either side, per row.
auto rate_of(const VectorXd& x, Index reach) -> VectorXd {
  const Index n = x.size();
  VectorXd rate(n);
  for (Index i = 0; i < n; ++i) {
    rate[i] = (x[std::min(i + reach, n - 1)] - x[std::max<Index>(i - reach, 0)]) / static_cast<double>(2 * reach);
  }
  return rate;
}

auto angle_noise(const VectorXd& angle) -> double {
  return std::max(quantisation_step(angle) / std::sqrt(12.0), fast_noise_level(angle));
}

class Columns {
 public:
  explicit Columns(const LogParts& parts) : parts_(parts) {}

  void add(const VectorXd& signal) { columns_.push_back(cut(signal, parts_)); }
  /// Any function of x: straight lines between knots. With a factor: that times the function.
  void add_function(const VectorXd& x, Index knots, const MatrixXd* factor = nullptr) {
    const double low = x.minCoeff();
    const double step = (x.maxCoeff() - low) / static_cast<double>(knots - 1);
    const MatrixXd at = (cut(x, parts_).array() - low) / step;
    for (Index k = 0; k < knots; ++k) {
      MatrixXd hat = (1.0 - (at.array() - static_cast<double>(k)).abs()).max(0.0);
      columns_.push_back(factor == nullptr ? hat : MatrixXd(hat.cwiseProduct(*factor)));
    }
  }
  auto take() -> std::vector<MatrixXd> { return std::move(columns_); }

 private:
  const LogParts& parts_;
  std::vector<MatrixXd> columns_;
};

void add_torque(const LawChannels& channels, const Turns& turns, const MatrixXd& direction, Columns& columns) {
  const VectorXd& tau = *channels.tau;
  columns.add_function(tau, kTorqueKnots);
  columns.add_function(tau, kElongationKnots, &direction);
  const double range = robust_range(tau);
  for (const double share : kTorquePlays) {
    columns.add(play_column(tau, share * range));
  }
  for (const double time_s : kCreepTimes) {
    columns.add(low_passed(tau, time_s / channels.period_s));
  }
  const VectorXd turned = at_last_turn(tau, turns.direction);
  columns.add(turned);
  columns.add(turned.cwiseProduct(turns.direction));
}

/// Lengths and times of the strokes between turns.
struct Strokes {
  std::vector<double> lengths, times;
};
auto strokes_of(const VectorXd& angle, const VectorXd& direction) -> Strokes {
  Strokes strokes;
  Index last = 0;
  for (Index i = 1; i < angle.size(); ++i) {
    if (direction[i] * direction[i - 1] < 0.0) {
      if (last > 0) {
        strokes.lengths.push_back(std::abs(angle[i] - angle[last]));
        strokes.times.push_back(static_cast<double>(i - last));
      }
      last = i;
    }
  }
  return strokes;
}

/// Of both, the larger rms over mean: from their own mean, ...
auto spread_of(const Strokes& strokes) -> double {
  const auto relative = [](const std::vector<double>& values) {
    const Eigen::Map<const VectorXd> all(values.data(), std::ssize(values));
    return values.empty() ? 0.0 : rms_about_mean(all) / all.mean();
  };
  return std::max(relative(strokes.lengths), relative(strokes.times));
}

/// ... or from those so many strokes before.
auto spread_over(const Strokes& strokes, Index before) -> double {
  const auto relative = [before](const std::vector<double>& values) {
    const Eigen::Map<const VectorXd> all(values.data(), std::ssize(values));
    const Index pairs = all.size() - before;
    return rms(all.tail(pairs) - all.head(pairs)) / std::sqrt(2.0) / all.mean();
  };
  return std::max(relative(strokes.lengths), relative(strokes.times));
}

/// How often the strokes come as a whole, at least two of them.
auto repeats_of(const Strokes& strokes) -> double {
  const Index count = std::ssize(strokes.lengths);
  for (Index before = 2; before <= std::min(count / 2, kMostStrokes); ++before) {
    if (spread_over(strokes, before) < kAlikeStrokes) {
      return static_cast<double>(count) / static_cast<double>(before);
    }
  }
  return 1.0;
}

}  // namespace

auto turns_of(const VectorXd& angle) -> Turns {
  const Index n = angle.size();
  const double near =
      std::max({2.0 * quantisation_step(angle), 3.0 * fast_noise_level(angle), 1e-4 * robust_range(angle)});
  const double far = 4.0 * near;  // is reached in twice the time, from rest and at one acceleration
  Turns turns{VectorXd::Zero(n)};
  std::vector<double> unsure;
  double sign = 0.0;
  double extreme = angle[0];
  double other = angle[0];  // before the first motion: the lowest
  Index from = 0;
  for (Index i = 0; i < n; ++i) {
    if (sign == 0.0) {
      extreme = std::max(extreme, angle[i]);
      other = std::min(other, angle[i]);
      if (extreme - other >= far) {
        sign = angle[i] >= extreme ? 1.0 : -1.0;
        extreme = angle[i];
      }
      continue;
    }
    const auto back = [&](Index row) { return (extreme - angle[row]) * sign; };
    if (back(i) < 0.0) {
      extreme = angle[i];
    }
    if (back(i) < far) {
      continue;
    }
    Index left = i - 1;
    while (left > from && back(left) >= near) {
      --left;
    }
    const auto reached = [&](Index row, double depth) {
      const double step = std::max(back(row + 1) - back(row), 1e-300);
      return static_cast<double>(row) + std::clamp((depth - back(row)) / step, 0.0, 1.0);
    };
    const double last = reached(i - 1, far) - reached(left, near);
    const double began = reached(left, near) - last;
    const auto turn = std::clamp<Index>(static_cast<Index>(std::ceil(began)), from, i);
    turns.direction.segment(from, turn - from).setConstant(sign);
    unsure.push_back(0.25 * last);
    from = turn;
    sign = -sign;
    extreme = angle[i];
  }
  turns.direction.tail(n - from).setConstant(sign);
  const Strokes strokes = strokes_of(angle, turns.direction);
  turns.spread = spread_of(strokes);
  turns.repeats = repeats_of(strokes);
  turns.count = static_cast<Index>(unsure.size());
  turns.unsure = unsure.empty() ? 0.0 : median(Eigen::Map<VectorXd>(unsure.data(), turns.count));
  return turns;
}

auto own_play(const VectorXd& angle, const VectorXd& target, Index late) -> double {
  constexpr Index kEnoughRows = 4000;
  constexpr double kNarrowest = 0.002;  // of the angle's range
  constexpr double kWidest = 0.5;
  constexpr double kStep = 1.25;
  const double range = robust_range(angle);
  const Index rows = angle.size() - late;
  const Index step = std::max<Index>(1, rows / kEnoughRows);
  const auto thin = [&](const VectorXd& x, Index first = 0) {
    return VectorXd(x(Eigen::seqN(first, rows / step, step)));
  };
  const VectorXd wanted = thin(target, late);
  const VectorXd scaled = thin(angle) / range;
  MatrixXd columns(wanted.size(), 5);
  columns << VectorXd::Ones(wanted.size()), scaled, scaled.cwiseAbs2(), scaled.array().cube().matrix(), scaled;
  const auto left = [&](double share) {
    columns.col(4) = thin(play_column(angle, share * range)) / range;
    const MatrixXd products = columns.transpose() * columns;
    return (wanted - columns * products.ldlt().solve(columns.transpose() * wanted)).squaredNorm();
  };
  double best = kNarrowest;
  double least = left(best);
  const auto ask = [&](double share) {
    const double now = left(share);
    best = now < least ? share : best;
    least = std::min(now, least);
  };
  for (double share = kNarrowest * kStep; share < kWidest; share *= kStep) {
    ask(share);
  }
  for (double factor = std::sqrt(kStep); factor > 1.0005; factor = std::sqrt(factor)) {
    for (const double share : {best / factor, best * factor}) {
      ask(share);
    }
  }
  return best * range;
}

auto delay_windows(const VectorXd& angle, const Turns& turns) -> DelayWindows {
  const double noise = angle_noise(angle);
  const Index widest = angle.size() / (kWindowsPerSwing * std::max<Index>(turns.count, 1));
  DelayWindows found{kWindows.back(), kWindows.back()};
  for (auto window = kWindows.rbegin(); window != kWindows.rend(); ++window) {
    // The rates that a triangle sees are differences of means over a box.
    const Index reach = 2 * *window + 1;
    const auto width = static_cast<double>(reach);
    const VectorXd speed = rate_of(angle, reach);
    const Index inside = std::max<Index>(angle.size() - 2 * reach, 0);
    const VectorXd acceleration =
        (angle.tail(inside) - 2.0 * angle.segment(reach, inside) + angle.head(inside)) / (width * width);
    found.speed = noise / width < kRateNoise * rms(speed) ? *window : found.speed;
    found.acceleration =
        std::sqrt(6.0) * noise / (width * width) < kRateNoise * rms(acceleration) ? *window : found.acceleration;
  }
  const Index bound = std::max(widest, kWindows.front());
  return {std::min(found.speed, bound), std::min(found.acceleration, bound)};
}

auto delay_law(const LawChannels& channels, const Turns& turns, const LogParts& parts) -> std::vector<MatrixXd> {
  const VectorXd& q1 = *channels.q1;
  const double range = robust_range(q1);
  const VectorXd raw_speed = rate_of(q1, 1);
  const VectorXd speed = rate_of(q1, 2 * parts.window + 1);
  Columns columns(parts);
  columns.add(rate_of(raw_speed, 1));
  columns.add(raw_speed);
  columns.add(speed.cwiseAbs());
  columns.add(speed.cwiseProduct(speed));
  columns.add(speed.cwiseProduct(speed.cwiseAbs()));
  columns.add_function(q1, kAngleKnots);
  const MatrixXd direction = cut(turns.direction, parts);
  columns.add_function(q1, kFrictionKnots, &direction);
  const double step = quantisation_step(q1);
  for (const double share : kPlays) {
    if (share * range > step) {
      columns.add(play_column(q1, share * range));
    }
  }
  if (channels.own_play > 0.0) {
    columns.add(play_column(q1, channels.own_play));
  }
  for (const double share : kBristles) {
    columns.add(bristle_of(q1, share * range));
  }
  for (const double share : kSlowSpeeds) {
    const auto slow = (-(speed.array() / (share * rms(speed))).square()).exp();
    columns.add(turns.direction.cwiseProduct(VectorXd(slow)));
    // Friction that is smooth in speed turns before the motion does, and would look as if it ran ahead.
    columns.add((speed.array() / (share * rms(speed))).tanh());
  }
  const VectorXd time = VectorXd::LinSpaced(q1.size(), -1.0, 1.0);
  columns.add(time);
  columns.add(time.cwiseProduct(time));
  if (channels.tau != nullptr) {
    add_torque(channels, turns, direction, columns);
  }
  return columns.take();
}

}  // namespace capstan::tools
