// SPDX-License-Identifier: Apache-2.0
// What a response and gains make of the loop, and how far that is from -1.
#include "capstan/tools/response/loop.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numbers>

#include "capstan/model/scalar.hpp"
#include "capstan/tools/support/errors.hpp"

namespace capstan::tools {
namespace {

constexpr int kBetween = 8;  // points from line to line

// Numbers that decide, chosen in November 2026 on logs of the simulated forceps, seeds 1 to 3, 11 to 15 and 33; what
// response_on_plant_test and docs/tuning.md report of margins is of seeds 31 and 32.
constexpr double kMostCircle = 0.5;  // radius over value; above, the phase is anybody's guess
constexpr std::size_t kLeastLines = 5;
constexpr double kLowGain = 1.0 / 3.0;

auto between(Complex a, Complex b, double share) -> Complex {
  const double turn = std::arg(b / a);
  return std::polar(std::abs(a) * std::pow(std::abs(b) / std::abs(a), share), std::arg(a) + share * turn);
}

/// Those whose circles are smaller than `most` allows there. Where the gain is low the circle alone decides, for the
/// gain margin is looked for there; elsewhere the line has to be coherent, too.
template <typename Most>
auto points_within(const Response& response, Most&& most) -> std::vector<ResponsePoint> {
  std::vector<ResponsePoint> within;
  std::copy_if(response.points.begin(), response.points.end(), std::back_inserter(within),
               [&](const ResponsePoint& point) {
                 const bool coherent = point.coherence >= kLeastCoherence || std::abs(point.loop.value) < kLowGain;
                 return coherent && point.motor.radius95 < most(point);
               });
  return within;
}

}  // namespace

auto sense_of(const Dense& all) -> double {
  double sum = 0.0;
  for (const Complex& one : all.joint) {
    sum += one.real();
  }
  return sum < 0.0 ? -1.0 : 1.0;
}

auto law_of(const LoopGains& gains, double hz) -> Law {
  const Complex back = std::polar(1.0, -2.0 * std::numbers::pi * hz * kCycleS);
  const double gain = SamplePeriod<double>(kCycleS).filter_gain(gains.rate_time_constant_s);
  const Complex rate = (1.0 - back) / kCycleS;
  return {.servo = gains.stiffness + gains.damping * rate * gain / (1.0 - (1.0 - gain) * back),
          .joint = gains.kp + gains.ki_per_s * kCycleS / (1.0 - back) + gains.kd_s * rate};
}

/// Of the amplitude, where too few lines tell by how much it lacks.
constexpr double kLouderForLines = 1.5;

auto clear_points(const Response& response) -> std::vector<ResponsePoint> {
  const auto clear =
      points_within(response, [](const ResponsePoint& point) { return kMostCircle * std::abs(point.motor.value); });
  if (clear.size() < kLeastLines) {
    throw FaintShake(response.name + ": only " + std::to_string(clear.size()) +
                         " lines rise clearly above the noise; shake with a larger amplitude, or for longer",
                     kLouderForLines);
  }
  return clear;
}

auto points_above_noise(const Response& response, const MotorModel& model) -> std::vector<ResponsePoint> {
  auto above = points_within(response, [&](const ResponsePoint& point) { return std::abs(model.at(point.hz)); });
  return above.size() < kLeastLines ? clear_points(response) : above;
}

auto dense(const Response& response) -> Dense {
  Dense all;
  all.model = fit_motor_and_joint(response);
  all.motor_speed_rad_s = response.motor_speed_rad_s;
  all.friction_nm = 0.5 * std::fabs(response.forward_nm - response.backward_nm);
  const MotorModel& model = all.model;
  const std::vector<ResponsePoint> points = points_above_noise(response, model);
  const Smoothing smoothing(points, model);
  const auto add = [&](const ResponsePoint& a, const ResponsePoint& b, double share) {
    const auto mix = [share](double x, double y) { return x + share * (y - x); };
    const double hz = a.hz * std::pow(b.hz / a.hz, share);
    const Estimate motor = smoothing.at(hz);
    const double motor_share = motor.radius95 / std::abs(motor.value);
    all.hz.push_back(hz);
    all.motor.push_back(motor.value);
    all.joint.push_back(between(a.joint.value, b.joint.value, share));
    all.loop.push_back(motor.value * between(a.loop.value / a.motor.value, b.loop.value / b.motor.value, share));
    // Between the lines a resonance is as the model has it, and what is left of the response runs straight.
    all.drawn.push_back(model.at(hz) * between(a.loop.value / model.at(a.hz), b.loop.value / model.at(b.hz), share));
    all.motor_share.push_back(motor_share);
    all.joint_share.push_back(
        mix(a.joint.radius95 / std::abs(a.joint.value), b.joint.radius95 / std::abs(b.joint.value)));
    all.loop_radius.push_back(motor_share * std::abs(all.loop.back()));
    all.drawn_radius.push_back(mix(a.loop.radius95, b.loop.radius95));
  };
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    for (int k = 0; k < kBetween; ++k) {
      add(points[i], points[i + 1], static_cast<double>(k) / kBetween);
    }
  }
  add(points.back(), points.back(), 0.0);
  return all;
}

auto through_joint(const LoopGains& gains, const Law& law, double sense, Complex joint) -> Complex {
  return sense * gains.stiffness * law.joint * joint;
}

