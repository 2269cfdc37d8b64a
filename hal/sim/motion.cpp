// SPDX-License-Identifier: Apache-2.0
#include "capstan/hal/sim/motion.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "capstan/hal/sim/deterministic_math.hpp"

namespace capstan::sim {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kFastestHz = 200.0;

void require(bool condition, const char* sentence) {
  if (!condition)
    throw std::invalid_argument(sentence);
}

Kinematics add(const Kinematics& a, const Kinematics& b, double sign) {
  return {a.angle_rad + sign * b.angle_rad, a.rate_rad_per_s + sign * b.rate_rad_per_s,
          a.acceleration_rad_per_s2 + sign * b.acceleration_rad_per_s2};
}

Kinematics tone(double amplitude, double frequency_hz, double phase_rad, double t) {
  const double w = 2.0 * kPi * frequency_hz;
  const double s = amplitude * det_sin(w * t + phase_rad);
  return {s, w * amplitude * det_cos(w * t + phase_rad), -w * w * s};
}

Kinematics decaying(const Segment& g, double t) {
  const Kinematics plain = tone(g.amplitude_rad, g.frequency_hz, g.phase_rad, t);
  const double e = det_exp(-g.decay_per_s * t);
  const double d = g.decay_per_s;
  return {e * plain.angle_rad, e * (plain.rate_rad_per_s - d * plain.angle_rad),
          e * (plain.acceleration_rad_per_s2 - 2.0 * d * plain.rate_rad_per_s + d * d * plain.angle_rad)};
}

// Rate: a trapezoidal wave, +V on the way up, -V on the way down, linear through zero within `corner` around each peak.
Kinematics triangle(const Segment& g, double t) {
  const double period = 1.0 / g.frequency_hz;
  const double corner = g.corner_s;
  const double speed = g.amplitude_rad / (period / 4.0 - corner / 4.0);
  const double turns = t / period + g.phase_rad / (2.0 * kPi) + 0.25;  // 0 at the lower peak
  const double within = (turns - std::floor(turns)) * period;
  const bool rising = within < period / 2.0;
  const double since_peak = rising ? within : within - period / 2.0;
  const double to_peak = period / 2.0 - since_peak;
  const double nearest = std::min(since_peak, to_peak);
  const double sign = rising ? 1.0 : -1.0;
  if (nearest >= corner / 2.0) {
    const double from_middle = since_peak - period / 4.0;
    return {sign * speed * from_middle, sign * speed, 0.0};
  }
  const double bend = speed / (corner / 2.0);
  const double drop = 0.5 * bend * nearest * nearest;
  const double end = since_peak < to_peak ? -1.0 : 1.0;  // which peak of this flank
  return {sign * end * (g.amplitude_rad - drop), sign * bend * nearest, -sign * end * bend};
}

struct Leg {
  double distance, speed, duration_s;
};

// Speeds up for one corner, slows down for another; a leg too short for that never reaches the speed.
Leg leg(const Segment& g, std::size_t number) {
  const double distance = g.points_rad[number + 1] - g.points_rad[number];
  const double speed = std::min(g.speed_rad_per_s, std::fabs(distance) / g.corner_s);
  const double cruise = speed > 0.0 ? std::fabs(distance) / speed : 0.0;
  return {distance, distance < 0.0 ? -speed : speed, cruise + g.corner_s};
}

Kinematics polyline(const Segment& g, double t) {
  std::size_t number = 0;
  Leg now = leg(g, 0);
  while (t > now.duration_s && number + 2 < g.points_rad.size()) {
    t -= now.duration_s;
    now = leg(g, ++number);
  }
  const double from = g.points_rad[number];
  const double bend = now.speed / g.corner_s;
  const double left = now.duration_s - t;
  if (left <= 0.0)
    return {from + now.distance, 0.0, 0.0};
  if (t < g.corner_s)
    return {from + 0.5 * bend * t * t, bend * t, bend};
  if (left < g.corner_s)
    return {from + now.distance - 0.5 * bend * left * left, bend * left, -bend};
  return {from + now.speed * (t - 0.5 * g.corner_s), now.speed, 0.0};
}

Kinematics multisine(const Segment& g, double scale, double t) {
  Kinematics sum;
  const auto count = static_cast<double>(g.frequencies_hz.size());
  double k = 1.0;
  for (const double frequency : g.frequencies_hz) {
    sum = add(sum, tone(scale, frequency, g.phase_rad - kPi * k * (k - 1.0) / count, t), 1.0);
    k += 1.0;
  }
  return sum;
}

Kinematics shape(const Segment& g, double scale, double t) {
  Kinematics k;
  switch (g.kind) {
    case SegmentKind::kSine:
      k = tone(g.amplitude_rad, g.frequency_hz, g.phase_rad, t);
      break;
    case SegmentKind::kMultisine:
      k = multisine(g, scale, t);
      break;
    case SegmentKind::kDecayingSine:
      k = decaying(g, t);
      break;
    case SegmentKind::kTriangle:
      k = triangle(g, t);
      break;
    case SegmentKind::kPolyline:
      k = polyline(g, t);
      break;
    case SegmentKind::kHold:
      break;
  }
  k.angle_rad += g.offset_rad;
  return k;
}

// Goes from `start` to zero over `blend`, with angle, rate and acceleration zero at its end.
Kinematics fade(const Kinematics& start, double blend, double t) {
  if (t >= blend)
    return {};
  const double s = t / blend;
  const double s2 = s * s;
  const double s3 = s2 * s;
  const double x = start.angle_rad;
  const double v = start.rate_rad_per_s * blend;
  const double a = start.acceleration_rad_per_s2 * blend * blend;
  const double angle = x * (1.0 - s3 * (10.0 - 15.0 * s + 6.0 * s2)) + v * (s - s3 * (6.0 - 8.0 * s + 3.0 * s2)) +
                       0.5 * a * s2 * (1.0 - 3.0 * s + 3.0 * s2 - s3);
  const double rate = -30.0 * x * s2 * (1.0 - 2.0 * s + s2) + v * (1.0 - s2 * (18.0 - 32.0 * s + 15.0 * s2)) +
                      0.5 * a * s * (2.0 - 9.0 * s + 12.0 * s2 - 5.0 * s3);
  const double acceleration = -60.0 * x * s * (1.0 - 3.0 * s + 2.0 * s2) - v * s * (36.0 - 96.0 * s + 60.0 * s2) +
                              0.5 * a * (2.0 - 18.0 * s + 36.0 * s2 - 20.0 * s3);
  return {angle, rate / blend, acceleration / (blend * blend)};
}

void check_polyline(const Segment& g) {
  require(g.points_rad.size() >= 2,
          "a polyline needs two points or more; give points_rad = [...], or points_nm of a torque");
  require(g.speed_rad_per_s > 0.0 && g.speed_rad_per_s <= 1.0e3,
          "a polyline's speed must be above 0; give speed_rad_per_s, or speed_nm_per_s of a torque");
  require(g.corner_s > 0.0, "corner_s must be above 0; a motion cannot turn at once");
  for (const double point : g.points_rad)
    require(std::fabs(point) <= 100.0, "the points are beyond 100; give angles in rad or torques in N m");
}

void check(const Segment& g, double blend_s) {
  if (g.kind == SegmentKind::kPolyline)
    check_polyline(g);
  require(g.duration_s > 0.0 && g.duration_s <= 1.0e6,
          "duration_s must be above 0 and at most 1e6; give the segment's length in seconds");
  require(g.duration_s >= blend_s, "a segment is shorter than blend_s; lengthen it or shorten the blend");
  require(std::fabs(g.amplitude_rad) <= 100.0, "the amplitude is beyond 100; give an angle in rad or a torque in N m");
  require(std::fabs(g.offset_rad) <= 100.0, "the offset is beyond 100; give an angle in rad or a torque in N m");
  const bool periodic =
      g.kind != SegmentKind::kHold && g.kind != SegmentKind::kMultisine && g.kind != SegmentKind::kPolyline;
  require(!periodic || (g.frequency_hz > 0.0 && g.frequency_hz <= kFastestHz),
          "frequency_hz must be above 0 and at most 200; give the segment's frequency");
  require(g.kind != SegmentKind::kMultisine || !g.frequencies_hz.empty(),
          "a multisine needs tones; give frequencies_hz = [...]");
  for (const double f : g.frequencies_hz) {
    require(f > 0.0 && f <= kFastestHz, "frequencies_hz must be above 0 and at most 200; correct the list");
  }
  require(g.decay_per_s >= 0.0 && g.decay_per_s <= 100.0, "decay_per_s must be 0 to 100; a motion cannot grow");
  require(g.kind != SegmentKind::kTriangle || (g.corner_s > 0.0 && g.corner_s <= 0.5 / g.frequency_hz),
          "corner_s must be above 0 and at most half a period; shorten it");
}

// The multisine's peak is found on a grid of 2 ms: at the fastest tone in use (some Hz) that misses less than 0.1 %.
double scale_of(const Segment& g) {
  if (g.kind != SegmentKind::kMultisine)
    return g.amplitude_rad;
  double peak = 0.0;
  const auto steps = static_cast<long>(g.duration_s / 0.002);
  for (long i = 0; i <= steps; ++i) {
    peak = std::max(peak, std::fabs(multisine(g, 1.0, 0.002 * static_cast<double>(i)).angle_rad));
  }
  return peak > 0.0 ? g.amplitude_rad / peak : 0.0;
}

}  // namespace

