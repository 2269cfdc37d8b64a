// SPDX-License-Identifier: Apache-2.0
#include "capstan/tests/tools/machines/drawn_motion.hpp"

#include <algorithm>

namespace capstan::tools::machines {

using Eigen::ArrayXd;

namespace {

constexpr Eigen::Index kMostRows = 9000;

auto moving_mean(const ArrayXd& x, Eigen::Index half) -> ArrayXd {
  ArrayXd sums(x.size() + 1);
  sums[0] = 0.0;
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    sums[i + 1] = sums[i] + x[i];
  }
  ArrayXd mean(x.size());
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const Eigen::Index reach = std::min({half, i, x.size() - 1 - i});
    mean[i] = (sums[i + reach + 1] - sums[i - reach]) / static_cast<double>(2 * reach + 1);
  }
  return mean;
}

auto sines(Draw& draw, const ArrayXd& t) -> ArrayXd {
  ArrayXd q = ArrayXd::Zero(t.size());
  for (int i = 0; i < 5; ++i) {
    q += draw(0.3, 1.0) * (kTurn * draw.in_ratio(0.05, 0.7) * t + draw(0.0, kTurn)).sin();
  }
  return (q - q[0]) / (q - q[0]).abs().maxCoeff();
}

auto triangles(Draw& draw, const ArrayXd& t) -> ArrayXd {
  constexpr std::array kHeights = {1.0, 0.8, 0.6, 0.35};
  ArrayXd q(t.size());
  double at = 0.0;
  double target = draw.one_of(kHeights);
  double speed = draw(0.4, 1.2);
  for (Eigen::Index i = 0; i < t.size(); ++i) {
    at += std::copysign(speed * t[1], target);
    q[i] = at;
    if (std::abs(at) >= std::abs(target) && at * target > 0.0) {
      target = -std::copysign(draw.one_of(kHeights), target);
      speed = draw(0.4, 1.2);
    }
  }
  return moving_mean(moving_mean(q, std::lround(0.03 / t[1])), std::lround(0.03 / t[1]));
}

auto decaying_sine(Draw& draw, const ArrayXd& t) -> ArrayXd {
  const double rate = draw(0.5, 1.5) / t[t.size() - 1];
  return (-rate * t).exp() * (kTurn * draw.in_ratio(0.1, 0.4) * t).sin();
}

/// From place to place with the least jerk, resting at each.
auto reaches(Draw& draw, const ArrayXd& t) -> ArrayXd {
  ArrayXd q(t.size());
  double from = 0.0;
  for (Eigen::Index i = 0; i < t.size();) {
    const double to = draw(-1.0, 1.0);
    const double takes = draw(0.6, 2.0);
    const double until = t[i] + takes + draw(0.0, 0.8);
    for (const double began = t[i]; i < t.size() && t[i] <= until; ++i) {
      const double s = std::min(1.0, (t[i] - began) / takes);
      q[i] = from + (to - from) * s * s * s * (10.0 - 15.0 * s + 6.0 * s * s);
    }
    from = to;
  }
  return q;
}

auto chirp(Draw& draw, const ArrayXd& t) -> ArrayXd {
  return (kTurn * (0.05 * t + 0.5 * draw.in_ratio(0.3, 0.8) / t[t.size() - 1] * t.square())).sin();
}

}  // namespace

Motion::Motion(const ArrayXd& angle, double step_s) : t(angle.size()), q(angle), v(angle.size()), a(angle.size()) {
  const Eigen::Index last = q.size() - 1;
  for (Eigen::Index i = 0; i <= last; ++i) {
    const Eigen::Index j = std::clamp<Eigen::Index>(i, 1, last - 1);
    t[i] = step_s * static_cast<double>(i);
    v[i] = (q[j + 1] - q[j - 1]) / (2.0 * step_s);
    a[i] = (q[j + 1] - 2.0 * q[j] + q[j - 1]) / (step_s * step_s);
  }
  amplitude = q.abs().maxCoeff();
  top_speed = v.abs().maxCoeff();
}

const std::array<std::pair<const char*, MotionKind>, 5> kMotions = {
    {{"sines", sines}, {"triangles", triangles}, {"decay", decaying_sine}, {"reaches", reaches}, {"chirp", chirp}}};

auto motion_of(Draw& draw, MotionKind kind, double seconds, double period_s, double amplitude) -> Motion {
  const double step_s = period_s / static_cast<double>(kSteps);
  const auto rows = std::min(kMostRows, static_cast<Eigen::Index>(seconds / period_s));
  const ArrayXd t = ArrayXd::LinSpaced(rows * kSteps, 0.0, step_s * static_cast<double>(rows * kSteps - 1));
  return {amplitude * kind(draw, t), step_s};
}

}  // namespace capstan::tools::machines
