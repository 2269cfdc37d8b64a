// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "capstan/model/low_pass.hpp"
#include "capstan/model/reciprocal.hpp"
#include "capstan/model/torque_law.hpp"

namespace capstan {

/// How the motion that a torque law explains is looked at.
template <typename Scalar>
struct MotionView {
  /// Of the law's file: the cubic through which its logs were seen, s.
  Scalar window_s = ScalarTraits<Scalar>::from(0.12);
  /// Speed below which the direction stays what it was, rad/s.
  Scalar standstill_rad_s = ScalarTraits<Scalar>::from(0.01);
  /// Time constant with which dry friction lets go at a standstill, s; 0: it holds.
  Scalar letting_go_s{};
};

/// Dry friction at rest. A motor that stands may carry any torque up to its friction either way, so what the last
/// motion left soon says nothing: brakes, integral action and creep have taken it over. Its share decays.
template <typename Scalar>
class RestingFriction {
 public:
  /// @param letting_go_s  time constant; 0: the friction of the last motion stays
  constexpr RestingFriction(SamplePeriod<Scalar> dt, Scalar letting_go_s)
      : lets_go_(letting_go_s > Scalar{}), share_(dt, letting_go_s) {
    restart();
  }
  constexpr void restart() { share_.start(Sample<Scalar>::kWhole); }
  /// @returns the share that acts, 1 while it moves
  constexpr auto update(bool moves) -> Scalar {
    if (moves || !lets_go_) {
      restart();
      return Sample<Scalar>::kWhole;
    }
    return share_.update(Scalar{});
  }

 private:
  bool lets_go_;
  LowPass<Scalar> share_;
};

/// Motion and torque a fixed number of samples ago, from both sides. With N samples, a quarter of the view's window:
///   q1 = q[k - N],  dq1 = (q[k - N/2] - q[k - 3 N/2]) / (N dt),  ddq1 = (q[k] - 2 q[k - N] + q[k - 2 N]) / (N dt)^2
/// The acceleration is the mean of the true one under a triangle 2 N wide. That lets through as much as the cubic does
/// (3 dB at 10.7 Hz with 0.12 s), after N samples instead of half a window, at the cost of three differences. One count
/// of a 40960-count encoder shows as 0.17 rad/s2 with 0.12 s.
template <typename Scalar>
class MotionWindow {
 public:
  /// N is even, and from 4 to this: at 1 kHz windows of 16 to 120 ms. Others count as the nearest.
  static constexpr std::int32_t kMostDelay = 30;

  constexpr MotionWindow(SamplePeriod<Scalar> dt, const MotionView<Scalar>& view)
      : delay_(delay_of(dt, view.window_s)),
        standstill_(view.standstill_rad_s),
        friction_(dt, view.letting_go_s),
        per_span_(dt.time_of(delay_)),
        per_square_((dt.time_of(delay_) * ScalarTraits<Scalar>::from(100.0)) *
                    (dt.time_of(delay_) * ScalarTraits<Scalar>::from(10.0))) {}

  /// N for a window, s.
  static constexpr auto delay_of(SamplePeriod<Scalar> dt, Scalar window) -> std::int32_t {
    std::int32_t whole = 0;
    typename ScalarTraits<Scalar>::Gain fraction{};
    constexpr Scalar kEighth = ScalarTraits<Scalar>::from(0.125);
    dt.split(window * kEighth, whole, fraction);
    const bool up = fraction >= ScalarTraits<Scalar>::fraction(0.5);
    return 2 * std::clamp<std::int32_t>(whole + (up ? 1 : 0), 2, kMostDelay / 2);
  }
  constexpr void restart() {
    count_ = 0;
    sample_ = {};
    friction_.restart();
  }
  /// N: how many samples ago it was.
  [[nodiscard]] constexpr auto delay() const -> std::int32_t { return delay_; }

