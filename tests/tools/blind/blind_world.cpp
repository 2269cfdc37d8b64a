// SPDX-License-Identifier: Apache-2.0
#include "capstan/tests/tools/blind/blind_world.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace capstan::tools::blind {
namespace {

constexpr double kPi = std::numbers::pi;

/// Points of rest from one to the next along half a cosine, with a short hold at each.
auto swings(const Signal& time, double cycle_s, const std::vector<double>& points, const std::vector<double>& lengths)
    -> Signal {
  double total = 0.0;
  for (const double length : lengths) {
    total += 1.15 * length;
  }
  Signal q(time.size());
  for (Eigen::Index i = 0; i < time.size(); ++i) {
    double left = std::fmod(time[i], cycle_s) / cycle_s * total;
    std::size_t k = 0;
    while (k + 1 < lengths.size() && left >= 1.15 * lengths[k]) {
      left -= 1.15 * lengths[k];
      ++k;
    }
    const double share = std::min(1.0, left / lengths[k]);
    const double next = points[(k + 1) % points.size()];
    q[i] = points[k] + (next - points[k]) * 0.5 * (1.0 - std::cos(kPi * share));
  }
  return q;
}

auto sines(const Signal& time, double cycle_s, const std::vector<int>& harmonics, double slope, Draw& draw) -> Signal {
  Signal q = Signal::Zero(time.size());
  for (const int h : harmonics) {
    const double phase = draw.between(0.0, 2.0 * kPi);
    q += std::pow(static_cast<double>(h), slope) * (2.0 * kPi * h / cycle_s * time + phase).sin();
  }
  return q;
}

auto triangles(const Signal& time, double cycle_s, int wealth, Draw& draw) -> Signal {
  std::vector<double> points = {0.0};
  std::vector<double> lengths;
  for (const double speed : {0.2, 0.5, 1.2, 3.0}) {
    for (int k = 0; k < 2 * wealth; ++k) {
      points.push_back((points.size() % 2 == 1 ? 1.0 : -1.0) * draw.between(0.4, 1.2));
      lengths.push_back(std::abs(points.back() - points[points.size() - 2]) / speed);
    }
  }
  lengths.push_back(std::abs(points.back()));
  double total = 0.0;
  for (const double length : lengths) {
    total += length;
  }
  Signal q(time.size());
  for (Eigen::Index i = 0; i < time.size(); ++i) {
    double left = std::fmod(time[i], cycle_s) / cycle_s * total;
    std::size_t k = 0;
    while (k + 1 < lengths.size() && left >= lengths[k]) {
      left -= lengths[k];
      ++k;
    }
    const double next = k + 1 < points.size() ? points[k + 1] : points[0];
    q[i] = points[k] + (next - points[k]) * std::min(1.0, left / lengths[k]);
  }
  return q;
}

auto slope_of(const Signal& signal) -> Signal {
  Signal slope = Signal::Zero(signal.size());
  for (Eigen::Index i = 1; i + 1 < signal.size(); ++i) {
    slope[i] = (signal[i + 1] - signal[i - 1]) / (2.0 * kStep);
  }
  return slope;
}

/// A motor that can not jump: what is asked for, through two lags.
/// `wealth`: how many cycles' worth of different motion one cycle has.
auto motor_motion(const Case& c, const Signal& time, double cycle_s, int wealth, Draw& draw) -> Signal {
  Signal wanted;
  switch (c.motion) {
    case Motion::kSine:
      wanted = (2.0 * kPi * std::round(cycle_s / draw.between(3.0, 8.0)) / cycle_s * time).sin();
      break;
    case Motion::kMultisine:
      wanted = wealth == 1 ? sines(time, cycle_s, {2, 3, 5, 8, 13, 21, 34}, -0.5, draw) * 0.6
                           : sines(time, cycle_s, {7, 13, 19, 33, 53, 85, 137}, -0.5, draw) * 1.2;
      break;
    case Motion::kLadder: {
      std::vector<double> points = {0.0};
      std::vector<double> lengths;
      for (int k = 0; k < 10 * wealth; ++k) {
        const double next = k == 10 * wealth - 1 ? 0.0 : (k % 2 == 0 ? 1.0 : -1.0) * draw.between(0.05, 1.2);
        lengths.push_back(draw.ratio_between(0.3, 2.0));
        points.push_back(next);
      }
      wanted = swings(time, cycle_s, points, lengths);
      break;
    }
    case Motion::kTriangles:
      wanted = triangles(time, cycle_s, wealth, draw);
      break;
  }
  return low_passed(low_passed(wanted, 0.03), 0.03);
}

auto true_direction(const Signal& speed) -> Signal {
  Signal sign(speed.size());
  double now = 1.0;
  for (Eigen::Index i = 0; i < speed.size(); ++i) {
    now = std::abs(speed[i]) < 1e-7 ? now : (speed[i] > 0.0 ? 1.0 : -1.0);
    sign[i] = now;
  }
  return sign;
}

auto seen_direction(const Signal& q, double step) -> Signal {
  Signal sign(q.size());
  double now = 1.0;
  double before = std::round(q[0] / step);
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    const double count = std::round(q[i] / step);
    now = count == before ? now : (count > before ? 1.0 : -1.0);
    before = count;
    sign[i] = now;
  }
  return sign;
}

