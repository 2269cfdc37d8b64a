// SPDX-License-Identifier: Apache-2.0
#include "capstan/firmware/control/experiment.hpp"

#include <algorithm>

#include "capstan/model/exponential.hpp"
#include "capstan/model/trigonometry.hpp"

namespace capstan {
namespace {

using Phase24 = Phase<Q24>;
constexpr Q24 kOne = Q24::from_int(1);
constexpr std::uint32_t kRestMs = 300;  // at the offset, before the motion and its log begin

/// frequency x time in units of 2^-32 turn. A raw frequency is below 2^29 and a time below 2^20 ms.
auto turns_of(Q24 frequency_hz, std::uint32_t t_ms) -> std::uint32_t {
  constexpr std::uint64_t kUnits = std::uint64_t{1} << (32 - Q24::kFrac);
  return static_cast<std::uint32_t>(static_cast<std::uint64_t>(frequency_hz.raw()) * t_ms * kUnits / 1000U);
}

/// Milliseconds that `periods` of a frequency take, rounded up.
auto periods_ms(Q24 frequency_hz, std::uint32_t periods) -> std::uint32_t {
  const auto raw = static_cast<std::uint64_t>(frequency_hz.raw());
  return static_cast<std::uint32_t>(((std::uint64_t{periods} * 1000U << Q24::kFrac) + raw - 1) / raw);
}

auto is_tonal(Recipe recipe) -> bool {
  return recipe <= Recipe::kDecayingSine;
}

auto lowest_rung(const ExperimentSetup& setup) -> Q24 {
  return *std::min_element(setup.rungs.begin(), setup.rungs.begin() + static_cast<std::ptrdiff_t>(setup.rung_count));
}
auto highest_rung(const ExperimentSetup& setup) -> Q24 {
  return *std::max_element(setup.rungs.begin(), setup.rungs.begin() + static_cast<std::ptrdiff_t>(setup.rung_count));
}

/// Rises within `blend` from 0 at rest to 1, and falls at the end as it rose: 3 s^2 - 2 s^3.
auto envelope(std::uint32_t t_ms, std::uint32_t length_ms, std::uint32_t blend_ms) -> Q24 {
  const std::uint32_t from_end = std::min(t_ms, length_ms - std::min(t_ms, length_ms));
  if (from_end >= blend_ms) {
    return kOne;
  }
  const Q24 s = Q24::from_wide((std::int64_t{from_end} << Q24::kFrac) / blend_ms);
  return s * s * (Q24::from_int(3) - (s + s));
}

/// Tone k of N has the phase -pi k (k - 1) / N, k from 1 (Schroeder 1970), which keeps the peak of the sum low.
auto multisine(const ExperimentSetup& setup, std::uint32_t t_ms) -> Q24 {
  Q24 sum;
  for (std::size_t i = 0; i < setup.rung_count; ++i) {
    constexpr std::uint64_t kHalfTurn = std::uint64_t{1} << 31;
    const auto lag = static_cast<std::uint32_t>(kHalfTurn * (i + 1) * i / setup.rung_count);
    sum += Phase24(turns_of(setup.rungs[i], t_ms) - lag).sine();
  }
  return sum;
}

/// The steepest that the reference gets, and the most bent, with the envelope's share; 1 at least of a speed ladder.
struct Demand {
  Q24 speed_rad_s;
  Q24 acceleration_rad_s2;
};

/// Bounds for A sin(w t) under an envelope of one period: A (w + 1.5 f) and A (w^2 + 3 f w + 6 f^2), f = w / (2 pi).
auto demand_of(Q24 amplitude, Q24 frequency_hz) -> Demand {
  constexpr Q24 kSpeed = Q24::from_double(6.283185 + 1.5);
  constexpr Q24 kBend = Q24::from_double(39.478418 + 18.849556 + 6.0);
  const Q24 speed = amplitude * frequency_hz;
  return {speed * kSpeed, speed * frequency_hz * kBend};
}

auto within_joint(const ExperimentSetup& setup, const LimitConfig& limits) -> bool {
  return setup.offset_rad + setup.amplitude <= limits.joint_max_rad &&
         setup.offset_rad - setup.amplitude >= limits.joint_min_rad;
}

auto check_tones(const ExperimentSetup& setup, const LimitConfig& limits) -> const char* {
  constexpr Q24 kFastest = Q24::from_int(20);
  constexpr std::uint32_t kLongestMs = 1'000'000;
  if (highest_rung(setup) > kFastest || lowest_rung(setup) < Q24::from_double(0.002)) {
    return "a frequency is not between 0.002 and 20 Hz; correct the list";
  }
  if (setup.recipe != Recipe::kSineLadder &&
      (setup.length_ms > kLongestMs || setup.length_ms < 2 * periods_ms(lowest_rung(setup), 1))) {
    return "the duration is not between two periods of the lowest frequency and 1000 s; give another";
  }
  if (setup.recipe == Recipe::kDecayingSine && setup.rung_count != 1) {
    return "a decaying sine has one frequency; give only one";
  }
  const Demand demand = demand_of(setup.amplitude, highest_rung(setup));
  if (demand.speed_rad_s > limits.joint_speed_rad_s) {
    return "the motion is faster than limits.joint_speed; lower the amplitude or the frequencies";
  }
  if (demand.acceleration_rad_s2 > limits.joint_acceleration_rad_s2) {
    return "the motion needs more than limits.joint_acceleration; lower the amplitude or the frequencies";
  }
  return nullptr;
}

auto check_moves(const ExperimentSetup& setup, const LimitConfig& limits) -> const char* {
  if (highest_rung(setup) > limits.joint_speed_rad_s) {
    return "a speed is above limits.joint_speed; lower it";
  }
  if (setup.recipe != Recipe::kSpeedLadder && setup.rung_count != 1) {
    return "this recipe has one speed; give only one";
  }
  if (setup.levels < 2 || setup.levels > 100) {
    return "the levels are not 2 to 100; give another number";
  }
  return nullptr;
}

}  // namespace

auto check_experiment(const ExperimentSetup& setup, const AxisConfig& config) -> const char* {
  if (setup.recipe == Recipe::kResponse) {
    return check_excitation(setup.excitation, setup.offset_rad, config);
  }
  if (config.motor.fitted == 0) {
    return "there is no joint (motor.fitted is 0); choose another";
  }
  constexpr std::int32_t kMost = 1000;
  static_assert(ExperimentSetup::kMostRungs == 8, "the sentence says so");
  if (setup.rung_count > ExperimentSetup::kMostRungs) {
    return "an experiment has at most 8 frequencies, speeds or rates; give fewer";
  }
  if (setup.amplitude <= Q24{} || setup.rung_count == 0 || lowest_rung(setup) <= Q24{}) {
    return "amplitude, frequencies, speeds and rates have to be above 0; correct them";
  }
  if (setup.cycles < 1 || setup.cycles > kMost || setup.repeats < 1 || setup.repeats > kMost) {
    return "cycles and repeats have to be 1 to 1000; correct them";
  }
  if (setup.decay_per_s < Q24{}) {
    return "a decay has to be 0 or more, for with this one the motion would grow; correct it";
  }
  const LimitConfig& limits = config.limits;
  if (setup.recipe == Recipe::kTorqueTriangle) {
    return abs(setup.offset_nm) + setup.amplitude > limits.current_a * config.motor.torque_per_current_nm_per_a
               ? "the torque needs more than limits.current; lower it"
               : nullptr;
  }
  if (!within_joint(setup, limits)) {
    return "the motion leaves limits.joint_min to limits.joint_max; lower the amplitude or move the offset";
  }
  constexpr Q24 kHalf = Q24::from_double(0.5);  // for there are two tones, whose peaks may meet
  if (setup.recipe == Recipe::kDither &&
      setup.dither_nm > kHalf * (limits.continuous_current_a * config.motor.torque_per_current_nm_per_a)) {
    return "the two tones of the dither need more than limits.continuous_current; lower it";
  }
  return is_tonal(setup.recipe) ? check_tones(setup, limits) : check_moves(setup, limits);
}

void scale_tones(ExperimentSetup& setup) {
  constexpr std::uint32_t kStepMs = 2;
  Q24 peak;
  for (std::uint32_t t = 0; t <= setup.length_ms; t += kStepMs) {
    peak = std::max(peak, abs(multisine(setup, t)));
  }
  setup.tone_scale = peak > Q24{} ? setup.amplitude / peak : Q24{};
}

auto rt_rung_ms(const ExperimentSetup& setup, std::size_t rung) -> std::uint32_t {
  // One period more than asked for: half of it is lost at either end to the envelope.
  return setup.recipe == Recipe::kSineLadder
             ? periods_ms(setup.rungs[rung], static_cast<std::uint32_t>(setup.cycles) + 1)
             : setup.length_ms;
}

auto rt_tone(const ExperimentSetup& setup, std::size_t rung, std::uint32_t t_ms) -> Q24 {
  const std::uint32_t length = rt_rung_ms(setup, rung);
  const std::uint32_t blend = periods_ms(highest_rung(setup), 1);
  const Q24 shape =
      envelope(t_ms, length, setup.recipe == Recipe::kSineLadder ? periods_ms(setup.rungs[rung], 1) : blend);
  if (setup.recipe == Recipe::kMultisine) {
    return shape * (setup.tone_scale * multisine(setup, t_ms));
  }
  const Q24 sine = setup.amplitude * Phase24(turns_of(setup.rungs[rung], t_ms)).sine();
  if (setup.recipe == Recipe::kSineLadder) {
    return shape * sine;
  }
  const Q24 gone_by = Q24::from_wide(std::int64_t{setup.decay_per_s.raw()} * t_ms / kCycleRateHz);
  return shape * (sine - sine * share_gone(gone_by, kOne));
}

void Experiment::rt_start(const ExperimentSetup& setup) {
  *this = {};
  setup_ = setup;
  phase_ = ExperimentPhase::kApproaching;
}

auto Experiment::rt_step(const Axis& axis) -> Request {
  if (phase_ == ExperimentPhase::kApproaching) {
    return rt_approach(axis);
  }
  if (phase_ != ExperimentPhase::kRunning) {
    return {};
  }
  if (setup_.recipe == Recipe::kTorqueTriangle) {
    return rt_run_torque(axis);
  }
  if (setup_.recipe == Recipe::kResponse) {
    return rt_run_response(axis);
  }
  return is_tonal(setup_.recipe) ? rt_run_tones() : rt_run_moves(axis);
}

auto Experiment::rt_approach(const Axis& axis) -> Request {
  if (!moving_ && setup_.recipe != Recipe::kTorqueTriangle) {
    moving_ = true;
    constexpr Q24 kShare = Q24::from_double(0.25);
    return {.kind = Request::Kind::kMove,
            .position_rad = setup_.offset_rad,
            .speed_rad_s = axis.config().limits.joint_speed_rad_s * kShare};
  }
  t_ms_ = axis.in_motion() ? 0 : t_ms_ + 1;
  if (t_ms_ > kRestMs) {
    phase_ = ExperimentPhase::kRunning;
    moving_ = false;
    t_ms_ = 0;
    trailing_q2_ = axis.telemetry().q2_rad;
  }
  return {};
}

/// False after the last of the last repeat.
auto Experiment::rt_next_rung() -> bool {
  t_ms_ = 0;
  corner_ = 0;
  // All tones of a multisine are one rung.
  const std::size_t rungs = setup_.recipe == Recipe::kMultisine ? 1 : setup_.rung_count;
  if (++rung_ == rungs) {
    rung_ = 0;
    ++repeat_;
  }
  return repeat_ < setup_.repeats;
}

auto Experiment::rt_finish() -> Request {
  phase_ = ExperimentPhase::kDone;
  return {.kind = Request::Kind::kStop};
}

auto Experiment::rt_run_tones() -> Request {
  if (++t_ms_ > rt_rung_ms(setup_, rung_) && !rt_next_rung()) {
    return rt_finish();
  }
  return {.kind = Request::Kind::kFollow, .position_rad = setup_.offset_rad + rt_tone(setup_, rung_, t_ms_)};
}

/// Ends of legs in a rung.
auto Experiment::rt_corners() const -> std::int32_t {
  return 2 * (setup_.recipe == Recipe::kReversals ? setup_.levels : setup_.cycles) + 1;
}

/// Where the leg of now ends, from the offset. After the last one it is the offset again.
auto Experiment::rt_corner() const -> Q24 {
  if (corner_ + 1 == rt_corners()) {
    return {};
  }
  if (setup_.recipe != Recipe::kReversals) {
    return corner_ % 2 == 0 ? setup_.amplitude : -setup_.amplitude;
  }
  if (corner_ % 2 == 0) {
    return -setup_.amplitude;
  }
  const std::int64_t level = corner_ / 2 + 1;
  return Q24::from_wide(setup_.amplitude.raw() * (2 * level - setup_.levels) / setup_.levels);
}

/// Larger from leg to leg, because a joint whose motor turns back in every period tells nothing of its inertia.
auto Experiment::rt_dither() -> Q24 {
  if (setup_.recipe != Recipe::kDither) {
    return {};
  }
  constexpr std::uint32_t kStep = 0x1'0000'0000 / kDitherCycles;
  const auto place = static_cast<std::uint32_t>(t_ms_++ % kDitherCycles) * kStep;
  const Q24 both = Phase24(place).sine() + Phase24(2 * place).sine();
  const std::int32_t legs_left = rt_corners() - 1 - corner_;
  return Q24::from_raw((setup_.dither_nm * both).raw() >> std::clamp<std::int32_t>(legs_left, 0, 8) / 2);
}

auto Experiment::rt_run_moves(const Axis& axis) -> Request {
  const Q24 dither = rt_dither();
  if (moving_ && axis.in_motion()) {
    return {.dither_nm = dither};
  }
  if (moving_ && ++corner_ == rt_corners() && !rt_next_rung()) {
    return rt_finish();
  }
  moving_ = true;
  return {.kind = Request::Kind::kMove,
          .position_rad = setup_.offset_rad + rt_corner(),
          .speed_rad_s = setup_.rungs[rung_],
          .dither_nm = dither};
}

auto Experiment::rt_run_torque(const Axis& axis) -> Request {
  if (moving_ && !axis.in_torque()) {  // it left its limits, and is held
    phase_ = ExperimentPhase::kEnded;
    return {};
  }
  if (!moving_) {  // from the torque that holds the joint
    moving_ = true;
    torque_ = axis.telemetry().drive_nm.raw() * std::int64_t{kCycleRateHz};
  }
  const std::int64_t step = std::max<std::int64_t>(setup_.rungs[0].raw(), 1);
  const std::int64_t target = std::int64_t{(setup_.offset_nm + rt_corner()).raw()} * kCycleRateHz;
  torque_ += std::clamp(target - torque_, -step, step);
  if (torque_ == target && ++corner_ == rt_corners() && !rt_next_rung()) {
    return rt_finish();
  }
  return {.kind = Request::Kind::kTorque, .torque_nm = Q24::from_wide(torque_ / kCycleRateHz)};
}

/// Outside its corridor, or faster than moves may be; a mean over 20 ms, for a rate from counts is mostly noise.
auto Experiment::rt_strays(const Axis& axis) -> bool {
  constexpr Q24 kTrailS = Q24::from_double(0.02);
  constexpr Q30 kTrailGain = SamplePeriod<Q24>{kCycleRateHz}.filter_gain(kTrailS);
  const Q24 q2 = axis.telemetry().q2_rad;
  trailing_q2_ += (q2 - trailing_q2_) * kTrailGain;
  const ExcitationSetup& own = setup_.excitation;
  return abs(q2 - setup_.offset_rad) > own.travel_rad + own.corridor_rad ||
         abs(q2 - trailing_q2_) > axis.config().limits.joint_speed_rad_s * kTrailS;
}

auto Experiment::rt_run_response(const Axis& axis) -> Request {
  if (rt_strays(axis)) {
    phase_ = ExperimentPhase::kEnded;
    return {.kind = Request::Kind::kStop};
  }
  const ExcitationSetup& own = setup_.excitation;
  if (t_ms_ == own.length_ms) {
    return rt_finish();
  }
  const Q24 value = excitation_.rt_next(own, t_ms_++);
  if (own.point == ExcitationSetup::Point::kJointReference) {
    return {.kind = Request::Kind::kFollow, .position_rad = setup_.offset_rad + value};
  }
  if (own.travel_rad == Q24{} || (moving_ && axis.in_motion())) {
    return {.dither_nm = value};
  }
  moving_ = true;
  const Q24 end = corner_++ % 2 == 0 ? own.travel_rad : -own.travel_rad;
  return {.kind = Request::Kind::kMove,
          .position_rad = setup_.offset_rad + end,
          .speed_rad_s = own.speed_rad_s,
          .dither_nm = value};
}

}  // namespace capstan