  /// @returns whether the window is full, and the sample good
  constexpr auto update(const Measured<Scalar>& now) -> bool {
    next_ = (next_ + 1) % kRing;
    angle_[next_] = now.q1;
    torque_[next_ % kTorqueRing] = now.tau;
    count_ = std::min(count_ + 1, 2 * delay_ + 1);
    if (count_ <= 2 * delay_) {
      return false;
    }
    constexpr Scalar kReferenceTemperature = ScalarTraits<Scalar>::from(25.0);
    const Scalar middle = angle_ago(delay_);
    sample_.q1 = sample_.h = sample_.q2 = middle;
    sample_.tau = torque_[ago(delay_) % kTorqueRing];
    sample_.dq1 = sample_.dh = (angle_ago(delay_ / 2) - angle_ago(delay_ + delay_ / 2)) * per_span_;
    sample_.ddq1 = ((now.q1 - middle) - (middle - angle_ago(2 * delay_))) * per_square_;
    sample_.warmth =
        ScalarTraits<Scalar>::is_missing(now.temperature) ? Scalar{} : now.temperature - kReferenceTemperature;
    const bool moves = abs(sample_.dq1) > standstill_;
    sample_.forward = moves ? sample_.dq1 > Scalar{} : sample_.forward;
    sample_.grip = friction_.update(moves);
    sample_.saturated = is_cut(middle) || is_cut(sample_.tau) || is_cut(sample_.dq1) || is_cut(sample_.ddq1);
    return true;
  }
  /// Of N samples ago.
  [[nodiscard]] constexpr auto sample() const -> const Sample<Scalar>& { return sample_; }

 private:
  static constexpr std::size_t kRing = 64;
  static constexpr std::size_t kTorqueRing = 32;
  static_assert(2 * kMostDelay < kRing && kMostDelay < kTorqueRing && kRing % kTorqueRing == 0);

  static constexpr auto is_cut(Scalar x) -> bool { return ScalarTraits<Scalar>::is_saturated(x); }
  [[nodiscard]] constexpr auto ago(std::int32_t samples) const -> std::size_t {
    return (next_ + kRing - static_cast<std::size_t>(samples)) % kRing;
  }
  [[nodiscard]] constexpr auto angle_ago(std::int32_t samples) const -> Scalar { return angle_[ago(samples)]; }

  std::int32_t delay_;
  Scalar standstill_;
  RestingFriction<Scalar> friction_;
  Reciprocal<Scalar> per_span_;
  Reciprocal<Scalar> per_square_;  // for krad/s2
  std::array<Scalar, kRing> angle_{};
  std::array<Scalar, kTorqueRing> torque_{};
  std::size_t next_ = 0;
  std::int32_t count_ = 0;
  Sample<Scalar> sample_{};
};

/// What a torque law makes of one cycle.
template <typename Scalar>
struct DisturbanceEstimate {
  Scalar law_nm{};          ///< the law's torque of `delay` samples ago
  Scalar disturbance_nm{};  ///< torque that the law does not explain; 0 while not `known`
  bool known = false;       ///< the window is full, and no number met an end of its range
};

/// Torque measured less the law's, of the same instant, through a first-order low-pass: what pushes at the joint beside
/// its own motion, a contact or a collision. Causal and late on purpose: acceleration of an encoder needs samples from
/// both sides. What it says is N samples old (MotionWindow), and the low-pass, of N samples too, has shown 63 % of a
/// step after as many more: 30 and 60 ms with a window of 0.12 s, 8 and 16 ms with one of 0.032 s, at a noise that
/// grows with the square of the ratio.
template <typename Scalar>
class Disturbance {
 public:
  constexpr Disturbance(SamplePeriod<Scalar> dt, const TorqueLawParameters<Scalar>& law, const MotionView<Scalar>& view)
      : law_(dt, law), window_(dt, view), low_pass_(dt, dt.time_of(window_.delay())) {}

  constexpr void restart() {
    law_.restart();
    window_.restart();
    low_pass_.start(Scalar{});
  }
  constexpr auto update(const Measured<Scalar>& now) -> DisturbanceEstimate<Scalar> {
    if (!window_.update(now)) {
      return {};
    }
    const Sample<Scalar>& motion = window_.sample();
    const Torque<Scalar> torque = law_.update(motion);
    if (torque.saturated) {
      low_pass_.start(Scalar{});
      return {.law_nm = torque.torque_nm};
    }
    return {torque.torque_nm, low_pass_.update(motion.tau - torque.torque_nm), true};
  }

  [[nodiscard]] constexpr auto law() const -> const TorqueLaw<Scalar>& { return law_; }
  [[nodiscard]] constexpr auto delay() const -> std::int32_t { return window_.delay(); }
  /// The motion and the measured torque that the last estimate is of. @pre it was known
  [[nodiscard]] constexpr auto motion() const -> const Sample<Scalar>& { return window_.sample(); }

 private:
  TorqueLaw<Scalar> law_;
  MotionWindow<Scalar> window_;
  LowPass<Scalar> low_pass_;
};

}  // namespace capstan
