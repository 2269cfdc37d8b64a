// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "capstan/firmware/estimate/motor_sensing.hpp"
#include "capstan/firmware/safety/look_answer.hpp"

namespace capstan {

/// Whether encoder and current agree with what torque does to the motor: the motor observer of one joint.
///
/// The load is not known (a tendon's friction is ten times the torque that accelerates the motor), so no test asks what
/// the load is. These tests ask what no load can do, each of a motor of inertia J whose own friction holds up to
/// `coulomb`:
/// - **Motion without torque.** A motor slows down by no more counts in a cycle than the range of its torque within the
///   last kTrailCycles explains, gain * range + kQuantisation. Two cycles are judged against the two before
///   them as well: their sums are quantised no more than single cycles are, and the range is that of before. A stuck,
///   late, scaled or reversed encoder says more in the first cycles in which it matters; a tip that hits something does
///   not, for its tendons are soft (K v a ms, not J v / 1 ms). A motor that winds its tendons up takes ever more torque
///   at a steady speed, so its range says nothing; there three cycles are judged against three by how much the speed
///   has changed of late.
/// - **Speed without torque.** A load that lets go gives the motor speed no faster than its tendons let it, which are
///   soft. What gains more within two cycles than the torque's range explains has lost a tendon, or its tension.
/// - **Torque without motion.** Torque that goes beyond where the encoder last confirmed it (counts in its own
/// direction)
///   by more than `frozen`, or by `rise` for longer than the impulse J * dv needs, has to be answered by a count.
/// - **Motion against torque.** Counts do not go on at speed where the torque has gone against them by `against`; and
///   where it has gone by `frozen`, they do not gain speed: a servo on an encoder of the wrong sign drives the count
///   that it means to stop.
/// - **Torque without way.** A motor that turns round stretches its tendons the other way first, and each count of that
///   answers for `stiffness` of torque; what goes beyond by more than a healthy motor's `excess` has a count that is
///   too small, or one that goes on by itself: half, drift, lag. A motor that goes on while its torque falls is helped
///   by its load, and each count of that answers for kHelpedShare8 of it. Friction along a tendon is a share of its
///   tension, so what a motor pressed with where it turned round counts until it has turned.
/// - **A look without its answer.** A look moves a motor at rest by counts of its own: LookAnswer.
/// - **Current without a wish.** The measured current lies between the last two wanted ones, but for noise and a share
///   that amplifier and sensor are off by; CUSUM over what is beyond, up to the charge that makes the motor dv' faster.
/// Input: whole cycles. Output: a verdict. Fixed point, no division in a cycle.
///
/// Thresholds, from the commissioned values only (motor_observer_scales.cpp); healthy margins and false alarms:
/// docs/safety_concept.md.
class MotorObserver {
 public:
  explicit MotorObserver(const AxisConfig& config) : scales_(config) {}
  void rt_configure(const AxisConfig& config) { scales_ = Scales(config); }

  /// Faults of encoder, current and amplifier in this cycle; none without commissioned values.
  /// @param drive_a  current that was wanted in the last cycle   @param energised  with torque
  auto rt_step(const MotorState& motor, Q24 drive_a, bool energised) -> FaultSet;
  /// Torque goes on: what was confirmed begins anew, and the first look with it. A motor that turns then springs back
  /// from the torque of before, so its motion is not judged for 50 cycles.
  void rt_arm();
  /// A look, A, to be added to the wanted current: a triangle to and fro, larger than what the motor's own friction
  /// holds and far smaller than what moves the joint. It goes on until a count answers it; a dead encoder or amplifier
  /// fails rt_step first.
  /// The first is that of rt_arm; another one whenever the encoder falls silent. It takes torque away, for a joint that
  /// is about to break away would go with one that adds some.
  auto rt_look() -> Q24;
  /// How the motor answered the last looks.
  [[nodiscard]] auto look_answer() const -> const LookAnswer& { return answer_; }

  /// Largest change of the set value in a cycle: what two cycles of it do to the motor's speed stays below half of
  /// limits.joint_speed, so that no fault is fast before the observer has looked twice; and what ten cycles of it do to
  /// the motor's angle stays below limits.fault_travel. A.
  static auto slew_limit(const AxisConfig& config) -> Q24;
  /// nullptr if the values can be, else a sentence with the cure.
  static auto check(const AxisConfig& config) -> const char*;
  static auto commissioned(const ObserverConfig& config) -> bool { return config.inertia_gm2 > Q24{}; }

  /// Of observer.stiffness, eighths: torque that a count answers for where it falls though the motor goes on. That is
  /// the stiffness of what helps it (contact, spring, weight), which is softer than its tendons. Of the drawn joint of
  /// seed 220024, whose contact helped, 0 leaves 1.05 of the threshold, 1/4, 1/2 and 1 leave 0.71, 0.69 and 0.68; with
  /// 1/8 and 1/4 the same faults of the campaign are found.
  static constexpr std::int32_t kHelpedShare8 = 2;

 private:
  static constexpr std::int32_t kLookCycles = 12;
  static constexpr int kGainErrorBits = 12;