/// Gives the world a direction, and what follows from it: the torque at the last reversal, the joint's angle.
void set_direction(World& w, Signal sign) {
  w.sign = std::move(sign);
  w.tau_turned.resize(w.q.size());
  double turned = w.tau[0];
  for (Eigen::Index i = 0; i < w.q.size(); ++i) {
    if (i > 0 && w.sign[i] != w.sign[i - 1]) {
      turned = w.tau[i];
    }
    w.tau_turned[i] = turned;
  }
  w.joint = w.beta * w.q + w.offset + by_direction(w, w.elongation_top, w.elongation_bottom) * w.tau;
}

}  // namespace

auto low_passed(const Signal& input, double time_s) -> Signal {
  const double share = 1.0 - std::exp(-kStep / time_s);
  Signal output(input.size());
  double x = input[0];
  for (Eigen::Index i = 0; i < input.size(); ++i) {
    x += (input[i] - x) * share;
    output[i] = x;
  }
  return output;
}

auto bristle(const Signal& path, double width) -> Signal {
  Signal z(path.size());
  double state = 0.0;
  for (Eigen::Index i = 0; i < path.size(); ++i) {
    const double step = i > 0 ? path[i] - path[i - 1] : 0.0;
    state += step - std::abs(step) * state / width;
    z[i] = state;
  }
  return z;
}

auto by_direction(const World& w, double top, double bottom) -> Signal {
  return 0.5 * (top + bottom) + 0.5 * (top - bottom) * w.sign;
}

auto outside_base(const World& w, const Signal& effect) -> Signal {
  Eigen::MatrixXd base(w.q.size(), 4);
  base << w.q, Signal::Ones(w.q.size()), w.tau * (w.sign > 0.0).cast<double>(), w.tau * (w.sign < 0.0).cast<double>();
  const Eigen::VectorXd theta = (base.transpose() * base).ldlt().solve(base.transpose() * effect.matrix());
  return effect - (base * theta).array();
}

auto world_of(const Case& c, Draw& draw) -> World {
  World w;
  const double cycle_s = draw.between(18.0, 30.0);
  w.duration = 4.0 * cycle_s;
  const auto steps = static_cast<Eigen::Index>(w.duration / kStep);
  w.time = Signal::LinSpaced(steps, 0.0, static_cast<double>(steps - 1) * kStep);
  const double repeated_s = c.repeats ? cycle_s : w.duration;
  w.q = motor_motion(c, w.time, repeated_s, c.repeats ? 1 : 4, draw);
  w.q *= draw.between(0.8, 1.6);
  w.speed = slope_of(w.q);
  w.acceleration = low_passed(slope_of(w.speed), 0.005);
  w.other_q = sines(w.time, repeated_s, {3, 7, 11}, -0.3, draw) * 0.5;
  w.other_tau = 0.05 * w.other_q + 0.02 * (slope_of(w.other_q) / 0.05).tanh();
  const Signal load = draw.between(0.01, 0.03) * sines(w.time, repeated_s, {3, 7}, 0.0, draw);
  w.tau = draw.between(0.02, 0.05) * w.q + draw.between(0.015, 0.03) / 0.01 * bristle(w.q, 0.01) +
          draw.between(0.002, 0.005) * w.speed + load;
  w.temperature = 22.0 + draw.between(5.0, 15.0) * (1.0 - (-w.time / (draw.between(0.3, 1.0) * w.duration)).exp());
  w.beta = draw.between(0.8, 1.3);
  w.offset = draw.between(-0.1, 0.1);
  w.elongation_top = -draw.between(0.6, 1.0);
  w.elongation_bottom = -draw.between(0.4, 0.8);
  set_direction(w, true_direction(w.speed));
  w.tau_span = w.tau.maxCoeff() - w.tau.minCoeff();
  w.q_span = w.q.maxCoeff() - w.q.minCoeff();
  return w;
}

auto as_seen(World world, double step) -> World {
  set_direction(world, seen_direction(world.q, step));
  return world;
}

}  // namespace capstan::tools::blind
