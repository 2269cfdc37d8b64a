// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/response/tuning.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "capstan/tools/response/limit_cycle.hpp"
#include "capstan/tools/response/loop.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

constexpr double kDegreesPerTurn = 360.0;

// Numbers that decide, chosen in November 2026 on logs of the simulated forceps, seeds 1 to 3, 11 to 15 and 33; what
// response_on_plant_test and docs/tuning.md report of margins is of seeds 31 and 32.
constexpr double kServoReserveDeg = 6.0;  // that the joint loop may take of the servo's phase margin
constexpr double kEncoderShare = 0.02;    // rms torque of the encoder's steps, of the continuous torque
constexpr double kAboveFirst = 1.5;       // crossover over the first clear line: below it, the loop is not known
constexpr double kAboveAsked = 1.15;      // crossover over the one that was asked for
constexpr double kCascade = 0.1;          // joint loop over servo: a cascade's usual distance, and little to hunt with
constexpr double kMostMismatch = 0.1;     // of measured loop and gains; 0.01 to 0.03 where they belong together
constexpr double kStepUp = 1.12;          // how much more gain is tried to see what limits
// Filters of the servo's rate that are tried beside the present one, s: what one takes of the phase, the encoder's
// steps pay, and those have a limit of their own. A cycle is 1 ms, so a fifth of it is hardly a filter any more.
constexpr std::array<double, 3> kRateTimes = {1e-3, 5e-4, 2e-4};
constexpr double kMostStiffness = 100.0, kMostDamping = 10.0, kMostKi = 100.0;  // of the parameters

/// One view of a response.
struct Plant {
  Dense all;
  std::vector<LoopPoint> known;  ///< the loop that was measured
};
using Plants = std::vector<Plant>;

using LoopOf = std::vector<LoopPoint> (*)(const Dense& all, const LoopGains& gains);

/// Of the worst of them.
auto margins_over(const Plants& plants, const LoopGains& gains, LoopOf loop = loop_of, bool with_circle = true)
    -> Margins {
  Margins least = margins_of(loop(plants.front().all, gains), with_circle);
  for (std::size_t i = 1; i < plants.size(); ++i) {
    least = worse(least, margins_of(loop(plants[i].all, gains), with_circle));
  }
  return least;
}

/// The one that begins to swing first.
auto first_cycle(const Plants& plants, const LoopGains& gains) -> std::optional<LimitCycle> {
  std::optional<LimitCycle> first;
  for (const Plant& plant : plants) {
    first = sooner(first, predict_limit_cycle(plant.all, gains));
  }
  return first;
}

auto keeps(const Margins& margins, const Wanted& wanted, double reserve_deg = 0.0) -> bool {
  return margins.phase_deg >= wanted.phase_deg + reserve_deg && margins.gain_db >= wanted.gain_db &&
         margins.modulus >= wanted.modulus;
}

/// Every plant is stable, and none begins to swing at less than the wanted factor on its gain. The margins do not tell
/// that: between two lines near a resonance the factor bends.
auto calm(const Plants& plants, const LoopGains& gains, const Wanted& wanted) -> bool {
  return std::all_of(plants.begin(), plants.end(), [&](const Plant& plant) {
    return as_stable_as(loop_of(plant.all, gains), plant.known) && !swings_by(plant.all, gains, wanted.onset);
  });
}

/// Rms torque that the encoder's steps make, N m: white noise of a step's twelfth through the servo.
auto encoder_torque(const LoopGains& gains) -> double {
  constexpr int kPoints = 64;
  double power = 0.0;
  for (int i = 1; i <= kPoints; ++i) {
    power += std::norm(law_of(gains, 0.5 / kCycleS * i / kPoints).servo) / kPoints;
  }
  return 2.0 * std::numbers::pi / gains.counts_per_turn / std::sqrt(12.0) * std::sqrt(power);
}
auto too_coarse(const LoopGains& gains) -> bool {
  return encoder_torque(gains) > kEncoderShare * gains.continuous_nm;
}

auto servo_only(LoopGains gains) -> LoopGains {
  gains.kp = gains.ki_per_s = gains.kd_s = 0.0;
  return gains;
}

struct Found {
  LoopGains gains;
  Margins margins;
};

