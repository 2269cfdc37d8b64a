// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "capstan/firmware/parameters/config.hpp"

namespace capstan {

/// What shakes a joint while its frequency response is measured. Plain numbers.
struct ExcitationSetup {
  enum class Kind : std::uint8_t {
    kMultisine,  ///< odd harmonics of one period, some left out, so that even and odd distortion show on their own
                 ///< lines
    kChirp,      ///< one sweep from the lowest to the highest frequency, each octave as long
  };
  enum class Point : std::uint8_t {
    kMotorTorque,     ///< N m, added to the torque of the control that is on
    kJointReference,  ///< rad, added to the wanted joint angle
  };
  static constexpr std::size_t kMostLines = 32;
  static constexpr std::uint32_t kPeriodMs = 2048;  ///< of a multisine: a power of 2, so phases are exact for ever

  Kind kind = Kind::kMultisine;
  Point point = Point::kMotorTorque;
  Q24 amplitude{};  ///< peak: N m or rad
  Q24 from_khz{};   ///< kHz, for Q24 ends at 128
  Q24 to_khz{};
  std::uint32_t length_ms = 0;  ///< in all; a chirp's sweep
  Q24 travel_rad{};    ///< the joint goes to and fro by this meanwhile, so that friction has one sign; 0: stands
  Q24 speed_rad_s{};   ///< of that
  Q24 corridor_rad{};  ///< further from where it is to be, the joint ends the experiment
  // Worked out by prepare_excitation().
  std::array<std::uint16_t, kMostLines> harmonics{};
  std::array<std::uint32_t, kMostLines> phases{};  ///< 2^-32 turns
  std::size_t lines = 0;
  Q24 line_amplitude{};
  std::uint32_t growth = 0;  ///< of a chirp's frequency in a cycle, 2^-32
};

/// nullptr, or what is wrong with it for this joint, "sentence; cure". For the background.
auto check_excitation(const ExcitationSetup& setup, Q24 offset_rad, const AxisConfig& config) -> const char*;

/// Works out lines, phases and scale, or the sweep's growth. For the background: some 40 million instructions for the
/// longest sweep, five for a multisine. @pre check_excitation() has nothing against it
void prepare_excitation(ExcitationSetup& setup);

/// The sum of a multisine's lines at t ms, without ramps; at most the setup's lines are worked out.
auto rt_multisine(const ExcitationSetup& setup, std::uint32_t t_ms) -> Q24;

/// Answers one value a cycle.
class Excitation {
 public:
  /// The next value; rises and falls over kRampMs at either end. @param t_ms  since the start, 0, 1, 2 ...
  auto rt_next(const ExcitationSetup& setup, std::uint32_t t_ms) -> Q24;

  static constexpr std::uint32_t kRampMs = 256;

 private:
  std::uint32_t phase_ = 0;  // of a chirp, 2^-32 turns
  std::uint64_t step_ = 0;   // turns in a cycle, 2^-48
};

}  // namespace capstan
