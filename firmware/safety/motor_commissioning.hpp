// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <complex>

#include "capstan/firmware/estimate/encoder_scale.hpp"

namespace capstan {

/// The motor observer's values of one joint, from that joint's own motion: counts, wanted and measured current of every
/// cycle. First the moves of a speed ladder, then Recipe::kDither. For the background.
///
/// - **Inertia.** The load is not known, but its friction is constant while the motor goes one way, and its tendon is a
///   spring of stiffness K. Of a tone of angular frequency w the motor makes kt I / a = J - K / w^2, with current I and
///   acceleration a (the counts' second difference). So J = J(w) + K / w^2, and K / w^2 = 4/3 (J(2w) - J(w)), which is
///   not below zero.
/// - **Coulomb, against, slack.** The largest that a healthy motion makes of what the observer's tests look at, slow
///   and at full speed: half of the torque between two counts, the torque against a motion, the slowing down.
/// - **Stiffness, excess.** A motor that turns round first stretches its tendons the other way, over many counts: each
///   count answers for some torque. Of a ladder of stiffnesses the one is taken that tells the joint's own counts best
///   from half of them, by the largest torque that goes beyond what they answered for; `excess` is that of its own.
/// - **Noise.** Rms of the measured current about the wanted one while the motor stands, per sample that was counted.
/// - **Gain error.** By what a moving motor's current strays in the mean, noise aside, as a share of the wanted one. It
///   is the amplifier's, the sensor's, and what follows later than a cycle.
class MotorCommissioning {
 public:
  /// It computes in floating point, which a program for a core without it must not have. That is the compiler's own
  /// word, not a board's name: the type of the stream that uses it, and so the session's room, hang on it.
#ifdef __SOFTFP__
  static constexpr bool kAvailable = false;
#else
  static constexpr bool kAvailable = true;
#endif
  struct Result {
    const char* problem = nullptr;  ///< nullptr, or why there are no values, "sentence; cure"
    ObserverConfig values;
    float inertia_error = 0.0F;  ///< standard error of the inertia, as a share of it
  };

  /// @param stiffness_nm_per_rad  of the motor's servo: where the ladder of stiffnesses begins; 0: none is found
  void begin(const MotorConfig& motor, Q24 stiffness_nm_per_rad = Q24{});
  /// From here on it is the dither that is added.
  void begin_dither();
  /// And from here on moves at full speed. nullptr, or why there is no inertia, "sentence; cure".
  auto begin_fast_moves() -> const char*;
  /// One cycle. Cycles that are missing before it, by their number, only cost a block.
  void add(std::uint32_t tick, Q24 q1_rad, Q24 wanted_a, Q24 current_a);
  [[nodiscard]] auto result() const -> Result;

 private:
  static constexpr std::size_t kBlock = 12;  // a period of the lower tone, kDitherCycles
  static constexpr std::size_t kTones = 2;
  /// One tone of all blocks. The dither keeps its phase, so whatever else moves the motor, the servo's answer to a
  /// coarse encoder's counts above all, averages out.
  struct Tone {
    std::complex<float> bend;  // second difference of the counts
    std::complex<float> current;
    float bend_squares = 0.0F;
  };
  /// A torque, A, that follows the wanted one by `per_count` for each count in its direction, and by a share of that
  /// for one against it.
  struct Answered {
    float torque = 0.0F;
    float most = 0.0F;  // largest difference to the wanted torque
    void follow(float wanted, float per_count, std::int32_t moved);
  };
  struct Stiffness {
    Answered whole;
    Answered half;  // by half of the counts
  };
  static constexpr std::size_t kStiffnesses = 8;
  [[nodiscard]] auto per_count(std::size_t place) const -> float;
  void judge_stiffness(std::int32_t moved, std::int32_t wanted);
  void judge_current(std::int32_t before, Q24 current_a);
  void judge_friction(std::int32_t moved, std::int32_t wanted);
  void add_to_block(std::int32_t moved, Q24 current_a);
  void end_block();
  auto identify_inertia() -> const char*;
  void judge_speed(std::int32_t moved);
  [[nodiscard]] auto apparent_inertia(std::size_t tone) const -> float;
  [[nodiscard]] auto error_of(std::size_t tone) const -> float;

  MotorConfig motor_{};
  EncoderScale scale_{MotorConfig{}};
  Result found_;
  float gain_ = 0.0F;  // counts in a cycle, that a cycle of 1 A adds
  std::array<Stiffness, kStiffnesses> stiffness_{};
  float servo_per_count_ = 0.0F;  // A, of the servo's stiffness
  std::int32_t odd_ = 0;          // counts that are not halved yet
  bool answering_ = false;
  bool dither_ = false;
  bool counting_ = false;
  std::uint32_t tick_ = 0;
  std::int64_t counts_ = 0;
  std::int32_t wanted_ = 0;
  std::int32_t still_ = 0;  // cycles without a count
  // Currents, A raw, as MotorObserver keeps them.
  std::int32_t answered_ = 0;
  std::int32_t confirmed_up_ = 0;
  std::int32_t confirmed_down_ = 0;
  std::int32_t unanswered_most_ = 0;
  std::int32_t against_most_ = 0;
  bool confirmed_ = false;
  std::int32_t moved_before_ = 0;
  std::int32_t high_ = 0;  // envelope of the wanted current
  std::int32_t low_ = 0;
  float slack_most_ = 0.0F;   // counts
  std::int64_t squares_ = 0;  // A raw / 2^8, squared
  std::int32_t samples_ = 0;
  std::int64_t strayed_ = 0;  // A raw / 2^8, by the current of a moving motor
  std::int64_t driven_ = 0;   // and its wanted one
  std::int32_t moving_ = 0;   // samples of that
  std::array<std::int32_t, kBlock + 1> moved_{};
  std::array<float, kBlock> current_a_{};
  std::uint32_t first_tick_ = 0;  // of the block
  std::size_t filled_ = 0;
  std::int32_t blocks_ = 0;
  std::array<Tone, kTones> tones_{};
};

}  // namespace capstan