  /// What follows from the parameters; currents in A, raw halves, so that the difference of two fits 32 bits; counts in
  /// 1/256.
  struct Scales {
    explicit Scales(const AxisConfig& config);
    std::int32_t gain = 0;        // counts/256 in a cycle, that a cycle of 1 A adds; 0: not commissioned
    std::int32_t frozen = 0;      // A
    std::int32_t slack = 0;       // counts/256
    std::int32_t against = 0;     // A
    std::int32_t creep = 0;       // counts in a cycle, that a changing load moves the motor by against its torque
    std::int32_t rise = 0;        // A
    std::int32_t impulse = 0;     // A cycles
    std::int32_t mismatch = 0;    // A
    std::int32_t gain_error = 0;  // of the wanted current, kGainErrorBits
    std::int32_t charge = 0;      // A cycles
    std::int32_t stretch = 0;     // A, that a count answers for
    std::int32_t most = 0;        // counts, that answer for any torque
    std::int32_t slew = 0;        // A, that torque changes by in a cycle, but for steps
    std::int32_t helped = 0;      // A, that one answers for against its own direction
    std::int32_t turn = 0;        // A, twice the motor's own friction
    std::int32_t excess = 0;      // A, beyond what was answered for; 0: not watched
    std::int32_t sudden = 0;      // counts/256, two cycles against the two before
    std::int32_t gained = 0;      // counts/256 in a cycle, that a load gives within two
    std::int32_t answer = 0;      // counts/256, for each A of a look at least; 0: not judged
    std::int32_t winding = 0;     // counts/256, three cycles against the three before
    // Counts in a cycle, that a motor against its torque gains at most: with little of it, in all, and lately.
    std::int32_t wild = 0;
    std::int32_t runaway_most = 0;
    std::int32_t runaway = 0;
    std::int32_t runaway_lately = 0;
  };
  // Each is called once, in every cycle: inlined they cost a third less.
  [[gnu::always_inline]] inline auto rt_watch_current(std::int32_t measured, std::int32_t wanted) -> FaultSet;
  [[gnu::always_inline]] inline auto rt_watch_speed(std::int32_t moved, std::int32_t wanted) -> FaultSet;
  [[gnu::always_inline]] inline auto rt_slows_suddenly(std::int32_t moved, std::int32_t wanted) -> bool;
  [[gnu::noinline]] auto rt_is_let_go(std::int32_t moved, std::int32_t wanted) -> bool;
  [[gnu::always_inline]] inline auto rt_slows_while_winding(std::int32_t moved, std::int32_t wanted) -> bool;
  [[gnu::always_inline]] inline auto rt_watch_stretch(std::int32_t moved, std::int32_t wanted) -> FaultSet;
  [[gnu::always_inline]] inline auto rt_watch_answer(std::int32_t moved, std::int32_t wanted) -> FaultSet;
  [[gnu::always_inline]] inline auto rt_runs_away(std::int32_t moved, std::int32_t against) -> bool;
  [[gnu::always_inline]] inline void rt_trail(std::int32_t wanted);
  [[gnu::always_inline]] inline void rt_listen(std::int32_t moved);
  [[gnu::always_inline]] inline void rt_remember(std::int32_t moved, std::int32_t wanted);

  Scales scales_;
  std::int64_t counts_ = 0;
  std::int32_t moved_ = 0;   // in the last cycle, counts
  std::int32_t wanted_ = 0;  // in the cycle before the last, A, raw halves as all currents here
  std::int32_t high_ = 0;    // envelope of the wanted current
  std::int32_t low_ = 0;
  std::int32_t confirmed_up_ = 0;    // the encoder moved forward at this current
  std::int32_t confirmed_down_ = 0;  // and backward at this
  std::int32_t answered_ = 0;        // and at all at this
  std::int32_t unanswered_ = 0;      // A cycles
  std::int32_t strayed_ = 0;         // A cycles
  std::int32_t look_ = kLookCycles;
  std::int32_t held_ = 0;  // cycles that a look has waited for a count
  LookAnswer answer_;
  std::int32_t slow_ = 0;       // speed where the torque last went with the motion, counts in a cycle
  std::int32_t springing_ = 0;  // cycles in which what a torque of before has stretched may move the motor
  struct Cycle {
    std::int32_t moved = 0;   // counts
    std::int32_t way = 0;     // in it and the two before, counts
    std::int32_t wanted = 0;  // A
    std::int32_t range = 0;   // of the wanted torque, A
    std::int32_t lately = 0;  // counts/256, what three cycles against three changed by
  };
  static constexpr std::uint32_t kPast = 8;
  /// So many cycles ago; 1: the last one.
  [[nodiscard]] auto past(std::uint32_t cycles) const -> const Cycle& { return past_[(now_ + 1 - cycles) % kPast]; }
  std::array<Cycle, kPast> past_{};
  std::array<std::int32_t, 3> before_{};  // `moved` of the last three cycles, the last one first
  std::uint32_t now_ = 0;
  std::int32_t lately_ = 0;
  std::int32_t stretched_ = 0;  // torque that the way has answered for, A
  std::int32_t given_ = 0;      // counts/256, two cycles against two, that a load gave it of late
  std::int32_t slewed_ = 0;     // the wanted torque at its rate, A
  std::int32_t turned_ = 0;     // its size where the motor began to turn round, A
  std::int32_t looking_ = 0;    // cycles in which a look's torque is still in the tendons
  std::int32_t silent_ = 0;     // cycles since the last count
  std::int32_t interval_ = 0;   // between the two last ones
  bool forward_ = true;
  bool look_backward_ = false;
  bool swung_ = false;  // the last count came while the motor swung back from a look
  bool watching_ = false;
};

}  // namespace capstan
