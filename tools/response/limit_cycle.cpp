// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/response/limit_cycle.hpp"

#include <cmath>
#include <numbers>

#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

constexpr double kMostFactor = 100.0;

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

}  // namespace

auto predict_limit_cycle(const Response& response, const LoopGains& gains) -> std::optional<LimitCycle> {
  return predict_limit_cycle(dense(response), gains);
}

auto predict_limit_cycle(const Dense& all, const LoopGains& gains) -> std::optional<LimitCycle> {
  const std::vector<Swing> swings = swings_of(all, gains);
  std::optional<LimitCycle> first;
  for (std::size_t i = 1; i < swings.size(); ++i) {
    const Swing& a = swings[i - 1];
    const Swing& b = swings[i];
    if ((a.missing_nms < 0.0) == (b.missing_nms < 0.0) || a.factor <= 0.0 || b.factor <= 0.0) {
      continue;
    }
    const double share = a.missing_nms / (a.missing_nms - b.missing_nms);
    const LimitCycle at{.onset = a.factor + share * (b.factor - a.factor), .hz = a.hz + share * (b.hz - a.hz)};
    if (at.onset > 1.0 && at.onset < kMostFactor && (!first || at.onset < first->onset)) {
      first = at;
    }
  }
  return first;
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
  return "at " + rounded(cycle.onset, 3) + " times these gains a moving joint begins to swing at " +
         rounded(cycle.hz, 3) + " Hz" +
         (speed_rad_s > 0.0 ? ", its motor by " + rounded(1e3 * swing_rad(cycle, speed_rad_s), 2) +
                                  " mrad where it goes at " + rounded(speed_rad_s, 2) + " rad/s"
                            : " (how far is not known: the joint of this log stood)");
}

}  // namespace capstan::tools