double polyline_duration_s(const Segment& segment) {
  double sum = 0.0;
  for (std::size_t i = 0; i + 1 < segment.points_rad.size(); ++i)
    sum += leg(segment, i).duration_s;
  return sum;
}

Motion::Motion(std::vector<Segment> segments, int repeat, double blend_s, Quantity quantity)
    : segments_(std::move(segments)), blend_s_(blend_s), repeat_(repeat), quantity_(quantity) {
  require(!segments_.empty(), "the motion has no segments; give at least one");
  require(repeat >= 1 && repeat <= 100000, "repeat must be 1 to 100000; give a count");
  require(blend_s >= 0.01 && blend_s <= 1000.0, "blend_s must be 0.01 to 1000; a blend keeps the speed bounded");
  for (const Segment& segment : segments_) {
    check(segment, blend_s);
    starts_s_.push_back(cycle_s_);
    cycle_s_ += segment.duration_s;
    scales_.push_back(scale_of(segment));
  }
}

double Motion::duration_s() const {
  return segments_.empty() ? 0.0 : cycle_s_ * static_cast<double>(repeat_) + blend_s_;
}

Kinematics Motion::end_of(std::size_t segment) const {
  return shape(segments_[segment], scales_[segment], segments_[segment].duration_s);
}

Kinematics Motion::at(double time_s) const {
  if (segments_.empty() || time_s < 0.0)
    return {};
  const double cycle = std::floor(time_s / cycle_s_);
  if (cycle >= static_cast<double>(repeat_)) {
    return fade(end_of(segments_.size() - 1), blend_s_, time_s - cycle_s_ * static_cast<double>(repeat_));
  }
  const double within = time_s - cycle * cycle_s_;
  const auto next = std::upper_bound(starts_s_.begin(), starts_s_.end(), within);
  const auto current = static_cast<std::size_t>(std::max<std::ptrdiff_t>(next - starts_s_.begin() - 1, 0));
  const double t = std::max(within - starts_s_[current], 0.0);
  const Segment& segment = segments_[current];
  const Kinematics plain = shape(segment, scales_[current], t);
  if (t >= blend_s_)
    return plain;
  const bool from_rest = current == 0 && cycle == 0.0;
  const Kinematics before = from_rest ? Kinematics{} : end_of(current > 0 ? current - 1 : segments_.size() - 1);
  return add(plain, fade(add(before, shape(segment, scales_[current], 0.0), -1.0), blend_s_, t), 1.0);
}

}  // namespace capstan::sim
