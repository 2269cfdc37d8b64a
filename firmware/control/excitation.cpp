// SPDX-License-Identifier: Apache-2.0
#include "capstan/firmware/control/excitation.hpp"

#include <algorithm>

#include "capstan/firmware/loop/expect.hpp"
#include "capstan/model/trigonometry.hpp"

namespace capstan {
namespace {

using Phase24 = Phase<Q24>;
constexpr Q24 kFastest =
    Q24::from_double(0.4);  // kHz, of a rate of 1; above, a period has too few samples to mean much
constexpr Q24 kLeastCorridor = Q24::from_double(0.001);
constexpr std::uint32_t kLongestMs = 600'000;
constexpr std::uint32_t kLongestSweepMs = 60'000;

/// Turns in a cycle of 1 ms, 2^-48.
auto step_of(Q24 frequency_khz) -> std::uint64_t {
  return static_cast<std::uint64_t>(frequency_khz.raw()) << 24U;
}

/// One cycle later.
constexpr auto grown(std::uint64_t step, std::uint32_t growth) -> std::uint64_t {
  return step + (((step >> 16U) * growth) >> 16U);
}

/// The growth by which a sweep ends at its highest frequency, found by halving: it needs no logarithm.
auto growth_of(const ExcitationSetup& setup) -> std::uint32_t {
  const std::uint64_t last = step_of(setup.to_khz);
  std::uint32_t growth = 0;
  // exp(growth) a cycle: a second takes the widest range, 1 to 1600, by less than 2^25 / 2^32 a cycle.
  for (std::uint32_t bit = std::uint32_t{1} << 25U; bit > 0; bit >>= 1U) {
    std::uint64_t step = step_of(setup.from_khz);
    for (std::uint32_t t = 0; t < setup.length_ms && step <= last; ++t) {
      step = grown(step, growth + bit);
    }
    growth += step <= last ? bit : 0;
  }
  return growth;
}

/// Odd harmonics of the period, each a like part of an octave above the last where there are enough. Every fourth odd
/// harmonic is left out: what shows there is odd distortion, and what shows at even ones is even distortion.
void choose_lines(ExcitationSetup& setup) {
  const auto harmonic = [](Q24 khz) { return static_cast<std::uint64_t>(khz.raw()) * ExcitationSetup::kPeriodMs; };
  const std::uint64_t first = harmonic(setup.from_khz);  // 2^-24 harmonics
  const auto last = static_cast<std::uint32_t>(harmonic(setup.to_khz) >> Q24::kFrac);
  const auto left_out = [](std::uint32_t odd) { return odd % 8 == 5; };
  std::uint32_t before = 0;
  // The ratio between neighbours, 2^-24, as the 31st root of the whole range, by halving.
  std::uint64_t ratio = std::uint64_t{1} << 24U;
  for (std::uint64_t bit = std::uint64_t{1} << 23U; bit > 0; bit >>= 1U) {
    std::uint64_t at = first;
    for (std::size_t i = 1; i < ExcitationSetup::kMostLines && at >> Q24::kFrac <= last; ++i) {
      at = (at >> 8U) * ((ratio + bit) >> 8U) >> 8U;
    }
    ratio += at >> Q24::kFrac <= last ? bit : 0;
  }
  std::uint64_t wanted = first;
  setup.lines = 0;
  for (std::size_t i = 0; i < ExcitationSetup::kMostLines; ++i) {
    auto odd = static_cast<std::uint32_t>(wanted >> Q24::kFrac) | 1U;
    while (odd <= before || left_out(odd)) {
      odd += 2;
    }
    if (odd > last) {
      break;
    }
    setup.harmonics[setup.lines++] = static_cast<std::uint16_t>(odd);
    before = odd;
    wanted = (wanted >> 8U) * (ratio >> 8U) >> 8U;
  }
}

/// Schroeder's phases (1970) for lines that are not evenly spaced: each line has its turn in the period, a group delay
/// of k / N periods, which keeps the peak of the sum low.
void choose_phases(ExcitationSetup& setup) {
  std::uint32_t phase = 0;
  std::uint32_t before = 0;
  for (std::size_t i = 0; i < setup.lines; ++i) {
    const std::uint64_t turns = (std::uint64_t{setup.harmonics[i] - before} << 32U) * (i + 1) / setup.lines;
    phase -= static_cast<std::uint32_t>(turns);
    setup.phases[i] = phase;
    before = setup.harmonics[i];
  }
  setup.line_amplitude = Q24::from_int(1);
  Q24 peak;
  for (std::uint32_t t = 0; t < ExcitationSetup::kPeriodMs; ++t) {
    peak = std::max(peak, abs(rt_multisine(setup, t)));
  }
  setup.line_amplitude = peak > Q24{} ? setup.amplitude / peak : Q24{};
}

auto check_reference(const ExcitationSetup& setup, const AxisConfig& config) -> const char* {
  // The worst that a sum of lines with this peak can ask: all of it at the highest frequency.
  constexpr Q24 kTwoPi = Q24::from_double(6.283185307179586);
  if (setup.to_khz > Q24::from_double(0.05)) {
    return "a joint reference is shaken by no more than 50 Hz; lower 'to', or shake the torque";
  }
  const Q24 to_hz = Q24::from_wide(std::int64_t{setup.to_khz.raw()} * 1000);
  const Q24 speed = setup.amplitude * to_hz * kTwoPi;
  if (speed > config.limits.joint_speed_rad_s) {
    return "the motion is faster than limits.joint_speed; lower the amplitude or 'to'";
  }
  if (speed * to_hz * kTwoPi > config.limits.joint_acceleration_rad_s2) {
    return "the motion needs more than limits.joint_acceleration; lower the amplitude or 'to'";
  }
  if (setup.travel_rad != Q24{}) {
    return "the joint travels only while its torque is shaken; leave 'travel' out, or write 'on=torque'";
  }
  return nullptr;
}

}  // namespace

auto check_excitation(const ExcitationSetup& setup, Q24 offset_rad, const AxisConfig& config) -> const char* {
  constexpr Q24 kLowest = Q24::from_double(0.00025);
  if (config.motor.fitted == 0) {
    return "there is no joint (motor.fitted is 0); choose another";
  }
  if (setup.amplitude <= Q24{} || setup.from_khz < kLowest || setup.to_khz > kFastest ||
      setup.to_khz < setup.from_khz + setup.from_khz) {
    return "the amplitude is not above 0, or the frequencies are not 0.25 to 400 Hz and an octave apart; correct them";
  }
  const bool sweep = setup.kind == ExcitationSetup::Kind::kChirp;
  if (setup.length_ms < 2 * ExcitationSetup::kPeriodMs || setup.length_ms > (sweep ? kLongestSweepMs : kLongestMs)) {
    return "the duration is not 5 to 600 s, or of a chirp not 5 to 60 s; correct it";
  }
  const LimitConfig& limits = config.limits;
  const Q24 reach = setup.travel_rad + setup.corridor_rad;
  if (setup.corridor_rad < kLeastCorridor || setup.travel_rad < Q24{} || offset_rad + reach > limits.joint_max_rad ||
      offset_rad - reach < limits.joint_min_rad) {
    return "travel and corridor leave limits.joint_min to limits.joint_max, or there is no corridor; lower them or "
           "move "
           "the offset";
  }
  if (setup.travel_rad != Q24{} &&
      (sweep || setup.speed_rad_s <= Q24{} || setup.speed_rad_s > limits.joint_speed_rad_s)) {
    return "only a multisine travels, and not faster than limits.joint_speed; correct 'travel' and 'speed'";
  }
  if (setup.point == ExcitationSetup::Point::kJointReference) {
    return check_reference(setup, config);
  }
  return setup.amplitude > limits.continuous_current_a * config.motor.torque_per_current_nm_per_a
             ? "the torque needs more than limits.continuous_current; lower it"
             : nullptr;
}

void prepare_excitation(ExcitationSetup& setup) {
  CAPSTAN_EXPECT(setup.from_khz > Q24{} && setup.to_khz >= setup.from_khz && setup.to_khz <= kFastest);
  if (setup.kind == ExcitationSetup::Kind::kChirp) {
    setup.growth = growth_of(setup);
    return;
  }
  choose_lines(setup);
  choose_phases(setup);
}

auto rt_multisine(const ExcitationSetup& setup, std::uint32_t t_ms) -> Q24 {
  constexpr std::uint32_t kStep = (std::uint64_t{1} << 32U) / ExcitationSetup::kPeriodMs;
  Q24 sum;
  for (std::size_t i = 0; i < setup.lines; ++i) {
    sum += Phase24(setup.harmonics[i] * t_ms * kStep + setup.phases[i]).sine();
  }
  return setup.line_amplitude * sum;
}

auto Excitation::rt_next(const ExcitationSetup& setup, std::uint32_t t_ms) -> Q24 {
  Q24 value;
  if (setup.kind == ExcitationSetup::Kind::kMultisine) {
    value = rt_multisine(setup, t_ms);
  } else {
    step_ = t_ms == 0 ? step_of(setup.from_khz) : grown(step_, setup.growth);
    phase_ += static_cast<std::uint32_t>(step_ >> 16U);
    value = setup.amplitude * Phase24(phase_).sine();
  }
  const std::uint32_t edge = std::min({t_ms, setup.length_ms - std::min(t_ms, setup.length_ms), kRampMs});
  return edge == kRampMs ? value : Q24::from_wide(std::int64_t{value.raw()} * edge / kRampMs);
}

}  // namespace capstan
