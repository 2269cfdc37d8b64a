// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

namespace capstan::sim {

enum class SegmentKind { kSine, kMultisine, kDecayingSine, kTriangle, kHold, kPolyline };

/// What a motion is of: the angle of a joint, rad, or the torque of a motor, N m. All that is called an angle, rad and
/// rad/s below is then a torque, N m and N m/s.
enum class Quantity { kAngle, kTorque };

/// One piece of a reference motion; t below counts from the start of the segment.
struct Segment {
  SegmentKind kind = SegmentKind::kHold;
  double duration_s = 1.0;
  double offset_rad = 0.0;     ///< added to every kind; the position of a hold
  double amplitude_rad = 0.0;  ///< peak; of a multisine, the peak of the sum over the segment
  double frequency_hz = 0.0;
  double phase_rad = 0.0;                   ///< of the (first) sine; triangle: same sense, starting upward through zero
  double decay_per_s = 0.0;                 ///< decaying sine: amplitude exp(-decay t)
  double corner_s = 0.05;                   ///< triangle, polyline: each peak is rounded by parabolas this long
  double speed_rad_per_s = 0.0;             ///< polyline: between the points, but for `corner` at each end of a leg
  std::vector<double> points_rad = {};      ///< polyline: from the first to the last, at rest at each
  std::vector<double> frequencies_hz = {};  ///< multisine: tone k has the phase phase - pi k (k - 1) / N (Schroeder)
};

/// How long a polyline takes.
[[nodiscard]] double polyline_duration_s(const Segment& segment);

struct Kinematics {
  double angle_rad = 0.0;
  double rate_rad_per_s = 0.0;
  double acceleration_rad_per_s2 = 0.0;
};

/// The joint reference over time: segments one after the other, the list repeated, then a return to rest at 0.
/// Angle, rate and acceleration are continuous everywhere: at the start of every segment what is missing to the end of
/// the one before (rest at 0 at the very start) fades out by a quintic over `blend_s`. So a repeated list is exactly
/// periodic from `blend_s` on.
class Motion {
 public:
  Motion() = default;

  /// Throws std::invalid_argument with "sentence; cure" on impossible segments.
  Motion(std::vector<Segment> segments, int repeat, double blend_s, Quantity quantity = Quantity::kAngle);

  [[nodiscard]] Kinematics at(double time_s) const;
  [[nodiscard]] double reference_rad(double time_s) const { return at(time_s).angle_rad; }

  /// Including the return to rest.
  [[nodiscard]] double duration_s() const;

  [[nodiscard]] bool empty() const { return segments_.empty(); }
  [[nodiscard]] Quantity quantity() const { return quantity_; }
  [[nodiscard]] double cycle_s() const { return cycle_s_; }
  [[nodiscard]] int repeat() const { return repeat_; }

 private:
  [[nodiscard]] Kinematics end_of(std::size_t segment) const;

  std::vector<Segment> segments_;
  std::vector<double> starts_s_;
  std::vector<double> scales_;  // per segment: amplitude of one tone
  double cycle_s_ = 0.0;
  double blend_s_ = 0.0;
  int repeat_ = 0;
  Quantity quantity_ = Quantity::kAngle;
};

}  // namespace capstan::sim
