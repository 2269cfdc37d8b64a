// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/response/limit_cycle.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "capstan/tools/response/loop_in_time.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

constexpr double kMostFactor = 100.0;
constexpr double kFactorStep = 1.08, kFineStep = 1.01;  // from one factor that is tried to the next

constexpr double kAnyRate = 100.0;  // N m a cycle
constexpr double kSooner = 0.95;    // of the onset without the gate, that is worth a word

// Rms rate of the shake over the rate of the way, chosen in November 2026 on the forceps 640 to 644 of
// limit_cycle_on_plant_test with 6, 8 and 12 mNm: the onset is 1 % late at most below 0.4, where a shake of many lines
// turns the motor in 6 of 1000 rows, 1 to 4 % up to 0.45, 6 to 11 up to 0.6, 13 to 25 up to 0.71. A third: one of 1000.
constexpr double kTurnsAbout = 0.4;
constexpr double kTurnsHardly = 1.0 / 3.0;

/// Where inertia and stiffness balance: for every frequency at one factor, for the real part is linear in it.
struct Swing {
  double hz = 0.0, factor = 0.0;
  double missing_nms = 0.0;  ///< damping that friction would have to give
};

auto swings_of(const Dense& all, const LoopGains& gains) -> std::vector<Swing> {
  const std::vector<LoopPoint> loop = loop_of(all, gains);
  std::vector<Swing> swings;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Complex inverse = 1.0 / all.motor[i];
    const Complex control = loop[i].value / all.motor[i];
    const double factor = -inverse.real() / control.real();
    swings.push_back(
        {loop[i].hz, factor, -(inverse + factor * control).imag() / (2.0 * std::numbers::pi * loop[i].hz)});
  }
  return swings;
}

/// Without the encoder's steps and the gate.
auto onset_of(const Dense& all, const LoopGains& gains) -> std::optional<LimitCycle> {
  const std::vector<Swing> swings = swings_of(all, gains);
  std::optional<LimitCycle> first;
  for (std::size_t i = 1; i < swings.size(); ++i) {
    const Swing& a = swings[i - 1];
    const Swing& b = swings[i];
    if ((a.missing_nms < 0.0) == (b.missing_nms < 0.0) || a.factor <= 0.0 || b.factor <= 0.0) {
      continue;
    }
    const double share = a.missing_nms / (a.missing_nms - b.missing_nms);
    const double onset = a.factor + share * (b.factor - a.factor);
    const LimitCycle at{.onset = onset, .hz = a.hz + share * (b.hz - a.hz), .smooth_onset = onset};
    if (at.onset > 1.0 && at.onset < kMostFactor && (!first || at.onset < first->onset)) {
      first = at;
    }
  }
  return first;
}

/// The loop run in time, beside what frequencies tell of it without the encoder's steps and the gate. It is a model,
/// and only what those two change is taken from it.
class InTime {
 public:
  /// Nothing: the joint stood and nobody knows how fast it will travel, or the model never swings.
  static auto of(const Dense& all, const LoopGains& gains, const LimitCycle& first) -> std::optional<InTime> {
    if (all.motor_speed_rad_s <= 0.0) {
      return {};
    }
    const auto above = std::lower_bound(all.hz.begin(), all.hz.end(), first.hz);
    const auto at = static_cast<std::size_t>(std::min(above, all.hz.end() - 1) - all.hz.begin());
    const auto run = [&](double rate_nm) {
      LoopGains limited = gains;
      limited.rate_nm = rate_nm;
      LoopInTime loop(all.model, limited, sense_of(all) * all.joint[at].real(), all.friction_nm);
      loop.bend(all.hz[at], all.motor[at]);
      return loop;
    };
    InTime in_time{run(gains.rate_nm), run(kAnyRate), first, first, all.motor_speed_rad_s};
    Dense modelled = all;
    for (std::size_t i = 0; i < all.hz.size(); ++i) {
      modelled.motor[i] = in_time.loop_.model().at(all.hz[i]);
    }
    if (const std::optional<LimitCycle> own = onset_of(modelled, gains)) {
      in_time.own_ = *own;
      return in_time;
    }
    return {};
  }