/// The servo with the rate's filter as it is, by a grid: 5 % from one stiffness to the next, and damping from a fifth
/// of a millisecond's to a tenth of a second's share of it. The stiffest that keeps the margins, at the bandwidth that
/// was asked for, and stiffer than `best`.
void tune_servo(const Plants& plants, const LoopGains& present, const Wanted& wanted, std::optional<Found>& best) {
  const double first_hz = std::max(plants.front().all.hz.front(), plants.back().all.hz.front());
  for (double share_s = 2e-4; share_s < 0.1; share_s *= 1.12) {
    for (double stiffness = 0.01 * present.stiffness; stiffness < 100.0 * present.stiffness; stiffness *= 1.05) {
      if (best && stiffness <= best->gains.stiffness) {
        continue;
      }
      LoopGains gains = servo_only(present);
      gains.stiffness = stiffness;
      gains.damping = stiffness * share_s;
      if (gains.stiffness > kMostStiffness || gains.damping > kMostDamping || too_coarse(gains)) {
        break;
      }
      const Margins margins = margins_over(plants, gains);
      if (margins.crossover_hz < kAboveFirst * first_hz || !keeps(margins, wanted, kServoReserveDeg) ||
          (wanted.bandwidth_hz && (margins.crossover_hz < *wanted.bandwidth_hz ||
                                   margins.crossover_hz > kAboveAsked * *wanted.bandwidth_hz))) {
        continue;
      }
      if (calm(plants, gains, wanted)) {
        best = Found{gains, margins};
      }
    }
  }
}

/// The stiffest over the filters of the rate.
auto tune_servo(const Plants& plants, const LoopGains& present, const Wanted& wanted) -> std::optional<Found> {
  std::optional<Found> best;
  tune_servo(plants, present, wanted, best);
  for (const double time_s : kRateTimes) {
    LoopGains quicker = present;
    quicker.rate_time_constant_s = time_s;
    if (time_s < present.rate_time_constant_s) {
      tune_servo(plants, quicker, wanted, best);
    }
  }
  return best;
}

/// The joint loop's corner: where its gain comes to 1, below the lines as an integral goes on.
auto joint_bandwidth(const Dense& all, const LoopGains& gains) -> double {
  const std::vector<LoopPoint> outer = outer_loop(all, gains);
  if (std::abs(outer.front().value) < 1.0) {
    return outer.front().hz * std::abs(outer.front().value);
  }
  const auto below =
      std::find_if(outer.begin(), outer.end(), [](const LoopPoint& point) { return std::abs(point.value) < 1.0; });
  return below == outer.end() ? outer.back().hz : below->hz;
}

/// The joint loop's integral as fast as the margins and a tenth of the servo's crossover allow; kp as it was, or less.
auto tune_joint(const Plants& plants, const Found& servo, const LoopGains& present, const Wanted& wanted)
    -> std::optional<Found> {
  const double most = std::min(kMostKi, 2.0 * std::numbers::pi * kCascade * servo.margins.crossover_hz);
  for (const double part : {1.0, 0.5, 0.25, 0.0}) {
    for (double ki = most; ki > 0.1; ki *= 0.9) {
      LoopGains gains = servo.gains;
      gains.kp = part * present.kp;
      gains.ki_per_s = ki;
      gains.kd_s = part * present.kd_s;
      const Margins margins = margins_over(plants, gains);
      if (keeps(margins, wanted) && keeps(margins_over(plants, gains, outer_loop), wanted) &&
          calm(plants, gains, wanted)) {
        return Found{gains, margins};
      }
    }
  }
  return {};
}

auto sentence_of(const char* what, double hz, const MotorModel& motor, double filter_s) -> std::string {
  const bool resonant = motor.resonance_hz > 0.0 && std::fabs(std::log2(hz / motor.resonance_hz)) < 0.5;
  if (resonant) {
    return std::string("a resonance near ") + rounded(motor.resonance_hz, 3) + " Hz: there the " + what +
           " is used up; stiffen what swings, or lower the bandwidth";
  }
  const double late_s = motor.delay_s + motor.lag_s;
  return std::string("delay: at ") + rounded(hz, 3) + " Hz, where the " + what + " is used up, " +
         rounded(1e3 * late_s, 2) + " ms of delay in drive and sensor take " +
         rounded(kDegreesPerTurn * hz * late_s, 2) + " deg, and the filter of the rate of " +
         rounded(1e3 * filter_s, 2) + " ms (control.rate_time_constant) up to " +
         rounded(kDegreesPerTurn * hz * filter_s, 2) + " deg";
}

auto limit_of(const Plants& plants, const Tuning& tuning, const Wanted& wanted, double last_hz) -> std::string {
  LoopGains more = servo_only(tuning.gains);
  more.stiffness *= kStepUp;
  more.damping *= kStepUp;
  if (too_coarse(more)) {
    return "encoder: its steps of " + rounded(2e3 * std::numbers::pi / more.counts_per_turn, 2) +
           " mrad would shake the torque by more than 2 % of the continuous one; a finer encoder allows more";
  }
  if (const auto cycle = first_cycle(plants, more); cycle && cycle->onset < wanted.onset) {
    return sentence_of("gain margin", cycle->hz, tuning.motor, more.rate_time_constant_s);
  }
  const Margins margins = margins_over(plants, more);
  if (margins.gain_db < wanted.gain_db) {
    return sentence_of("gain margin", margins.gain_hz, tuning.motor, more.rate_time_constant_s);
  }
  if (margins.phase_deg < wanted.phase_deg + kServoReserveDeg) {
    return sentence_of("phase margin", margins.phase_hz, tuning.motor, more.rate_time_constant_s);
  }
  if (margins.modulus < wanted.modulus) {
    return sentence_of("modulus margin", margins.modulus_hz, tuning.motor, more.rate_time_constant_s);
  }
  return "nothing up to " + rounded(last_hz, 3) + " Hz, where the log ends; shake up to a higher frequency";
}

