// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/firmware/control/excitation.hpp"
#include "capstan/firmware/loop/cycle.hpp"

namespace capstan {

/// Motions that show what a joint's law needs to be identified. Amplitudes are about `offset`; every rung, and so every
/// repeat, begins and ends at rest there.
enum class Recipe : std::uint8_t {
  kSineLadder,      ///< one sine after the other; rungs are frequencies, Hz
  kMultisine,       ///< the sum of all frequencies at once, with Schroeder's phases
  kDecayingSine,    ///< loops within loops: a sine that shrinks, one frequency
  kTriangle,        ///< to and fro at constant speed; rungs are speeds, rad/s
  kSpeedLadder,     ///< the same at one speed after the other
  kReversals,       ///< first-order reversals: from the lower end to higher and higher levels; one speed
  kTorqueTriangle,  ///< to and fro in torque about offset_nm; one rate, N m/s. The joint goes where that takes it.
  kDither,          ///< as kSpeedLadder, and two tones of torque on top, by which the motor's inertia shows
  kResponse,        ///< shaken by the setup's excitation where it stands, or while it goes to and fro
};

/// What an experiment does. Plain numbers; check_experiment() says whether a joint can do it.
struct ExperimentSetup {
  static constexpr std::size_t kMostRungs = 8;
  Recipe recipe = Recipe::kSineLadder;
  std::uint8_t axis = 0;
  Q24 amplitude{};  ///< rad, or N m
  Q24 offset_rad{};
  Q24 offset_nm{};  ///< torque triangle: what it goes to and fro about
  std::array<Q24, kMostRungs> rungs{};
  std::size_t rung_count = 0;
  Q24 decay_per_s{};
  Q24 dither_nm{};              ///< dither: amplitude of each tone in the last legs; a half, a quarter, ... before
  Q24 tone_scale{};             ///< multisine: amplitude of one tone, see scale_tones()
  std::uint32_t length_ms = 0;  ///< multisine, decaying sine
  std::int32_t cycles = 1;      ///< of each rung
  std::int32_t repeats = 1;
  std::int32_t levels = 8;       ///< reversals
  ExcitationSetup excitation{};  ///< response
};

/// nullptr, or what is wrong with it for this joint, "sentence; cure". For the background.
auto check_experiment(const ExperimentSetup& setup, const AxisConfig& config) -> const char*;

/// Sets tone_scale so that the peak of the sum is the amplitude, looked for every 2 ms. For the background: it takes
/// some ten million instructions.
void scale_tones(ExperimentSetup& setup);

/// Cycles in a period of the dither's lower tone; the higher has two in that time.
inline constexpr std::int32_t kDitherCycles = 12;

/// The reference of a sine-like recipe at t ms after its rung began, from the offset, rad; 0 at the rung's ends.
auto rt_tone(const ExperimentSetup& setup, std::size_t rung, std::uint32_t t_ms) -> Q24;
/// How long that rung takes.
auto rt_rung_ms(const ExperimentSetup& setup, std::size_t rung) -> std::uint32_t;

/// Runs one experiment at a time by commands to the joint, as a host that streams references would: they pass every
/// limit and monitor. The cycle's side; it lives beside the cycle, not in it.
class Experiment {
 public:
  void rt_start(const ExperimentSetup& setup);
  /// Ends whatever runs.
  void rt_end() { phase_ = active() ? ExperimentPhase::kEnded : phase_; }
  /// The joint's command of this cycle. @param axis  the joint of the setup, as it stood after the last cycle
  auto rt_step(const Axis& axis) -> Request;
  [[nodiscard]] auto active() const -> bool {
    return phase_ == ExperimentPhase::kApproaching || phase_ == ExperimentPhase::kRunning;
  }
  [[nodiscard]] auto axis() const -> std::size_t { return setup_.axis; }
  [[nodiscard]] auto phase() const -> ExperimentPhase { return phase_; }

 private:
  auto rt_approach(const Axis& axis) -> Request;
  auto rt_run_tones() -> Request;
  auto rt_run_moves(const Axis& axis) -> Request;
  auto rt_run_torque(const Axis& axis) -> Request;
  auto rt_run_response(const Axis& axis) -> Request;
  auto rt_strays(const Axis& axis) -> bool;
  auto rt_dither() -> Q24;
  auto rt_next_rung() -> bool;
  [[nodiscard]] auto rt_corners() const -> std::int32_t;
  [[nodiscard]] auto rt_corner() const -> Q24;
  auto rt_finish() -> Request;

  ExperimentSetup setup_;
  ExperimentPhase phase_ = ExperimentPhase::kIdle;
  std::int32_t repeat_ = 0;
  std::size_t rung_ = 0;
  std::int32_t corner_ = 0;  // of the rung; moves and torque
  std::uint32_t t_ms_ = 0;   // since the rung began; approach: since it stood still
  std::int64_t torque_ = 0;  // 2^-24 N m / kCycleRateHz
  bool moving_ = false;      // the move to corner_ was sent
  Excitation excitation_;
  Q24 trailing_q2_;  // response: where the joint was a moment ago
};

}  // namespace capstan