  /// With that multiple of the gains. An encoder whose steps alone shake the motor as much
  /// says nothing.
  [[nodiscard]] auto swings(double factor) const -> bool {
    return loop_.swings(factor * own_.onset / first_.onset, way_) && !free_.swings(1.0, way_);
  }
  [[nodiscard]] auto hz_at(double factor) const -> double {
    const double hz = loop_.at(factor * own_.onset / first_.onset, way_).hz;
    return hz > 0.0 ? first_.hz * hz / own_.hz : first_.hz;
  }

 private:
  InTime(LoopInTime loop, LoopInTime free, const LimitCycle& first, const LimitCycle& own, double way_rad_s)
      : loop_(std::move(loop)), free_(std::move(free)), first_(first), own_(own), way_(way_rad_s) {}

  LoopInTime loop_, free_;  // free: no limit of the rate
  LimitCycle first_, own_;  // of the response, and of the model
  double way_;
};

}  // namespace

auto predict_limit_cycle(const Response& response, const LoopGains& gains) -> std::optional<LimitCycle> {
  std::optional<LimitCycle> first;
  for (const Response* view : views_of(response)) {
    first = sooner(first, predict_limit_cycle(dense(*view), gains));
  }
  return first;
}

auto sooner(const std::optional<LimitCycle>& a, const std::optional<LimitCycle>& b) -> std::optional<LimitCycle> {
  return b && (!a || b->onset < a->onset) ? b : a;
}

auto predict_limit_cycle(const Dense& all, const LoopGains& gains) -> std::optional<LimitCycle> {
  const std::optional<LimitCycle> first = onset_of(all, gains);
  const std::optional<InTime> in_time = first ? InTime::of(all, gains, *first) : std::nullopt;
  if (!in_time) {
    return first;
  }
  const double farthest = kFactorStep * first->onset;
  double calm = 1.0;
  double swinging = 1.0;
  while (swinging < farthest && !in_time->swings(swinging)) {
    calm = std::exchange(swinging, swinging * kFactorStep);
  }
  if (swinging >= farthest) {
    return first;
  }
  while (swinging > calm * kFineStep) {
    const double between = std::sqrt(calm * swinging);
    (in_time->swings(between) ? swinging : calm) = between;
  }
  return LimitCycle{
      .onset = std::min(swinging, first->onset), .hz = in_time->hz_at(swinging), .smooth_onset = first->onset};
}

auto swings_by(const Dense& all, const LoopGains& gains, double factor) -> bool {
  const std::optional<LimitCycle> first = onset_of(all, gains);
  if (!first || first->onset < factor) {
    return first.has_value();
  }
  const std::optional<InTime> in_time = InTime::of(all, gains, *first);
  return in_time && in_time->swings(factor);
}

auto turned_about(const Response& response) -> std::string {
  const double share = response.motor_speed_rad_s > 0.0 ? response.motor_shake_rad_s / response.motor_speed_rad_s : 0.0;
  if (share < kTurnsAbout) {
    return {};
  }
  return "the shake turned the motor about (" + rounded(response.motor_shake_rad_s, 2) +
         " rad/s rms about its way at " + rounded(response.motor_speed_rad_s, 2) +
         " rad/s): friction reversed with it and looks like damping, so the joint begins to oscillate sooner than "
         "predicted; "
         "shake with " +
         rounded(kTurnsHardly / share, 2) + " times the amplitude at most, or let the joint travel " +
         rounded(share / kTurnsHardly, 2) + " times as fast";
}

auto swing_rad(const LimitCycle& cycle, double speed_rad_s) -> double {
  return speed_rad_s / (2.0 * std::numbers::pi * cycle.hz);
}

auto sentence_of(const LimitCycle& cycle, double speed_rad_s) -> std::string {
  const std::string sooner =
      cycle.onset < kSooner * cycle.smooth_onset
          ? " (in bursts before; at " + rounded(cycle.smooth_onset, 3) +
                " times if the gate did not limit how fast the current follows the encoder's steps)"
          : "";
  return "at " + rounded(cycle.onset, 3) + " times these gains" + sooner + " a moving joint begins to swing at " +
         rounded(cycle.hz, 3) + " Hz" +
         (speed_rad_s > 0.0 ? ", its motor by " + rounded(1e3 * swing_rad(cycle, speed_rad_s), 2) +
                                  " mrad where it goes at " + rounded(speed_rad_s, 2) + " rad/s"
                            : " (how far is not known: the joint of this log stood)");
}

}  // namespace capstan::tools
