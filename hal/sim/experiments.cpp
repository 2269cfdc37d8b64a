// SPDX-License-Identifier: Apache-2.0
#include "capstan/hal/sim/experiments.hpp"

#include <stdexcept>
#include <utility>

namespace capstan::sim {
namespace {

void check(const LadderShape& shape) {
  if (!(shape.amplitude_rad > 0.0 && shape.amplitude_rad <= 100.0))
    throw std::invalid_argument("the amplitude must be above 0; give the ladder's amplitude");
  if (shape.cycles < 1 || shape.cycles > 1000)
    throw std::invalid_argument("cycles must be 1 to 1000; give how often each rung repeats");
}

void check_rungs(const std::vector<double>& rungs) {
  if (rungs.empty() || rungs.size() > 1000)
    throw std::invalid_argument(
        "a ladder needs its rungs; give frequencies_hz, speeds_rad_per_s or speeds_nm_per_s = [...]");
  for (const double rung : rungs) {
    if (!(rung > 0.0 && rung <= 1000.0))
      throw std::invalid_argument("a ladder's rungs must be above 0; correct the list");
  }
}

Segment polyline(const LadderShape& shape, double speed, std::vector<double> points) {
  Segment segment{.kind = SegmentKind::kPolyline,
                  .offset_rad = shape.offset_rad,
                  .corner_s = shape.corner_s,
                  .speed_rad_per_s = speed,
                  .points_rad = std::move(points)};
  segment.duration_s = polyline_duration_s(segment);
  return segment;
}

}  // namespace

std::vector<Segment> sine_ladder(const LadderShape& shape, const std::vector<double>& frequencies_hz) {
  check(shape);
  check_rungs(frequencies_hz);
  std::vector<Segment> segments;
  for (const double frequency : frequencies_hz) {
    segments.push_back({.kind = SegmentKind::kSine,
                        .duration_s = static_cast<double>(shape.cycles) / frequency,
                        .offset_rad = shape.offset_rad,
                        .amplitude_rad = shape.amplitude_rad,
                        .frequency_hz = frequency});
  }
  return segments;
}

std::vector<Segment> speed_ladder(const LadderShape& shape, const std::vector<double>& speeds_rad_per_s) {
  check(shape);
  check_rungs(speeds_rad_per_s);
  std::vector<Segment> segments;
  for (const double speed : speeds_rad_per_s) {
    std::vector<double> points = {0.0};
    for (int i = 0; i < shape.cycles; ++i)
      points.insert(points.end(), {shape.amplitude_rad, -shape.amplitude_rad});
    points.push_back(0.0);
    segments.push_back(polyline(shape, speed, std::move(points)));
  }
  return segments;
}

std::vector<Segment> reversal_staircase(const LadderShape& shape, int levels, double speed_rad_per_s) {
  check(shape);
  check_rungs({speed_rad_per_s});
  if (levels < 2 || levels > 1000)
    throw std::invalid_argument("levels must be 2 to 1000; give how many reversal angles there are");
  std::vector<double> points = {0.0, -shape.amplitude_rad};
  for (int i = 1; i <= levels; ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(levels);
    points.insert(points.end(), {shape.amplitude_rad * (2.0 * share - 1.0), -shape.amplitude_rad});
  }
  points.push_back(0.0);
  return {polyline(shape, speed_rad_per_s, std::move(points))};
}

}  // namespace capstan::sim