/// Gains at which the joint would begin to swing soon are refused with that sentence.
void require_calm(const Response& response, const Plants& plants, const LoopGains& gains, const Wanted& wanted) {
  const auto cycle = first_cycle(plants, gains);
  if (cycle && cycle->onset < wanted.onset) {
    throw Refusal(response.name + ": stiffness " + rounded(gains.stiffness, 3) + " and damping " +
                  rounded(gains.damping, 3) +
                  " would be too near to swinging: " + sentence_of(*cycle, response.motor_speed_rad_s) +
                  ", and less than " + rounded(wanted.onset, 2) + " times is refused; ask for less bandwidth");
  }
}

/// What was asked for has no margins; where that is because the joint would swing, says so.
void refuse_swinging(const Response& response, const Plants& plants, const LoopGains& present, const Wanted& wanted) {
  if (!wanted.bandwidth_hz) {
    return;
  }
  const Wanted barely{.phase_deg = -kServoReserveDeg,
                      .gain_db = 0.0,
                      .modulus = 0.0,
                      .onset = 1.0,
                      .bandwidth_hz = wanted.bandwidth_hz};
  if (const auto servo = tune_servo(plants, present, barely)) {
    require_calm(response, plants, servo->gains, wanted);
  }
}

/// What to ask for in place of a bandwidth that no gains have: less than the most that others have, or more.
/// @pre one was asked for
auto other_bandwidth(const Plants& plants, const LoopGains& present, const Wanted& wanted) -> std::string {
  Wanted any = wanted;
  any.bandwidth_hz.reset();
  const auto most = tune_servo(plants, present, any);
  return " at " + rounded(*wanted.bandwidth_hz, 3) + " Hz; " +
         (most && most->margins.crossover_hz > *wanted.bandwidth_hz
              ? "gains up to " + rounded(most->margins.crossover_hz, 2) +
                    " Hz keep them, so ask for more bandwidth, or "
              : std::string("ask for less bandwidth, or "));
}

/// Rms of what tells two loops apart, relative, where a gain of 1 is near, and where it is most.
class Apart {
 public:
  /// @param radius95  of what was measured: what noise alone makes of the difference is taken off
  void add(double hz, Complex predicted, Complex measured, double radius95) {
    if (std::abs(measured) > 1.0 / 3.0 && std::abs(measured) < 3.0) {
      const double square = std::norm(predicted / measured - 1.0) - kNoiseShare * std::norm(radius95 / measured);
      sum_ += square;
      ++count_;
      worst_hz_ = square > worst_ ? hz : worst_hz_;
      worst_ = std::max(worst_, square);
    }
  }
  [[nodiscard]] auto rms() const -> double { return count_ > 0 ? std::sqrt(std::max(0.0, sum_ / count_)) : 0.0; }
  [[nodiscard]] auto worst_hz() const -> double { return worst_hz_; }

 private:
  double sum_ = 0.0, worst_ = 0.0, worst_hz_ = 0.0;
  int count_ = 0;
};

/// The measured loop is the plant's response times the present gains', line by line, or these are not the gains of the
/// log; and between the lines too, or the plant is not smooth between them.
void require_same_gains(const Response& response, const Dense& all, const LoopGains& present) {
  Apart at_lines;
  const double sense = sense_of(all);
  for (const ResponsePoint& point : clear_points(response)) {
    const Law law = law_of(present, point.hz);
    const Complex feedback = law.servo + through_joint(present, law, sense, point.joint.value);
    at_lines.add(point.hz, point.motor.value * feedback, point.loop.value, point.loop.radius95);
  }
  if (at_lines.rms() > kMostMismatch) {
    throw Refusal(response.name + ": the loop that was measured is " + rounded(100.0 * at_lines.rms(), 2) +
                  " % off the one of these gains, so the log was made with others; give the board's 'dump' of that "
                  "time with --dump");
  }
  Apart between_lines;
  const std::vector<LoopPoint> loop = loop_of(all, present);
  for (std::size_t i = 0; i < loop.size(); ++i) {
    between_lines.add(loop[i].hz, loop[i].value, all.drawn[i], all.drawn_radius[i]);
  }
  if (between_lines.rms() > kMostMismatch) {
    throw Refusal(
        response.name + ": near " + rounded(between_lines.worst_hz(), 2) +
        " Hz the response changes from line to line, beyond noise and more than a joint that swings on its tendons "
        "does: friction changes its sign, so shake less or let the joint travel faster; or something else swings "
        "there, so keep gains whose bandwidth stays well below");
  }
}