auto loop_of(const Dense& all, const LoopGains& gains) -> std::vector<LoopPoint> {
  const double sense = sense_of(all);
  std::vector<LoopPoint> loop;
  for (std::size_t i = 0; i < all.hz.size(); ++i) {
    const Law law = law_of(gains, all.hz[i]);
    const Complex by_joint = through_joint(gains, law, sense, all.joint[i]);
    const Complex feedback = law.servo + by_joint;
    const double radius =
        std::abs(all.motor[i]) * (all.motor_share[i] * std::abs(feedback) + all.joint_share[i] * std::abs(by_joint));
    loop.push_back({all.hz[i], all.motor[i] * feedback, radius});
  }
  return loop;
}

auto outer_loop(const Dense& all, const LoopGains& gains) -> std::vector<LoopPoint> {
  const double sense = sense_of(all);
  std::vector<LoopPoint> loop;
  for (std::size_t i = 0; i < all.hz.size(); ++i) {
    const Law law = law_of(gains, all.hz[i]);
    const Complex inner = 1.0 + all.motor[i] * law.servo;
    loop.push_back({all.hz[i], through_joint(gains, law, sense, all.joint[i]) * all.motor[i] / inner, 0.0});
  }
  return loop;
}

auto predicted_loop(const Response& response, const LoopGains& gains) -> std::vector<LoopPoint> {
  return loop_of(dense(response), gains);
}

auto measured_loop(const Response& response) -> std::vector<LoopPoint> {
  return measured_loop(dense(response));
}

auto measured_loop(const Dense& all) -> std::vector<LoopPoint> {
  std::vector<LoopPoint> loop;
  for (std::size_t i = 0; i < all.hz.size(); ++i) {
    loop.push_back({all.hz[i], all.loop[i], all.loop_radius[i]});
  }
  return loop;
}

auto margins_of(const std::vector<LoopPoint>& loop, bool with_circle) -> Margins {
  Margins margins;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const double radius = with_circle ? loop[i].radius95 : 0.0;
    const double size = std::abs(loop[i].value);
    if (const double modulus = std::abs(1.0 + loop[i].value) - radius; modulus < margins.modulus) {
      margins.modulus = modulus;
      margins.modulus_hz = loop[i].hz;
    }
    if (i == 0) {
      continue;
    }
    const Complex before = loop[i - 1].value;
    const Complex now = loop[i].value;
    if ((std::abs(before) > 1.0) != (size > 1.0)) {
      margins.crossover_hz = loop[i].hz;
      const double share = std::log(1.0 / std::abs(before)) / std::log(size / std::abs(before));
      const Complex at = between(before, now, share);
      const double off = std::asin(std::min(1.0, radius)) * 180.0 / std::numbers::pi;
      const double phase = std::fabs(std::arg(-at)) * 180.0 / std::numbers::pi - off;  // from -1, either way round
      if (phase < margins.phase_deg) {
        margins.phase_deg = phase;
        margins.phase_hz = loop[i].hz;
      }
    }
    if (before.real() < 0.0 && now.real() < 0.0 && (before.imag() < 0.0) != (now.imag() < 0.0)) {
      const double share = before.imag() / (before.imag() - now.imag());
      const double at = std::abs(before + share * (now - before));
      const double db = at < 1.0 ? -20.0 * std::log10(at + radius) : 20.0 * std::log10(std::max(1e-9, at - radius));
      if (db < margins.gain_db) {
        margins.gain_db = db;
        margins.gain_hz = loop[i].hz;
      }
    }
  }
  // Where the phase does not come to 180 deg by the last line, the gain there bounds the margin.
  const double last = std::abs(loop.back().value) + (with_circle ? loop.back().radius95 : 0.0);
  if (margins.gain_hz < margins.crossover_hz && last < 1.0) {
    margins.gain_db = std::min(margins.gain_db, -20.0 * std::log10(last));
    margins.gain_hz = loop.back().hz;
  }
  return margins;
}

auto worse(const Margins& a, const Margins& b) -> Margins {
  Margins least = a;
  if (b.phase_deg < a.phase_deg) {
    least.phase_deg = b.phase_deg;
    least.phase_hz = b.phase_hz;
  }
  if (b.gain_db < a.gain_db) {
    least.gain_db = b.gain_db;
    least.gain_hz = b.gain_hz;
  }
  if (b.modulus < a.modulus) {
    least.modulus = b.modulus;
    least.modulus_hz = b.modulus_hz;
  }
  least.crossover_hz = std::min(a.crossover_hz, b.crossover_hz);
  return least;
}

auto measured_margins(const Response& response, bool with_circle) -> Margins {
  std::optional<Margins> least;
  for (const Response* view : views_of(response)) {
    const Margins margins = margins_of(measured_loop(*view), with_circle);
    least = least ? worse(*least, margins) : margins;
  }
  return *least;
}

auto as_stable_as(const std::vector<LoopPoint>& loop, const std::vector<LoopPoint>& known) -> bool {
  double turned = 0.0;
  Complex before = (1.0 + loop.front().value) / (1.0 + known.front().value);
  double first = std::arg(before);
  for (std::size_t i = 1; i < loop.size(); ++i) {
    const Complex now = (1.0 + loop[i].value) / (1.0 + known[i].value);
    turned += std::arg(now / before);
    before = now;
  }
  // From its value at the first line to that at the last, without a turn round zero.
  return std::fabs(first + turned) < std::numbers::pi;
}

}  // namespace capstan::tools