auto plants_of(const Response& response, const LoopGains& present) -> Plants {
  Plants plants;
  for (const Response* view : views_of(response)) {
    Dense all = dense(*view);
    require_same_gains(*view, all, present);
    std::vector<LoopPoint> known = measured_loop(all);
    plants.push_back({std::move(all), std::move(known)});
  }
  return plants;
}

auto worst_of(const Plants& plants, const LoopGains& gains) -> const Plant& {
  const auto modulus = [&](const Plant& plant) { return margins_of(loop_of(plant.all, gains)).modulus; };
  return modulus(plants.back()) < modulus(plants.front()) ? plants.back() : plants.front();
}

auto ways_sentence(const Response& response, bool backward_is_worse) -> std::string {
  if (views_of(response).size() == 1) {
    return {};
  }
  return std::string(
             "the motor answers otherwise backward than forward, as of tendons that are not alike: margins are "
             "the lower ones of both, mostly those ") +
         (backward_is_worse ? "backward" : "forward");
}

}  // namespace

auto tune(const Response& response, const LoopGains& present, const Wanted& wanted) -> Tuning {
  if (!response.on_torque) {
    throw Refusal(response.name +
                  ": the reference was shaken, and gains need the loop at the torque; record "
                  "'experiment joint0 multisine on=torque'");
  }
  if (!response.multisine) {
    throw Refusal(response.name +
                  ": a chirp does not show whether friction holds the joint, and gains for a held joint "
                  "are far too high for one that moves; record 'experiment joint0 multisine on=torque "
                  "travel=0.4 speed=0.2'");
  }
  const Plants plants = plants_of(response, present);
  const auto servo = tune_servo(plants, present, wanted);
  if (!servo) {
    refuse_swinging(response, plants, present, wanted);
    throw Refusal(response.name + ": no gains of the motor servo keep " + rounded(wanted.phase_deg, 3) + " deg, " +
                  rounded(wanted.gain_db, 3) + " dB and a modulus of " + rounded(wanted.modulus, 2) +
                  (wanted.bandwidth_hz ? other_bandwidth(plants, present, wanted) : std::string("; ")) +
                  "shake for longer, for the circles of 95 % count against the margins");
  }
  const auto joint = tune_joint(plants, *servo, present, wanted);
  if (!joint) {
    throw Refusal(response.name + ": beside the motor servo no joint loop keeps the margins; ask for less bandwidth");
  }
  const Plant& worst = worst_of(plants, joint->gains);
  Tuning tuning{.gains = joint->gains,
                .motor = worst.all.model,
                .servo = servo->margins,
                .whole = joint->margins,
                .whole_nominal = {},
                .limited_by = {},
                .swings = {},
                .ways = ways_sentence(response, &worst == &plants.front()),
                .warning = turned_about(response),
                .loop = loop_of(worst.all, joint->gains)};
  if (const auto cycle = first_cycle(plants, tuning.gains)) {
    tuning.swings = sentence_of(*cycle, response.motor_speed_rad_s);
  }
  if (response.travels) {
    tuning.gains.friction_nm = {{response.backward_nm, response.forward_nm}};
  }
  tuning.whole_nominal = margins_over(plants, tuning.gains, loop_of, false);
  tuning.joint_bandwidth_hz = joint_bandwidth(worst.all, joint->gains);
  tuning.limited_by = wanted.bandwidth_hz ? "the bandwidth that was asked for"
                                          : limit_of(plants, tuning, wanted, response.points.back().hz);
  return tuning;
}

auto tuning_lines(const LoopGains& gains, int axis) -> std::vector<std::string> {
  const std::string set = "set joint" + std::to_string(axis) + ".control.";
  std::vector<std::string> lines = {"begin",
                                    set + "stiffness " + rounded(gains.stiffness) + " Nm/rad",
                                    set + "damping " + rounded(gains.damping) + " Nms/rad",
                                    set + "rate_time_constant " + rounded(gains.rate_time_constant_s) + " s",
                                    set + "kp " + rounded(gains.kp),
                                    set + "ki " + rounded(gains.ki_per_s) + " 1/s",
                                    set + "kd " + rounded(gains.kd_s) + " s"};
  if (gains.friction_nm) {
    lines.push_back(set + "torque_backward " + rounded(gains.friction_nm->first, 3) + " Nm");
    lines.push_back(set + "torque_forward " + rounded(gains.friction_nm->second, 3) + " Nm");
  }
  lines.emplace_back("commit");
  return lines;
}

}  // namespace capstan::tools
